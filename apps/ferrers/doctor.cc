#include <fmt/core.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <CLI/Version.hpp>
#include <Eigen/Core>
#include <cfloat>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "examples.h"
#include "exit_code.h"
#include "ferrers/core/diagnostics.h"
#include "ferrers/io/model_reader.h"
#include "ferrers/redundancy/analysis.h"
#include "terminal.h"
#include "verbs.h"

namespace {

using nlohmann::ordered_json;

struct Check {
  std::string name;
  bool passed;
  std::string detail;
};

bool assertions_on() {
#ifdef NDEBUG
  return false;
#else
  return true;
#endif
}

std::vector<std::pair<std::string, std::string>> versions() {
  return {{"eigen", fmt::format("{}.{}.{}", EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"fmt", fmt::format("{}.{}.{}", FMT_VERSION / 10000, FMT_VERSION / 100 % 100, FMT_VERSION % 100)},
          {"yaml-cpp", FERRERS_YAML_CPP_VERSION},
          {"nlohmann-json", fmt::format("{}.{}.{}", NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                        NLOHMANN_JSON_VERSION_PATCH)},
          {"CLI11", CLI11_VERSION}};
}

/// Results rest on doubles being rounded to nearest, once per operation.
Check check_arithmetic() {
  volatile double one = 1.0, tiny = DBL_EPSILON / 2;
  const volatile double nearest = one + tiny, above = one + 1.5 * DBL_EPSILON;
  const bool good = FLT_EVAL_METHOD == 0 && nearest == 1.0 && above == 1.0 + 2 * DBL_EPSILON;
  return {"arithmetic", good, good ? "doubles round to nearest" : "doubles do not round as results need it"};
}

Check check_folder() {
  namespace fs = std::filesystem;
  std::error_code failed;
  const fs::path folder = fs::temp_directory_path(failed);
  const bool good = !failed && fs::is_directory(folder, failed);
  return {"temporary files", good, good ? folder.string() : "there is no folder for temporary files"};
}

/// Every embedded example must be read without an error.
Check check_examples() {
  std::size_t read = 0;
  for (const EmbeddedExample& one : embedded_examples()) {
    const auto result = ferrers::read_model_text(std::string(one.text), std::string(one.name));
    if (result.model) ++read;
  }
  const std::size_t all = embedded_examples().size();
  return {"examples", read == all && all > 0, fmt::format("{} of {} are read without an error", read, all)};
}

int doctor(bool json) {
  const std::vector<Check> checks = {check_arithmetic(), check_folder(), check_examples()};
  bool good = true;
  for (const Check& check : checks) good = good && check.passed;
  const std::size_t codes = ferrers::diagnostic_codes().size();
  const std::vector<std::string> features = {"yaml", "json", "csv"};
  if (json) {
    ordered_json object = {{"schema", "ferrers.doctor/1"},
                           {"ok", good},
                           {"version", FERRERS_VERSION},
                           {"compiler", FERRERS_COMPILER},
                           {"build", FERRERS_BUILD_TYPE}};
    object["assertions"] = assertions_on();
    object["features"] = features;
    object["dependencies"] = ordered_json::object();
    for (const auto& [name, version] : versions()) object["dependencies"][name] = version;
    object["diagnostic_codes"] = codes;
    object["checks"] = ordered_json::array();
    for (const Check& one : checks) {
      object["checks"].push_back({{"name", one.name}, {"passed", one.passed}, {"detail", one.detail}});
    }
    print(stdout, object.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n");
    return good ? kExitDone : kExitCheckFailed;
  }
  const Style style(stdout);
  std::string text = style.bold("ferrers " FERRERS_VERSION) + "\n\n";
  std::vector<std::vector<std::string>> rows = {{"built with", ""}};
  rows.push_back({"compiler", FERRERS_COMPILER});
  rows.push_back({"build", fmt::format("{}, assertions {}", FERRERS_BUILD_TYPE, assertions_on() ? "on" : "off")});
  for (const auto& [name, version] : versions()) rows.push_back({name, version});
  rows.push_back({"formats", "model files in YAML and JSON, results in CSV and JSON"});
  rows.push_back({"messages", fmt::format("{} documented codes", codes)});
  text += table(rows, "  ", style) + "\n";
  rows = {{"check", "", ""}};
  for (const Check& one : checks)
    rows.push_back({one.name, one.passed ? style.green("good") : style.red("bad"), one.detail});
  print(stdout, text + table(rows, "  ", style));
  return good ? kExitDone : kExitCheckFailed;
}

}  // namespace

void add_doctor(CLI::App& command, Job& job) {
  auto json = std::make_shared<bool>(false);
  CLI::App* verb = command.add_subcommand("doctor", "version, features, and whether this computer is fit");
  verb->add_flag("--json", *json, "print one JSON object instead of text");
  verb->footer("Exit codes: 0 all is well; 1 a check failed.");
  verb->callback([json, &job] { job = [json] { return doctor(*json); }; });
}
