#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "ferrers/io/model_reader.h"

/// Whatever the bytes, reading ends, without an exception, in a model or in reasons. Changes are random but repeatable.
namespace ferrers {
namespace {

namespace fs = std::filesystem;
using Random = std::mt19937;

std::vector<std::string> seeds() {
  std::vector<std::string> texts;
  const fs::path root(FERRERS_SOURCE_DIR);
  for (const fs::path& file : {root / "tests/models/every_field.yaml", root / "tests/broken/many_at_once.yaml",
                               root / "tests/broken/anchor_and_alias.yaml", root / "tests/broken/complex_key.yaml"}) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    texts.push_back(text.str());
    EXPECT_FALSE(texts.back().empty()) << file;
  }
  return texts;
}

std::size_t below(std::size_t end, Random& random) { return random() % std::max<std::size_t>(end, 1); }

/// One small accident.
void mutate(std::string& text, Random& random) {
  static const std::string kSpecial = "{}[]:,'\"|>&*!%@`#-?\n\t =.0\\<~\r";
  const std::size_t at = below(text.size(), random);
  switch (random() % 7) {
    case 0:
      text[at] = static_cast<char>(random() % 256);
      break;
    case 1:
      text[at] = kSpecial[random() % kSpecial.size()];
      break;
    case 2:
      text.insert(at, 1, kSpecial[random() % kSpecial.size()]);
      break;
    case 3:
      text.erase(at, 1 + below(20, random));
      break;
    case 4:
      text.resize(at);
      break;
    case 5: {  // a line twice
      const std::size_t start = text.rfind('\n', at) + 1;
      const std::size_t end = std::min(text.find('\n', at), text.size() - 1) + 1;
      if (end > start) text.insert(start, text.substr(start, end - start));
      break;
    }
    default: {  // a piece somewhere else
      const std::string piece = text.substr(at, 1 + below(40, random));
      text.insert(below(text.size(), random), piece);
    }
  }
  if (text.empty()) text = "a";
}

void expect_an_answer(const std::string& text, unsigned seed) {
  ReadModelOptions options;
  options.folder = fs::path(FERRERS_SOURCE_DIR) / "tests" / "models";
  const ModelReadResult result = read_model_text(text, "mutated.yaml", options);
  EXPECT_EQ(result.model.has_value(), !result.diagnostics.has_errors()) << "seed " << seed << "\n" << text;
  for (const Diagnostic& one : result.diagnostics.items()) {
    EXPECT_FALSE(format_diagnostic(one, "mutated.yaml", result.source).empty());
  }
}

TEST(RobustnessTest, ThousandsOfMutatedFilesAreAnswered) {
  const std::vector<std::string> originals = seeds();
  for (unsigned seed = 0; seed < 3000; ++seed) {
    Random random(seed);
    std::string text = originals[seed % originals.size()];
    const std::size_t accidents = 1 + below(6, random);
    for (std::size_t i = 0; i < accidents; ++i) mutate(text, random);
    ASSERT_NO_THROW(expect_an_answer(text, seed)) << "seed " << seed;
  }
}

TEST(RobustnessTest, RandomBytesAreAnswered) {
  for (unsigned seed = 0; seed < 3000; ++seed) {
    Random random(seed);
    std::string text(1 + below(200, random), '\0');
    for (char& c : text) c = static_cast<char>(seed % 2 == 0 ? random() % 256 : 32 + random() % 95);
    ASSERT_NO_THROW(expect_an_answer(text, seed)) << "seed " << seed;
  }
}

TEST(RobustnessTest, EveryTruncationOfAFileIsAnswered) {
  const std::string text = seeds().front();
  for (std::size_t size = 0; size < text.size(); size += 7) {
    ASSERT_NO_THROW(expect_an_answer(text.substr(0, size), static_cast<unsigned>(size)));
  }
}

}  // namespace
}  // namespace ferrers
