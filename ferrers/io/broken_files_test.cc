#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "ferrers/io/model_reader.h"

/// Every file of tests/broken ends with the diagnostics that it wants: `# expect: F204 31:13`, one per line.
namespace ferrers {
namespace {

namespace fs = std::filesystem;

std::vector<fs::path> broken_files() {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(fs::path(FERRERS_SOURCE_DIR) / "tests" / "broken")) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::string> expected_of(const std::string& source) {
  constexpr std::string_view kMark = "# expect: ";
  std::vector<std::string> expected;
  std::istringstream lines(source);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind(kMark, 0) == 0) expected.push_back(line.substr(kMark.size()));
  }
  return expected;
}

std::vector<std::string> found_in(const ModelReadResult& result) {
  std::vector<std::string> found;
  for (const Diagnostic& one : result.diagnostics.items()) {
    found.push_back(fmt::format("{} {}:{}", one.code, one.at.line, one.at.column));
  }
  return found;
}

TEST(BrokenFilesTest, EveryFileGivesExactlyTheDiagnosticsThatItNames) {
  const std::vector<fs::path> files = broken_files();
  ASSERT_GE(files.size(), 40U);
  for (const fs::path& file : files) {
    const ModelReadResult result = read_model_file(file);
    const std::vector<std::string> expected = expected_of(result.source);
    EXPECT_FALSE(expected.empty()) << file;
    EXPECT_THAT(found_in(result), testing::UnorderedElementsAreArray(expected)) << file;
    EXPECT_EQ(result.model.has_value(), !result.diagnostics.has_errors()) << file;
  }
}

TEST(BrokenFilesTest, DiagnosticsComeInTheOrderOfTheFile) {
  for (const fs::path& file : broken_files()) {
    const ModelReadResult result = read_model_file(file);
    const auto& items = result.diagnostics.items();
    const auto before = [](const Diagnostic& a, const Diagnostic& b) {
      return std::pair(a.at.line, a.at.column) < std::pair(b.at.line, b.at.column);
    };
    EXPECT_TRUE(std::is_sorted(items.begin(), items.end(), before)) << file;
  }
}

TEST(BrokenFilesTest, EveryMessageIsOneSentenceAndShowsItsPlace) {
  for (const fs::path& file : broken_files()) {
    const ModelReadResult result = read_model_file(file);
    for (const Diagnostic& one : result.diagnostics.items()) {
      EXPECT_FALSE(one.message.empty()) << file;
      EXPECT_NE(one.message.back(), '.') << file << one.message;
      const std::string text = format_diagnostic(one, "model.yaml", result.source);
      EXPECT_EQ(text.rfind(fmt::format("model.yaml:{}:{}: ", one.at.line, one.at.column), 0), 0U) << text;
    }
  }
}

/// Codes that no broken file can give, and why.
const std::set<std::string>& codes_not_of_files() {
  static const std::set<std::string> codes = {
      "F101",          // no file: model_reader_test
      "F102",          // too large to keep: document_test
      "F116",          // of a table: parameter_table_test
      "F216", "F217",  // command line: model_reader_test
      "F218",          // too many errors: model_reader_test
      "F309", "F310",  // parameter values of a caller: model_reader_test
      "F317", "F329",  // specifications made in C++; in a file a missing key is F202
  };
  return codes;
}

TEST(BrokenFilesTest, EveryCodeThatAFileCanGiveHasABrokenFile) {
  std::set<std::string> seen;
  for (const fs::path& file : broken_files()) {
    const ModelReadResult result = read_model_file(file);
    for (const Diagnostic& one : result.diagnostics.items()) seen.insert(one.code);
  }
  std::set<std::string> documented;
  for (const DiagnosticCode& code : diagnostic_codes()) {
    documented.insert(std::string(code.code));
    const bool of_a_file = code.code >= "F100" && code.code < "F500";
    if (!of_a_file || codes_not_of_files().count(std::string(code.code)) > 0) continue;
    EXPECT_TRUE(seen.count(std::string(code.code)) > 0) << code.code << " has no file in tests/broken";
  }
  for (const std::string& code : seen) EXPECT_TRUE(documented.count(code) > 0) << code << " is not documented";
}

}  // namespace
}  // namespace ferrers
