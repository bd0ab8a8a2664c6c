// The facts in examples/*/expected.json, checked through the command as a user would run it.
//
// expected.json maps each model file of its folder to what the command must say about it:
//
//   "analyze":  an object that `ferrers analyze FILE --json` must contain (objects are compared key by key), and the
//               keys below that sum or look up something: `unique_rows_total`, `unique_dimension_total`, `confident`.
//               With `exit_code` the command must end with it, `ok` false, and say all of `errors` on stderr.
//   "simulate", "inverse", "kinematics": one run or a list of runs, each an object of
//     "args":             more arguments; `-o FOLDER` is added
//     "result":           [{t, column, value, tolerance}]: a cell of result.csv, absolute tolerance
//     "reactions":        [{t, joint, component, value?, relative_tolerance?, absolute_tolerance?, status}]: rows of
//                         reactions.csv; a status `undetermined` demands an empty value
//     "trajectory":       {file, tolerance}: a CSV beside expected.json whose cells result.csv must show
//     "energy_drift_max": bound of |energy(t) - energy(0)|, J
//   "equilibrium", "linearize": one call or a list of calls with `--json`, each an object of
//     "args":             more arguments
//     "exit_code":        the one that the command must end with [0]
//     "contains":         an object that the command's must contain
//     "numbers":          [{at, value, relative_tolerance}]: `at` is a JSON pointer into the command's object
//
// A key that is not listed here fails the test: a misspelt fact must not pass unread.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

const fs::path kExamples = fs::path(FERRERS_SOURCE_DIR) / "examples";

// ---------------------------------------------------------------------------------------------------------------------
// Files

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// The facts of one folder; null (and no exception) when the file is missing or is not JSON.
ordered_json read_expected(const fs::path& folder) {
  return ordered_json::parse(read_text(folder / "expected.json"), nullptr, /*allow_exceptions=*/false);
}

std::vector<fs::path> example_folders() {
  std::vector<fs::path> folders;
  for (const auto& entry : fs::directory_iterator(kExamples)) {
    const bool programs = entry.path().filename() == "cpp";  // that use the library: no mechanism
    if (entry.is_directory() && !programs) folders.push_back(entry.path());
  }
  std::sort(folders.begin(), folders.end());
  return folders;
}

std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> cells;
  std::string cell;
  std::istringstream in(line);
  while (std::getline(in, cell, separator)) cells.push_back(cell);
  if (!line.empty() && line.back() == separator) cells.emplace_back();
  return cells;
}

/// A CSV file: column names, and rows of cells as text.
struct Table {
  std::map<std::string, std::size_t> columns;
  std::vector<std::vector<std::string>> rows;

  const std::string& cell(std::size_t row, const std::string& column) const { return rows[row][columns.at(column)]; }
  /// NaN, which no comparison accepts, where the cell is empty or no number.
  double number(std::size_t row, const std::string& column) const {
    const std::string& text = cell(row, column);
    char* end = nullptr;
    const double value = std::strtod(text.c_str(), &end);
    return end == text.c_str() || *end != '\0' ? std::nan("") : value;
  }
};

/// Reads a table; adds a failure for a missing file or a ragged row.
Table read_table(const fs::path& file) {
  Table table;
  std::ifstream in(file);
  std::string line;
  if (!in || !std::getline(in, line)) {
    ADD_FAILURE() << "no table in " << file;
    return table;
  }
  const std::vector<std::string> names = split(line, ',');
  for (std::size_t i = 0; i < names.size(); ++i) table.columns[names[i]] = i;
  while (std::getline(in, line)) {
    table.rows.push_back(split(line, ','));
    if (table.rows.back().size() != names.size()) {
      ADD_FAILURE() << file << ": row " << table.rows.size() << " has " << table.rows.back().size() << " cells, not "
                    << names.size();
      table.rows.pop_back();
    }
  }
  return table;
}

bool same_time(double a, double b) { return std::abs(a - b) <= 1e-9 * std::max(1.0, std::abs(b)); }

/// The row at time `t`, or -1 with a failure.
int row_at(const Table& table, double t) {
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    if (same_time(table.number(row, "t"), t)) return static_cast<int>(row);
  }
  ADD_FAILURE() << "no row at t = " << t;
  return -1;
}

// ---------------------------------------------------------------------------------------------------------------------
// The command

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

struct CommandResult {
  int exit_code = -1;
  std::string line, output, errors;
};

/// Runs the command with a scratch folder for its two streams.
CommandResult run_command(const std::vector<std::string>& arguments, const fs::path& scratch) {
  CommandResult result;
  result.line = quoted(FERRERS_COMMAND);
  for (const std::string& argument : arguments) result.line += " " + quoted(argument);
  const fs::path output = scratch / "stdout", errors = scratch / "stderr";
  const int status =
      std::system((result.line + " >" + quoted(output.string()) + " 2>" + quoted(errors.string())).c_str());
  result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  result.output = read_text(output);
  result.errors = read_text(errors);
  return result;
}

/// A folder of its own for one test, removed with it unless the test failed.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::string& name)
      : path_(fs::temp_directory_path() / ("ferrers-examples-" + std::to_string(getpid())) / name) {
    fs::create_directories(path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    if (!testing::Test::HasFailure()) fs::remove_all(path_, ignored);
    fs::remove(path_.parent_path(), ignored);  // only when it is empty
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// ---------------------------------------------------------------------------------------------------------------------
// Checks

void expect_known_keys(const ordered_json& object, const std::set<std::string>& known) {
  for (const auto& [key, value] : object.items()) {
    EXPECT_TRUE(known.count(key)) << "expected.json: '" << key << "' is no fact that this test knows how to check";
  }
}

/// Every leaf of `wanted` must be in `actual` with the same value.
void expect_contains(const ordered_json& actual, const ordered_json& wanted, const std::string& path) {
  if (wanted.is_object() && actual.is_object()) {
    for (const auto& [key, value] : wanted.items()) {
      if (actual.contains(key)) {
        expect_contains(actual.at(key), value, path + "/" + key);
      } else {
        ADD_FAILURE() << path << "/" << key << " is missing; expected " << value;
      }
    }
    return;
  }
  EXPECT_EQ(actual, wanted) << "at " << path;
}

void check_analysis(const ordered_json& report, const ordered_json& facts) {
  ordered_json plain = facts;
  const ordered_json reactions = report.value("reactions", ordered_json::array());
  if (facts.contains("unique_rows_total")) {
    std::size_t total = 0;
    for (const auto& joint : reactions) total += joint.at("unique_rows").size();
    EXPECT_EQ(total, facts.at("unique_rows_total").get<std::size_t>()) << "unique_rows over all joints";
    plain.erase("unique_rows_total");
  }
  if (facts.contains("unique_dimension_total")) {
    int total = 0;
    for (const auto& joint : reactions) total += joint.at("unique_dimension").get<int>();
    EXPECT_EQ(total, facts.at("unique_dimension_total").get<int>()) << "unique_dimension over all joints";
    plain.erase("unique_dimension_total");
  }
  if (facts.contains("confident")) {
    const ordered_json certainty = report.value("certainty", ordered_json::object());
    EXPECT_EQ(certainty.value("confident", ordered_json()), facts.at("confident")) << "certainty: " << certainty;
    plain.erase("confident");
  }
  expect_contains(report, plain, "");
}

void check_result(const Table& table, const ordered_json& facts) {
  for (const auto& fact : facts) {
    SCOPED_TRACE("result.csv: " + fact.dump());
    expect_known_keys(fact, {"t", "column", "value", "tolerance"});
    const std::string column = fact.at("column");
    if (!table.columns.count(column)) {
      ADD_FAILURE() << "no column '" << column << "'";
      continue;
    }
    const int row = row_at(table, fact.at("t"));
    if (row < 0) continue;
    EXPECT_NEAR(table.number(row, column), fact.at("value").get<double>(), fact.at("tolerance"));
  }
}

/// Row number of each (joint, component), in order of time.
using ReactionIndex = std::map<std::pair<std::string, std::string>, std::vector<std::size_t>>;

void check_reaction(const Table& table, const ReactionIndex& index, const ordered_json& fact) {
  SCOPED_TRACE("reactions.csv: " + fact.dump());
  expect_known_keys(fact, {"t", "joint", "component", "value", "relative_tolerance", "absolute_tolerance", "status"});
  const auto rows = index.find({fact.at("joint"), fact.at("component")});
  if (rows == index.end()) {
    ADD_FAILURE() << "no row for this joint and component";
    return;
  }
  const double t = fact.at("t");
  const auto row = std::find_if(rows->second.begin(), rows->second.end(),
                                [&](std::size_t r) { return same_time(table.number(r, "t"), t); });
  if (row == rows->second.end()) {
    ADD_FAILURE() << "no row at this time";
    return;
  }
  const std::string status = fact.at("status");
  EXPECT_EQ(table.cell(*row, "status"), status);
  if (status == "undetermined") {
    EXPECT_EQ(table.cell(*row, "value"), "") << "an undetermined reaction must have no value";
  } else {
    ASSERT_TRUE(fact.contains("value")) << "expected.json: a determined reaction wants a value";
    const double value = fact.at("value");
    const double tolerance =
        std::max(fact.value("absolute_tolerance", 0.0), std::abs(value) * fact.value("relative_tolerance", 0.0));
    EXPECT_NE(table.cell(*row, "value"), "");
    EXPECT_NEAR(table.number(*row, "value"), value, tolerance);
  }
}

void check_reactions(const Table& table, const ordered_json& facts) {
  ReactionIndex index;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    index[{table.cell(row, "joint"), table.cell(row, "component")}].push_back(row);
  }
  for (const auto& fact : facts) check_reaction(table, index, fact);
}

/// The largest of some errors and its time; a NaN is larger than everything and stays.
struct Worst {
  double value = 0, t = 0;
  void add(double error, double at) {
    if (std::isnan(value) || error <= value) return;
    value = error, t = at;
  }
};

/// Compares every cell and reports the worst of each column, so that a wrong motion is one message, not hundreds.
void check_trajectory(const Table& table, const fs::path& file, double tolerance) {
  const Table wanted = read_table(file);
  for (const auto& [column, position] : wanted.columns) {
    if (column == "t") continue;
    if (!table.columns.count(column)) {
      ADD_FAILURE() << "result.csv has no column '" << column << "'";
      continue;
    }
    Worst worst;
    for (std::size_t row = 0; row < wanted.rows.size(); ++row) {
      const double t = wanted.number(row, "t");
      const int here = row_at(table, t);
      if (here < 0) continue;
      const double error = std::abs(table.number(here, column) - wanted.number(row, column));
      worst.add(error, t);
    }
    EXPECT_LE(worst.value, tolerance) << column << " leaves the trajectory of " << file << " most at t = " << worst.t;
  }
}

void check_energy(const Table& table, double bound) {
  ASSERT_TRUE(table.columns.count("energy")) << "result.csv has no column 'energy'";
  ASSERT_FALSE(table.rows.empty());
  Worst worst;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    worst.add(std::abs(table.number(row, "energy") - table.number(0, "energy")), table.number(row, "t"));
  }
  EXPECT_LE(worst.value, bound) << "energy drifts most at t = " << worst.t;
}

// ---------------------------------------------------------------------------------------------------------------------
// One test per model file and verb

struct Example {
  std::string folder, file, verb;
  std::string name() const {
    std::string name = folder + "_" + fs::path(file).stem().string() + "_" + verb;
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
    return name;
  }
};

void PrintTo(const Example& example, std::ostream* out) {
  *out << example.verb << " examples/" << example.folder << "/" << example.file;
}

std::vector<Example> all_examples() {
  std::vector<Example> examples;
  for (const fs::path& folder : example_folders()) {
    const ordered_json expected = read_expected(folder);
    if (!expected.is_object()) continue;  // reported by EveryFolderTellsWhyAndWhat
    for (const auto& [file, verbs] : expected.items()) {
      for (const auto& [verb, facts] : verbs.items()) examples.push_back({folder.filename().string(), file, verb});
    }
  }
  return examples;
}

class ExampleTest : public testing::TestWithParam<Example> {
 protected:
  fs::path folder() const { return kExamples / GetParam().folder; }
  std::string model() const { return (folder() / GetParam().file).string(); }

  void check_analyze(const ordered_json& facts, const fs::path& scratch) {
    const CommandResult run = run_command({"analyze", model(), "--json"}, scratch);
    SCOPED_TRACE(run.line);
    const int exit_code = facts.value("exit_code", 0);
    ASSERT_EQ(run.exit_code, exit_code) << run.output << run.errors;
    const ordered_json report = ordered_json::parse(run.output, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(report.is_object()) << "stdout is not one JSON object:\n" << run.output;
    EXPECT_EQ(report.value("ok", ordered_json()), exit_code == 0) << report.value("diagnostics", ordered_json());
    for (const auto& text : facts.value("errors", ordered_json::array())) {
      EXPECT_NE(run.errors.find(text.get<std::string>()), std::string::npos) << text << " is not in:\n" << run.errors;
    }
    ordered_json plain = facts;
    plain.erase("exit_code");
    plain.erase("errors");
    check_analysis(report, plain);
  }

  void check_answer(const ordered_json& facts, const fs::path& scratch) {
    expect_known_keys(facts, {"args", "exit_code", "contains", "numbers"});
    std::vector<std::string> arguments = {GetParam().verb, model(), "--json"};
    for (const auto& argument : facts.value("args", ordered_json::array())) arguments.push_back(argument);
    const CommandResult run = run_command(arguments, scratch);
    SCOPED_TRACE(run.line);
    ASSERT_EQ(run.exit_code, facts.value("exit_code", 0)) << run.output << run.errors;
    const ordered_json answer = ordered_json::parse(run.output, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(answer.is_object()) << "stdout is not one JSON object:\n" << run.output;
    EXPECT_EQ(answer.value("ok", ordered_json()), run.exit_code == 0);
    expect_contains(answer, facts.value("contains", ordered_json::object()), "");
    for (const auto& fact : facts.value("numbers", ordered_json::array())) {
      expect_known_keys(fact, {"at", "value", "relative_tolerance"});
      const ordered_json::json_pointer at(fact.at("at").get<std::string>());
      ASSERT_TRUE(answer.contains(at) && answer.at(at).is_number()) << "no number at " << fact.at("at");
      const double value = fact.at("value");
      EXPECT_NEAR(answer.at(at).get<double>(), value, std::abs(value) * fact.at("relative_tolerance").get<double>())
          << "at " << fact.at("at");
    }
  }

  void check_run(const ordered_json& facts, const fs::path& scratch) {
    expect_known_keys(facts, {"args", "result", "reactions", "trajectory", "energy_drift_max"});
    const fs::path out = scratch / "run";
    std::vector<std::string> arguments = {GetParam().verb, model()};
    for (const auto& argument : facts.value("args", ordered_json::array())) arguments.push_back(argument);
    arguments.insert(arguments.end(), {"-o", out.string()});
    const CommandResult run = run_command(arguments, scratch);
    SCOPED_TRACE(run.line);
    ASSERT_EQ(run.exit_code, 0) << run.output << run.errors;
    const Table result = read_table(out / "result.csv");
    ASSERT_TRUE(result.columns.count("t"));
    if (facts.contains("result")) check_result(result, facts.at("result"));
    if (facts.contains("energy_drift_max")) check_energy(result, facts.at("energy_drift_max"));
    if (facts.contains("trajectory")) {
      const ordered_json& trajectory = facts.at("trajectory");
      check_trajectory(result, folder() / trajectory.at("file").get<std::string>(), trajectory.at("tolerance"));
    }
    if (facts.contains("reactions")) check_reactions(read_table(out / "reactions.csv"), facts.at("reactions"));
    EXPECT_TRUE(fs::exists(out / "summary.json"));
  }
};

TEST_P(ExampleTest, ShowsItsFacts) {
  const ordered_json facts = read_expected(folder()).at(GetParam().file).at(GetParam().verb);
  if (GetParam().verb == "analyze") {
    const ScratchFolder scratch(GetParam().name());
    check_analyze(facts, scratch.path());
    return;
  }
  const ordered_json runs = facts.is_array() ? facts : ordered_json::array({facts});
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const ScratchFolder scratch(GetParam().name() + "_" + std::to_string(i));
    const bool is_answer = GetParam().verb == "equilibrium" || GetParam().verb == "linearize";
    is_answer ? check_answer(runs[i], scratch.path()) : check_run(runs[i], scratch.path());
  }
}

INSTANTIATE_TEST_SUITE_P(Examples, ExampleTest, testing::ValuesIn(all_examples()),
                         [](const auto& example) { return example.param.name(); });

// ---------------------------------------------------------------------------------------------------------------------
// The folders themselves

TEST(ExampleFoldersTest, EveryFolderTellsWhyAndWhat) {
  const std::set<std::string> verbs = {"analyze", "simulate", "inverse", "kinematics", "equilibrium", "linearize"};
  for (const fs::path& folder : example_folders()) {
    SCOPED_TRACE(folder);
    EXPECT_GT(read_text(folder / "README.md").size(), 500u) << "a README of a few words does not explain the mechanism";
    const ordered_json expected = read_expected(folder);
    EXPECT_TRUE(expected.is_object()) << "expected.json is missing or is not a JSON object";
    if (!expected.is_object()) continue;
    for (const auto& [file, facts] : expected.items()) {
      EXPECT_TRUE(fs::exists(folder / file)) << "expected.json speaks of " << file << ", which is not there";
      EXPECT_TRUE(facts.contains("analyze")) << file << " has no facts about its redundancy";
      expect_known_keys(facts, verbs);
    }
  }
}

TEST(ExampleFoldersTest, NoModelIsLeftUnchecked) {
  int models = 0;
  for (const fs::path& folder : example_folders()) {
    const ordered_json expected = read_expected(folder);
    for (const auto& entry : fs::directory_iterator(folder)) {
      if (entry.path().extension() != ".yaml") continue;
      ++models;
      const std::string file = entry.path().filename().string();
      EXPECT_TRUE(expected.is_object() && expected.contains(file)) << folder << ": no facts about " << file;
    }
  }
  EXPECT_GE(models, 28);
}

TEST(ExampleFoldersTest, ChainOfFourBarsIsWhatItsGeneratorWrites) {
  if (std::system("command -v python3 >/dev/null 2>&1") != 0) GTEST_SKIP() << "python3 is not installed";
  const fs::path folder = kExamples / "n-four-bar-a02";
  const std::array<std::array<const char*, 2>, 4> variants = {{{"1", "model-n1.yaml"},
                                                               {"2", "model.yaml"},
                                                               {"40", "model-n40.yaml"},
                                                               {"2 --horizontal", "model-horizontal.yaml"}}};
  const ScratchFolder scratch("generate");
  for (const auto& [arguments, file] : variants) {
    SCOPED_TRACE(file);
    const fs::path written = scratch.path() / file;
    const std::string line =
        "python3 " + quoted((folder / "generate.py").string()) + " " + arguments + " >" + quoted(written.string());
    ASSERT_EQ(std::system(line.c_str()), 0) << line;
    EXPECT_EQ(read_text(written), read_text(folder / file));
  }
}

}  // namespace
