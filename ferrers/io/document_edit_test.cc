#include "ferrers/io/document_edit.h"

#include <gtest/gtest.h>

namespace ferrers {
namespace {

DocumentNode document() {
  Diagnostics diagnostics;
  return *parse_document("bodies: {a: {com: [1, 2, 3]}}\ninitial: {j: [{position: 1}, {velocity: 2}]}\n", diagnostics);
}

TEST(DocumentEditTest, ValuesInMapsAndListsAreReplaced) {
  DocumentNode root = document();
  Diagnostics diagnostics;
  edit_document(root, {"bodies.a.com[2]=7", "initial.j[1].velocity=3", "initial.j.0.position=4", "bodies.a.mass=9"},
                diagnostics);
  EXPECT_TRUE(diagnostics.empty());
  EXPECT_EQ(root.find("bodies")->find("a")->find("com")->items[2].text, "7");
  EXPECT_EQ(root.find("bodies")->find("a")->find("mass")->text, "9");
  EXPECT_EQ(root.find("initial")->find("j")->items[1].find("velocity")->text, "3");
  EXPECT_EQ(root.find("initial")->find("j")->items[0].find("position")->text, "4");
}

TEST(DocumentEditTest, NothingIsChangedByAnEditThatFails) {
  DocumentNode root = document();
  Diagnostics diagnostics;
  edit_document(root,
                {"bodies.b={}", "bodies.a.com[3]=1", "bodies.a.com.x=1", "bodies.a.com[=1", "=1", "bodies.a.com="},
                diagnostics);
  ASSERT_EQ(diagnostics.items().size(), 6U);
  for (const Diagnostic& one : diagnostics.items()) EXPECT_EQ(one.code, "F217");
  EXPECT_EQ(root.find("bodies")->entries.size(), 1U);
  EXPECT_EQ(root.find("bodies")->find("a")->find("com")->items.size(), 3U);
}

TEST(DocumentEditTest, MessagesAboutAnEditedValueNameTheEdit) {
  DocumentNode root = document();
  Diagnostics diagnostics;
  edit_document(root, {"bodies.a.com=1", "bodies.a.mass=9"}, diagnostics);
  diagnostics.error("F203", root.find("bodies")->find("a")->find("mass")->at, "no mass");
  const Diagnostics named = name_edits(diagnostics, {"bodies.a.com=1", "bodies.a.mass=9"});
  ASSERT_EQ(named.items().size(), 1U);
  EXPECT_EQ(named.items()[0].message, "--set 'bodies.a.mass=9': no mass");
  EXPECT_EQ(named.items()[0].at, SourceRange());
}

}  // namespace
}  // namespace ferrers
