// What the pages of docs/ show is what the command says.
//
// A block that starts with ```console holds commands, each in a line that begins with "$ ", followed by what the
// command prints. A line "…" stands for any lines, "…" within a line for any part of it. Commands run through the
// shell, with `ferrers` on the path, in a folder of the page's own that has `examples`; stdout and stderr are taken
// together. Numbers agree to a relative 1e-6; what is below 1e-12 is rounding, and equal. A gap between singular values
// is a quotient by rounding: its number is not compared. Spaces are not, as numbers of other width shift columns.
// Figures in the text must stand in a block of their page, in fewer digits perhaps, or be computed in a test below.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "ferrers/core/unit_names.h"
#include "ferrers/core/units.h"
#include "ferrers/math/expression_node.h"
#include "ferrers/math/rank.h"

namespace ferrers {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

const fs::path kSource = FERRERS_SOURCE_DIR;
const std::string kEllipsis = "…";

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

std::vector<std::string> split_lines(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

bool starts_with(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

// ---------------------------------------------------------------------------------------------------------------------
// Pages

struct Command {
  int line = 0;  ///< In the page, from 1.
  std::string command;
  std::vector<std::string> expected;
};

struct Page {
  std::vector<Command> commands;
  std::string prose;  ///< All outside of blocks and tables' code.
};

Page read_page(const std::string& text) {
  Page page;
  bool fenced = false, console = false;
  int number = 0;
  for (const std::string& line : split_lines(text)) {
    ++number;
    if (starts_with(line, "```")) {
      fenced = !fenced;
      console = fenced && line == "```console";
      continue;
    }
    if (!fenced) page.prose += line + "\n";
    if (!console) continue;
    if (starts_with(line, "$ ")) {
      page.commands.push_back({number, line.substr(2), {}});
    } else if (!page.commands.empty()) {
      page.commands.back().expected.push_back(line);
    }
  }
  return page;
}

std::vector<std::string> page_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(kSource / "docs")) {
    if (entry.path().extension() == ".md" && !read_page(read_text(entry.path())).commands.empty())
      names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// By the name of its file alone: pages on formats stand in a folder of their own.
Page load_page(const std::string& name) {
  const fs::path page = kSource / "docs" / (name + ".md"), of_format = kSource / "docs/formats" / (name + ".md");
  return read_page(read_text(fs::exists(page) ? page : of_format));
}

// ---------------------------------------------------------------------------------------------------------------------
// Comparison

/// A number, an ellipsis, or text without spaces.
struct Token {
  std::string text;
  bool is_number = false, is_any = false;
  double value = 0;
};

std::vector<Token> tokens_of(const std::string& line) {
  static const std::regex pattern("…|[-+]?\\d+(?:\\.\\d+)?(?:[eE][-+]?\\d+)?|[^\\s\\d]");
  std::vector<Token> tokens;
  std::ptrdiff_t end = -1;  // of the text before
  for (std::sregex_iterator it(line.begin(), line.end(), pattern), last; it != last; ++it) {
    Token token{it->str()};
    token.is_any = token.text == kEllipsis;
    token.is_number = token.text.find_first_of("0123456789") != std::string::npos;
    if (token.is_number) token.value = std::stod(token.text);
    const bool is_text = !token.is_any && !token.is_number;
    if (is_text && it->position() == end && !tokens.empty()) {
      tokens.back().text += token.text;
    } else {
      tokens.push_back(token);
    }
    end = is_text ? it->position() + it->length() : -1;
  }
  return tokens;
}

bool same_number(double a, double b) {
  const double size = std::max(std::abs(a), std::abs(b));
  return size < 1e-12 || std::abs(a - b) <= 1e-6 * size;
}

/// Whether `text` fits a pattern of which some members stand for anything.
template <typename T, typename IsAny, typename Same>
bool fits(const std::vector<T>& pattern, const std::vector<T>& text, const IsAny& is_any, const Same& same) {
  std::vector<char> reached(text.size() + 1, 0);  // ends of what the pattern so far can take
  reached[0] = 1;
  for (const T& one : pattern) {
    std::vector<char> next(text.size() + 1, 0);
    for (std::size_t i = 0; i <= text.size(); ++i) {
      if (is_any(one)) {
        next[i] = reached[i] || (i > 0 && next[i - 1]);
      } else if (i > 0) {
        next[i] = reached[i - 1] && same(one, text[i - 1]);
      }
    }
    reached = std::move(next);
  }
  return reached.back() != 0;
}

bool same_line(const std::string& expected, const std::string& actual) {
  std::vector<Token> pattern = tokens_of(expected);
  for (std::size_t i = 1; i < pattern.size(); ++i) {
    if (pattern[i].is_number && pattern[i - 1].text == "gap") pattern[i].is_any = true;
  }
  return fits(
      pattern, tokens_of(actual), [](const Token& one) { return one.is_any; },
      [](const Token& a, const Token& b) {
        return a.is_number && b.is_number ? same_number(a.value, b.value) : a.text == b.text;
      });
}

std::vector<std::string> without_blank_end(std::vector<std::string> lines) {
  while (!lines.empty() && tokens_of(lines.back()).empty()) lines.pop_back();
  return lines;
}

bool same_output(const std::vector<std::string>& expected, const std::vector<std::string>& actual) {
  return fits(
      without_blank_end(expected), without_blank_end(actual), [](const std::string& one) { return one == kEllipsis; },
      same_line);
}

/// For a failure: the first expected line that the output has nowhere.
std::string first_missing(const std::vector<std::string>& expected, const std::vector<std::string>& actual) {
  for (const std::string& line : expected) {
    const auto same = [&](const std::string& one) { return same_line(line, one); };
    if (line != kEllipsis && std::none_of(actual.begin(), actual.end(), same)) return line;
  }
  return "(every line is there, but their order or what stands between is not)";
}

TEST(PageComparisonTest, TellsWhatDiffersFromWhatMayDiffer) {
  EXPECT_TRUE(same_line("rank 2:  kept 1.04, gap 3e+15.", "rank 2: kept 1.0400001, gap 1e+16."));
  EXPECT_TRUE(same_line("lower,force_y,0,distributed", "lower,force_y,-1.18e-14,distributed"));
  EXPECT_TRUE(same_line("steps  2, … s of computing", "steps 2, 0.00064 s of computing"));
  EXPECT_FALSE(same_line("kept 1.04", "kept 1.041"));
  EXPECT_FALSE(same_line("rank 2", "rank 3"));
  EXPECT_FALSE(same_line("force_x", "force_y"));
  EXPECT_FALSE(same_line("force 0", "force -1e-9"));
  EXPECT_FALSE(same_line("50", "-50"));
  EXPECT_FALSE(same_line("none", "none of"));
  EXPECT_TRUE(same_output({"a", kEllipsis, "d 1"}, {"a", "b", "c", "d 1", ""}));
  EXPECT_TRUE(same_output({kEllipsis, "b"}, {"b"}));
  EXPECT_FALSE(same_output({"a", "d"}, {"a", "b", "d"}));
  EXPECT_FALSE(same_output({"a", kEllipsis, "d"}, {"a", "d", "e"}));
  EXPECT_FALSE(same_output({"a"}, {}));
  EXPECT_FALSE(same_output({}, {"a"}));
}

// ---------------------------------------------------------------------------------------------------------------------
// Running

/// A folder with `examples` in it, as a page's reader has; removed at the end.
class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(fs::temp_directory_path() / fmt::format("ferrers-docs-{}-{}", getpid(), name)) {
    fs::remove_all(path_);
    fs::create_directories(path_ / "out");
    fs::create_directory_symlink(kSource / "examples", path_ / "examples");
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }

  const fs::path& path() const { return path_; }

  std::string run(const std::string& command) const {
    const std::string shell = fmt::format("cd '{}' && export NO_COLOR=1 PATH='{}':\"$PATH\" && {{ {}\n}} 2>&1",
                                          path_.string(), fs::path(FERRERS_COMMAND).parent_path().string(), command);
    std::string output;
    FILE* pipe = popen(shell.c_str(), "r");
    if (pipe == nullptr) return "no shell";
    std::array<char, 4096> buffer{};
    for (std::size_t got = 0; (got = fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) {
      output.append(buffer.data(), got);
    }
    pclose(pipe);
    return output;
  }

 private:
  fs::path path_;
};

class PageTest : public testing::TestWithParam<std::string> {};

TEST_P(PageTest, CommandsSayWhatThePageShows) {
  const Folder folder(GetParam());
  for (const Command& one : load_page(GetParam()).commands) {
    const std::string output = folder.run(one.command);
    EXPECT_TRUE(same_output(one.expected, split_lines(output)))
        << "docs/" << GetParam() << ".md:" << one.line << ": $ " << one.command
        << "\nfirst line that is not in the output: " << first_missing(one.expected, split_lines(output))
        << "\noutput:\n"
        << output;
  }
}

INSTANTIATE_TEST_SUITE_P(Docs, PageTest, testing::ValuesIn(page_names()), [](const auto& tested) {
  std::string name = tested.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

// ---------------------------------------------------------------------------------------------------------------------
// Figures in the text

/// Numbers with more to them than a count: a fraction, an exponent, or three digits. Not what stands between backticks.
std::vector<std::string> figures_of(const std::string& prose) {
  static const std::regex code("`[^`]*`|\\]\\([^)]*\\)"),
      figure("(^|[^\\w.])(\\d+\\.\\d+(?:e[-+]?\\d+)?|\\d+e[-+]?\\d+|\\d{3,})(?![\\w])");
  const std::string text = std::regex_replace(prose, code, " ");
  std::vector<std::string> figures;
  for (std::sregex_iterator it(text.begin(), text.end(), figure), last; it != last; ++it) figures.push_back((*it)[2]);
  return figures;
}

/// True when `value`, with as many digits as `figure` shows, is `figure`.
bool shows(const std::string& figure, double value) {
  const std::string mantissa = figure.substr(0, figure.find('e'));
  const std::size_t point = mantissa.find('.');
  const std::size_t decimals = point == std::string::npos ? 0 : mantissa.size() - point - 1;
  const std::size_t exponent = figure.find('e');
  const double unit = exponent == std::string::npos ? 1 : std::pow(10, std::stod(figure.substr(exponent + 1)));
  const double last_digit = unit * std::pow(10, -static_cast<double>(decimals));
  return std::abs(std::abs(value) - std::stod(figure)) <= 0.5000001 * last_digit;
}

void expect_figures_are_founded(const std::string& name, const std::vector<double>& computed) {
  const Page page = load_page(name);
  std::vector<double> known = computed;
  for (const Command& one : page.commands) {
    for (const std::string& line : one.expected) {
      for (const Token& token : tokens_of(line)) {
        if (token.is_number) known.push_back(token.value);
      }
    }
  }
  const std::vector<std::string> figures = figures_of(page.prose);
  EXPECT_FALSE(figures.empty());
  for (const std::string& figure : figures) {
    EXPECT_TRUE(std::any_of(known.begin(), known.end(), [&](double value) { return shows(figure, value); }))
        << figure << " in docs/" << name << ".md stands in no output and is not computed here";
  }
}

/// Whether some output on the page holds the number, of either sign.
bool page_has(const std::string& name, double value) {
  for (const Command& one : load_page(name).commands) {
    for (const std::string& line : one.expected) {
      for (const Token& token : tokens_of(line)) {
        if (token.is_number && same_number(std::abs(token.value), std::abs(value))) return true;
      }
    }
  }
  return false;
}

// Springs of the door by hand: the leaf sinks and tilts as a rigid body between two hinges of equal stiffness.
TEST(DocsTest, ForcesInTheDoorAreThoseOfTheClosedForm) {
  const std::string name = "what-redundancy-does";
  const double m = 20, g = 9.81, b = 0.45, h = 1.7, k = 2e6, k_axial = 1e6, c = 4e4, high = 1e-4;
  const double couple = m * g * b / h, radial = k * h * h / 2, all = radial + 2 * c;
  const double H = couple * radial / all, bending = m * g * b * c / all;
  const double preload = k_axial * high / 2, weight = m * g / 2;
  // Equal stiffness: k for forces, k h² for moments, of which k h²/2 / (k h²/2 + 2 k h²) = 1/5 goes to the couple.
  const double equal = couple / 5, equal_bending = m * g * b * 2 / 5;
  for (const double value : {H, bending, weight, preload, weight + preload, weight - preload, equal, equal_bending}) {
    EXPECT_TRUE(page_has(name, value)) << value;
  }
  // At both ends of the range: all radial entries low and all others high, and the other way round.
  for (const double ratio : {0.25, 4.0})
    EXPECT_TRUE(page_has(name, couple * radial * ratio / (radial * ratio + 2 * c)));
  for (const double share : {0.5 / 2.5, 2 / 2.5}) EXPECT_TRUE(page_has(name, m * g * share));
  expect_figures_are_founded(name, {m * g, m * g * b, b, 2 * b, h, couple, radial, all, k, k_axial, c, high * 1e3,
                                    2 * weight / k_axial * 1e3, 1e-12, 1, 1000});
}

TEST(DocsTest, FiguresOfTheReportStandInTheReport) { expect_figures_are_founded("reading-the-report", {0.05}); }

// The walk through both problems by hand: one equation, 8 θ'' + 88.29 cos θ = Q, θ counted from 0.7 rad as drawn.
TEST(DocsTest, FiguresOfTheMethodPageAreThoseOfTheClosedForm) {
  const std::string name = "method";
  const double I = 3 * 2 * 1.0 / 3 + 6, G = (3 * 2 / 2.0 + 6) * 9.81, drawn = 0.7, t = 0.3, dt = 0.05;
  const double q = 0.5 * (1 - std::cos(2 * t)), v = std::sin(2 * t), a = 2 * std::cos(2 * t);
  const double torque = I * a + G * std::cos(drawn + q);
  // The driven crank's equation has one multiplier only, with the entry −cos 0.7: the row's axes turn with the crank.
  const double crank = 2.0 / 3 * a + 9.81 * std::cos(drawn + q), multiplier = (torque - crank) / std::cos(drawn);
  const double begin = (75 - G * std::cos(drawn)) / I, q_next = 0.5 * dt + begin * dt * dt / 2,
               v_next = 0.5 + begin * dt;
  for (const double value : {q, v, a, torque, multiplier, begin, q_next, v_next}) {
    EXPECT_TRUE(page_has(name, value)) << value;
  }
  for (int l = 0; l <= 10; ++l) {
    const double angle = 0.5 * (1 - std::cos(0.2 * l));
    EXPECT_TRUE(page_has(name, angle)) << l;
    EXPECT_TRUE(page_has(name, 2 * I * std::cos(0.2 * l) + G * std::cos(drawn + angle))) << l;
  }
  // The scheme of step 4 on the one equation: the table's rows and the errors of its finer steps.
  const double converged = 0.2177150654614818;  // integrated to 25 digits
  for (const int steps : {6, 12, 24, 48}) {
    double angle = 0, rate = 0.5;
    const double h = t / steps;
    for (int l = 0; l < steps; ++l) {
      EXPECT_TRUE(steps > 6 || (page_has(name, angle) && page_has(name, rate))) << l;
      const double acceleration = (75 + 10 * l * h - G * std::cos(drawn + angle)) / I;
      angle += h * rate + h * h * acceleration / 2;
      rate += h * acceleration;
    }
    EXPECT_TRUE(page_has(name, angle)) << steps;
    EXPECT_TRUE(page_has(name, std::stod(fmt::format("{:.3g}", angle - converged)))) << steps;
  }
  expect_figures_are_founded(name, {G, drawn, drawn + q, torque, begin, q_next, v_next, dt, 0.5});
}

TEST(DocsTest, FunctionsOfTheMethodPageStandInTheHeadersThatItLinks) {
  static const std::regex link("\\[`(\\w+)`\\]\\(\\.\\./(ferrers/[^)]+\\.h)\\)");
  const std::string page = read_text(kSource / "docs/method.md");
  std::set<std::string> functions;
  for (std::sregex_iterator it(page.begin(), page.end(), link), last; it != last; ++it) {
    functions.insert((*it)[1]);
    const std::regex word("\\b" + (*it)[1].str() + "\\b");
    EXPECT_TRUE(std::regex_search(read_text(kSource / (*it)[2].str()), word)) << (*it)[0];
  }
  EXPECT_GE(functions.size(), 18u);
}

// The bounds that the page names, from the function that decides.
TEST(DocsTest, BoundsOfTheRankPageAreThoseThatDecide) {
  const auto decide = [](double second, double blur = 0) {
    return decide_rank((Eigen::VectorXd(2) << 1, second).finished(), 0, blur);
  };
  const double kept = 1e-5, dropped = 1e-10, gap = 1e4, rounding = 1e-11, rounded = 1e-8;
  EXPECT_TRUE(decide(1.1 * kept).confident);
  EXPECT_EQ(decide(1.1 * kept).rank, 2);
  EXPECT_FALSE(decide(0.9 * kept).confident);
  EXPECT_FALSE(decide(1.1 * dropped).confident);
  EXPECT_TRUE(decide(0.9 * dropped).confident);
  EXPECT_EQ(decide(0.9 * dropped).rank, 1);
  // Blurred by β, values up to 10 β say nothing, and what is kept must be 1e4 times as large.
  const double blur = 1e-7;
  EXPECT_TRUE(decide(1.1 * gap * 10 * blur, blur).confident);
  EXPECT_FALSE(decide(0.9 * gap * 10 * blur, blur).confident);
  EXPECT_EQ(judge_misclosure(0.9 * rounding), Misclosure::kNone);
  EXPECT_EQ(judge_misclosure(1.1 * rounding), Misclosure::kDoubtful);
  EXPECT_EQ(judge_misclosure(0.9 * rounded), Misclosure::kDoubtful);
  EXPECT_EQ(judge_misclosure(1.1 * rounded), Misclosure::kSure);
  const double b = std::sin(110 * M_PI / 180) / std::sin(50 * M_PI / 180);
  EXPECT_FALSE(decide(9.09e-6 / 1.66).confident);
  expect_figures_are_founded("how-rank-is-decided", {kept, dropped, gap, rounding, rounded, b, 1e-6, 1e-12, 10 * kept,
                                                     1903, 1.227, 1.2267, 128, 1e-16, 1e-3});
}

TEST(DocsTest, MarksOfTheBandsPictureAreWhatTheCommandSays) {
  static const std::regex mark("data-error=\"([^\"]+)\" data-value=\"([^\"]+)\"");
  const std::string picture = read_text(kSource / "docs/img/bands.svg");
  std::map<double, std::vector<double>> drawn;
  for (std::sregex_iterator it(picture.begin(), picture.end(), mark), last; it != last; ++it)
    drawn[std::stod((*it)[1])].push_back(std::stod((*it)[2]));
  EXPECT_EQ(drawn.size(), 15u);
  const Folder folder("bands");
  const double b = std::sin(110 * M_PI / 180) / std::sin(50 * M_PI / 180);
  for (const auto& [error, shares] : drawn) {
    const ordered_json json = ordered_json::parse(
        folder.run(fmt::format("ferrers analyze examples/bennett/model.yaml --json -p b='{:.17g} m'", b + error)),
        nullptr,
        /*allow_exceptions=*/false);
    ASSERT_TRUE(json.is_object()) << error;
    const auto values = json.at("certainty").at("singular_values").get<std::vector<double>>();
    ASSERT_EQ(values.size(), shares.size());
    for (std::size_t i = 0; i < values.size(); ++i)
      EXPECT_NEAR(values[i] / values[0], shares[i], 1e-3 * shares[i] + 1e-14) << "error " << error;
  }
}

// ---------------------------------------------------------------------------------------------------------------------
// Completeness

void collect_keys(const ordered_json& value, std::set<std::string>& keys) {
  static const std::set<std::string> by_name = {"rows", "direction", "components", "unique_basis"};
  if (value.is_array()) {
    for (const ordered_json& one : value) collect_keys(one, keys);
  } else if (value.is_object()) {
    for (const auto& [key, one] : value.items()) {
      keys.insert(key);
      if (key == "components") collect_keys(one.begin().value(), keys);  // named like rows
      if (by_name.count(key) == 0) collect_keys(one, keys);
    }
  }
}

TEST(DocsTest, EveryFieldOfTheJsonReportIsExplained) {
  const Folder folder("json");
  const std::string page = read_text(kSource / "docs/reading-the-report.md");
  std::set<std::string> keys;
  for (const char* arguments :
       {"examples/slider-crank/model.yaml", "examples/arm-on-rods/model-contradictory.yaml",
        "examples/door/model-compliant-hinges.yaml -p high=0.1mm", "examples/four-bar-rscr/model-rssr.yaml",
        "examples/n-four-bar-a02/model-horizontal.yaml"}) {
    const std::string output = folder.run(fmt::format("ferrers analyze {} --json 2>/dev/null", arguments));
    const ordered_json json = ordered_json::parse(output, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(json.is_object()) << arguments << ": " << output;
    collect_keys(json, keys);
  }
  EXPECT_GT(keys.size(), 50u);
  for (const std::string& key : keys) {
    EXPECT_NE(page.find("`" + key + "`"), std::string::npos) << "`" << key << "` is not in docs/reading-the-report.md";
  }
}

TEST(DocsTest, EveryFieldOfTheRunSummaryIsExplained) {
  const Folder folder("run-json");
  std::ofstream(folder.path() / "busy.yaml") << R"(ferrers: 1
name: busy
bodies: {a: {mass: 1, com: [1, 0, 0]}}
joints: {j: {type: revolute, bodies: [ground, a], at: [0, 0, 0], axis: y, limits: [-0.1, 0.1]}}
events: {half: {when: "= t - 0.5", do: record}}
)";
  const std::string page = read_text(kSource / "docs/results.md");
  std::set<std::string> keys;
  for (const char* arguments :
       {"simulate examples/slider-crank/model.yaml --end 0.1 --distribute equal --stiffness-range 0.5:2",
        "inverse examples/two-motors/model.yaml --end 0.1", "simulate busy.yaml --end 1", "simulate nothing.yaml"}) {
    const std::string output = folder.run(fmt::format("ferrers {} --json 2>/dev/null", arguments));
    const ordered_json json = ordered_json::parse(output, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(json.is_object()) << arguments << ": " << output;
    collect_keys(json, keys);
  }
  EXPECT_GT(keys.size(), 60u);
  for (const std::string& key : keys) {
    EXPECT_NE(page.find("`" + key + "`"), std::string::npos) << "`" << key << "` is not in docs/results.md";
  }
}

TEST(DocsTest, EveryFieldOfTheEquationsJsonIsExplained) {
  const Folder folder("equations-json");
  const std::string page = read_text(kSource / "docs/equations.md");
  std::set<std::string> keys;
  for (const char* arguments : {"examples/two-motors/model.yaml --inverse", "nothing.yaml"}) {
    const std::string output = folder.run(fmt::format("ferrers equations {} --json 2>/dev/null", arguments));
    const ordered_json json = ordered_json::parse(output, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(json.is_object()) << arguments << ": " << output;
    for (const auto& [key, value] : json.items()) {
      keys.insert(key);
      if (key == "diagnostics") continue;  // docs/reading-the-report.md tells their keys
      const ordered_json& inner = value.is_array() && !value.empty() ? value.front() : value;
      if (!inner.is_object()) continue;
      for (const auto& [name, unused] : inner.items()) keys.insert(name);
    }
  }
  EXPECT_GT(keys.size(), 50u);
  for (const std::string& key : keys) {
    EXPECT_NE(page.find("`" + key + "`"), std::string::npos) << "`" << key << "` is not in docs/equations.md";
  }
}

TEST(DocsTest, ThePageOfFormulasNamesEveryFunctionUnitAndPrefix) {
  const std::string page = read_text(kSource / "docs/formulas.md");
  for (const ExpressionFunction& function : expression_functions()) {
    EXPECT_NE(page.find(fmt::format("`{}(", function.name)), std::string::npos) << function.name;
  }
  std::map<std::string, std::pair<double, bool>> listed;
  static const std::regex row("\\| `([^`]+)` \\| ([0-9.]+) \\| [a-z, ]+ \\| (yes|no) \\|");
  for (std::sregex_iterator it(page.begin(), page.end(), row), last; it != last; ++it)
    listed[(*it)[1]] = {std::stod((*it)[2]), (*it)[3] == "yes"};
  for (const UnitName& unit : unit_names()) {
    const auto found = listed.find(std::string(unit.name));
    ASSERT_NE(found, listed.end()) << unit.name;
    EXPECT_DOUBLE_EQ(found->second.first, parse_unit(unit.name)->si) << unit.name;
    EXPECT_EQ(found->second.second, unit.takes_prefixes) << unit.name;
  }
  EXPECT_EQ(listed.size(), unit_names().size());
  const std::size_t prefixes = page.find("\nPrefixes:");
  ASSERT_NE(prefixes, std::string::npos);
  const std::string line = page.substr(prefixes, page.find('\n', prefixes + 1) - prefixes);
  for (const std::string_view prefix : unit_prefixes()) {
    EXPECT_NE(line.find(fmt::format("`{}`", prefix)), std::string::npos) << prefix;
  }
}

TEST(DocsTest, LinksLeadSomewhere) {
  static const std::regex link("\\]\\(([^)#:]+)(#[^)]*)?\\)");
  std::vector<fs::path> files = {kSource / "README.md", kSource / "ARCHITECTURE.md", kSource / "CONTRIBUTING.md"};
  for (const auto& entry : fs::recursive_directory_iterator(kSource / "docs")) {
    if (entry.path().extension() == ".md") files.push_back(entry.path());
  }
  int links = 0;
  for (const fs::path& file : files) {
    const std::string text = read_text(file);
    for (std::sregex_iterator it(text.begin(), text.end(), link), last; it != last; ++it, ++links) {
      EXPECT_TRUE(fs::exists(file.parent_path() / (*it)[1].str())) << file << ": " << (*it)[1];
    }
  }
  EXPECT_GT(links, 20);
}

TEST(DocsTest, TheThreePagesAreThereAndTheReadmeNamesThem) {
  const std::string readme = read_text(kSource / "README.md");
  for (const char* name : {"what-redundancy-does", "reading-the-report", "how-rank-is-decided"}) {
    EXPECT_GE(load_page(name).commands.size(), 3u) << name;
    EXPECT_NE(readme.find(fmt::format("(docs/{}.md)", name)), std::string::npos) << name;
  }
}

}  // namespace
}  // namespace ferrers
