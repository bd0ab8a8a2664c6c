#include "ferrers/core/diagnostics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

namespace ferrers {
namespace {

Diagnostic wrong_dimension(SourceRange at) {
  return {Severity::kError, "F204", at, "'stiffness' wants N/m, got N*m", "a rotational spring is a 'torsion_spring'"};
}

TEST(DiagnosticsTest, TheTextNamesThePlaceShowsTheLineAndGivesTheHint) {
  const std::string source = "ferrers: 1\n    stiffness: 200 N*m\nend: 1\n";
  EXPECT_EQ(format_diagnostic(wrong_dimension({2, 16, 7}), "press.yaml", source),
            "press.yaml:2:16: error[F204]: 'stiffness' wants N/m, got N*m\n"
            "    2 |     stiffness: 200 N*m\n"
            "      |                ^~~~~~~\n"
            "  hint: a rotational spring is a 'torsion_spring'");
}

TEST(DiagnosticsTest, WithoutAPlaceThereIsNoExcerptAndNoNumber) {
  EXPECT_EQ(format_diagnostic({Severity::kWarning, "F204", {}, "odd", ""}, "a.yaml", "x\n"),
            "a.yaml: warning[F204]: odd");
  EXPECT_EQ(format_diagnostic({Severity::kNotice, "F204", {}, "odd", ""}, "", ""), "notice[F204]: odd");
}

TEST(DiagnosticsTest, ALineThatTheSourceDoesNotHaveIsNotShown) {
  const Diagnostic lost{Severity::kError, "F204", {9, 1, 0}, "odd", ""};
  EXPECT_EQ(format_diagnostic(lost, "a", "one\ntwo"), "a:9:1: error[F204]: odd");
}

TEST(DiagnosticsTest, APlaceBehindTheLineIsMarkedAtItsEnd) {
  const Diagnostic behind{Severity::kError, "F401", {1, 99, 5}, "odd", ""};
  EXPECT_EQ(format_diagnostic(behind, "a", "abc\r\n"), "a:1:99: error[F401]: odd\n    1 | abc\n      |    ^");
}

TEST(DiagnosticsTest, TheMarkStandsUnderItsCharacterBehindTabsAndLongCharacters) {
  // 'é' has two bytes and one column on the screen; a tab stays a tab.
  const std::string line = "\té = x";
  const Diagnostic d{Severity::kError, "F403", {1, 7, 1}, "odd", ""};
  EXPECT_EQ(format_diagnostic(d, "a", line), "a:1:7: error[F403]: odd\n    1 | \té = x\n      | \t    ^");
}

TEST(DiagnosticsTest, ControlBytesAndBrokenTextNeverReachTheTerminal) {
  const std::string hostile("\x1b[31m\x00\xff\xc3", 8);
  const Diagnostic d{Severity::kError, "F401", {1, 1, 0}, "saw " + hostile, hostile};
  const std::string text = format_diagnostic(d, "f\x07", hostile);
  for (const char c : text) EXPECT_TRUE(c == '\n' || (c >= 0x20 && c < 0x7f)) << int(c);
}

TEST(DiagnosticsTest, AVeryLongLineIsCutAroundThePlace) {
  const std::string line = std::string(5000, 'a') + "!" + std::string(5000, 'b');
  const std::string text = format_diagnostic({Severity::kError, "F401", {1, 5001, 1}, "odd", ""}, "f", line);
  EXPECT_LT(text.size(), 400u);
  const std::size_t shown = text.find("    1 | "), under = text.find("      | ");
  ASSERT_NE(under, std::string::npos);
  EXPECT_EQ(text.find('!') - shown, text.find('^') - under);
}

TEST(DiagnosticsTest, SortingPutsPlacesFirstAndKeepsTheOrderOfTheRest) {
  Diagnostics d("f");
  d.error("F401", {}, "no place 1");
  d.warning("F402", {3, 1, 0}, "line 3");
  d.notice("F403", {}, "no place 2");
  d.error("F404", {2, 9, 0}, "line 2 late");
  d.error("F405", {2, 1, 0}, "line 2 early");
  d.sort_by_place();
  std::vector<std::string> messages;
  for (const Diagnostic& item : d.items()) messages.push_back(item.message);
  EXPECT_EQ(messages, (std::vector<std::string>{"line 2 early", "line 2 late", "line 3", "no place 1", "no place 2"}));
}

TEST(DiagnosticsTest, OnlyErrorsCountAsErrors) {
  Diagnostics d;
  d.warning("F204", {}, "w");
  d.notice("F204", {}, "n");
  EXPECT_FALSE(d.has_errors());
  Diagnostics other;
  other.error("F204", {}, "e");
  d.append(other);
  EXPECT_TRUE(d.has_errors());
  d.append(d);
  EXPECT_EQ(d.items().size(), 6u);
}

TEST(DiagnosticCodesTest, CodesAreSortedUniqueAndTitled) {
  const auto& codes = diagnostic_codes();
  ASSERT_FALSE(codes.empty());
  EXPECT_TRUE(std::is_sorted(codes.begin(), codes.end(), [](const auto& a, const auto& b) { return a.code < b.code; }));
  for (std::size_t i = 0; i < codes.size(); ++i) {
    EXPECT_EQ(codes[i].code.size(), 4u);
    EXPECT_EQ(codes[i].code.front(), 'F');
    EXPECT_FALSE(codes[i].title.empty());
    if (i > 0) {
      EXPECT_NE(codes[i].code, codes[i - 1].code);
    }
  }
}

}  // namespace
}  // namespace ferrers
