#include "ferrers/io/document.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "ferrers/io/source_text.h"

namespace ferrers {
namespace {

using Kind = DocumentNode::Kind;

std::string first_code(std::string_view text, const DocumentLimits& limits = {}) {
  Diagnostics diagnostics;
  parse_document(text, diagnostics, limits);
  return diagnostics.empty() ? "" : diagnostics.items().front().code;
}

DocumentNode parsed(std::string_view text) {
  Diagnostics diagnostics;
  auto root = parse_document(text, diagnostics);
  EXPECT_TRUE(root.has_value());
  EXPECT_TRUE(diagnostics.empty());
  return root.value_or(DocumentNode());
}

TEST(DocumentTest, MapsKeepTheirOrderAndScalarsTheirPlace) {
  const DocumentNode root = parsed("b: 1\na: {c: \"x y\", d: [2, = r/2]}\n");
  ASSERT_EQ(root.entries.size(), 2U);
  EXPECT_EQ(root.entries[0].key, "b");
  EXPECT_EQ(root.entries[1].key_at, (SourceRange{2, 1, 1}));
  const DocumentNode* c = root.entries[1].value.find("c");
  ASSERT_NE(c, nullptr);
  EXPECT_EQ(c->kind, Kind::kQuoted);
  EXPECT_EQ(c->at, (SourceRange{2, 8, 5}));
  EXPECT_EQ(c->text_at.column, 9);
  const DocumentNode* d = root.entries[1].value.find("d");
  ASSERT_NE(d, nullptr);
  EXPECT_EQ(d->items[1].text, "= r/2");
  EXPECT_EQ(d->items[1].at, (SourceRange{2, 22, 5}));
}

TEST(DocumentTest, JsonIsReadTheSame) {
  const DocumentNode root = parsed("{\"a\": [1, 2.5e-3, true],\n\t\"b\": {\"c\": \"\\u00e9\"}}\n");
  EXPECT_EQ(root.find("a")->items.size(), 3U);
  EXPECT_EQ(root.find("b")->find("c")->text, "\xC3\xA9");
}

TEST(DocumentTest, ColumnsCountBytesBehindOtherLetters) {
  const DocumentNode root = parsed("# m/s\xC2\xB2\nn: \xC3\xA9\nm: {x: \"\xC3\xA9\", y: 3}\n");
  EXPECT_EQ(root.find("m")->find("y")->at, (SourceRange{3, 17, 1}));
}

TEST(DocumentTest, WindowsLineEndsAreLineEnds) {
  const DocumentNode root = parsed("a: 1\r\nb: 2\r\n");
  EXPECT_EQ(root.find("b")->at, (SourceRange{2, 4, 1}));
}

TEST(DocumentTest, PlainScalarsStayText) {
  const DocumentNode root = parsed("a: 010\nb: on\nc: 0x1F\nd: ~\n");
  EXPECT_EQ(root.find("a")->text, "010");
  EXPECT_EQ(root.find("b")->text, "on");
  EXPECT_EQ(root.find("d")->kind, Kind::kNull);
}

TEST(DocumentTest, LimitsOfSizeDepthAndCountHold) {
  EXPECT_EQ(first_code("a: 123456", {.bytes = 8}), "F102");
  EXPECT_EQ(first_code("[1, 2, 3]", {.values = 2}), "F102");
  EXPECT_EQ(first_code("[[1]]", {.depth = 2}), "");
  EXPECT_EQ(first_code("[[[1]]]", {.depth = 2}), "F108");
}

TEST(DocumentTest, DeepNestingOfEveryKindEndsInADiagnostic) {
  for (const char* piece : {"[", "{a: ", "- ", "? ", "{", "[{"}) {
    std::string text;
    for (int i = 0; i < 20000; ++i) text += piece;
    EXPECT_EQ(first_code(text), "F108") << piece;
  }
}

TEST(DocumentTest, AHundredThousandKeysAreCheckedForDuplicatesQuickly) {
  std::string text;
  for (int i = 0; i < 100000; ++i) text += "key" + std::to_string(i) + ": 1\n";
  text += "key7: 2\n";
  Diagnostics diagnostics;
  const auto root = parse_document(text, diagnostics);
  ASSERT_TRUE(root.has_value());
  ASSERT_EQ(diagnostics.items().size(), 1U);
  EXPECT_EQ(diagnostics.items()[0].code, "F109");
  EXPECT_EQ(diagnostics.items()[0].at.line, 100001);
  EXPECT_EQ(root->entries.size(), 100000U);
}

TEST(DocumentTest, OneLongLineIsReadInLinearTime) {
  std::string text = "a: [0";
  for (int i = 0; i < 300000; ++i) text += ",1";
  EXPECT_EQ(parsed(text + "]").find("a")->items.size(), 300001U);
}

TEST(DocumentTest, OverlongAndSurrogateUtf8IsRefused) {
  EXPECT_EQ(first_code("a: \xC0\xAF"), "F104");
  EXPECT_EQ(first_code("a: \xED\xA0\x80"), "F104");
  EXPECT_EQ(first_code("a: \xF5\x80\x80\x80"), "F104");
  EXPECT_EQ(first_code("a: \xE2\x82"), "F104");
  EXPECT_EQ(first_code("a: \xF0\x9F\x94\xA9"), "");
  EXPECT_EQ(first_code("a: 1\rb: 2"), "F106");
}

TEST(DocumentTest, TheYamlTwelveDirectiveIsAllowed) {
  EXPECT_EQ(first_code("%YAML 1.2\n---\na: 1\n"), "");
  EXPECT_EQ(first_code("%TAG ! tag:x,2000:\n---\na: 1\n"), "F114");
}

}  // namespace
}  // namespace ferrers
