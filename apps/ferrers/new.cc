#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "examples.h"
#include "exit_code.h"
#include "ferrers/core/closest_name.h"
#include "ferrers/io/run_folder.h"
#include "model_input.h"
#include "terminal.h"
#include "verbs.h"

namespace {

struct Options {
  std::string name, file;
  bool force = false, json = false;
};

int list_examples(const Options& options) {
  if (options.json) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const EmbeddedExample& one : embedded_examples()) all.push_back({{"name", one.name}, {"title", one.title}});
    const nlohmann::ordered_json object = {{"schema", "ferrers.new/1"}, {"ok", true}, {"examples", std::move(all)}};
    print(stdout, object.dump(2) + "\n");
    return kExitDone;
  }
  std::vector<std::vector<std::string>> rows = {{"example", "what it is"}};
  for (const EmbeddedExample& one : embedded_examples())
    rows.push_back({std::string(one.name), std::string(one.title)});
  print(stdout, table(rows, "", Style(stdout)) + "\nferrers new NAME -o FILE.yaml writes one to start from.\n");
  return kExitDone;
}

int write_example(const Options& options) {
  std::vector<std::string_view> names;
  for (const EmbeddedExample& one : embedded_examples()) {
    names.push_back(one.name);
    if (one.name != options.name) continue;
    if (options.file.empty()) {
      print(stdout, one.text);
      return kExitDone;
    }
    std::error_code ignored;
    if (std::filesystem::exists(options.file, ignored) && !options.force) {
      return command_line_error(fmt::format("'{}' exists; --force replaces it", options.file));
    }
    if (const std::string error = ferrers::write_file_whole(options.file, one.text); !error.empty()) {
      return command_line_error(error);
    }
    if (options.json) {
      const nlohmann::ordered_json object = {
          {"schema", "ferrers.new/1"}, {"ok", true}, {"name", one.name}, {"file", options.file}};
      print(stdout, object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    } else {
      print(stdout, fmt::format("{}: {}. Try: ferrers analyze {}\n", options.file, one.title, options.file));
    }
    return kExitDone;
  }
  const std::string hint = ferrers::did_you_mean(options.name, names);
  return command_line_error(fmt::format("there is no example '{}'{}{}\n'ferrers new' lists them.", options.name,
                                        hint.empty() ? "" : "; ", hint));
}

}  // namespace

void add_new(CLI::App& command, Job& job) {
  auto options = std::make_shared<Options>();
  CLI::App* verb = command.add_subcommand("new", "start a model file from an example");
  verb->add_option("NAME", options->name, "example; without it they are listed")->type_name("");
  verb->add_option("-o,--output", options->file, "file to write; without it the text goes to stdout")
      ->type_name("FILE");
  verb->add_flag("--force", options->force, "replace the file when it exists");
  verb->add_flag("--json", options->json, "print one JSON object instead of text");
  verb->footer("Examples:\n  ferrers new\n  ferrers new door -o door.yaml");
  verb->callback([options, &job] {
    job = [options] { return options->name.empty() ? list_examples(*options) : write_example(*options); };
  });
}
