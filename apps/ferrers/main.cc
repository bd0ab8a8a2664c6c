// The command `ferrers`: finds the verb, lets it run, turns what went wrong into an exit code.

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "exit_code.h"
#include "ferrers/core/closest_name.h"
#include "terminal.h"
#include "verbs.h"

namespace {

// One line per verb.
constexpr void (*kVerbs[])(CLI::App&, Job&) = {
    add_analyze,   add_inverse,   add_simulate, add_sweep,  add_kinematics, add_equilibrium,
    add_linearize, add_equations, add_convert,  add_schema, add_new,        add_doctor,
};

void describe(CLI::App& command) {
  command.description("Dynamics of mechanisms with redundant constraints.");
  command.set_version_flag("--version", "ferrers " FERRERS_VERSION, "print the version");
  command.set_help_flag("-h,--help", "print this text");
  command.require_subcommand(0, 1);
  command.get_formatter()->column_width(34);
  command.get_formatter()->label("SUBCOMMAND", "VERB");
  command.get_formatter()->label("REQUIRED", "");
  command.footer(
      "Examples:\n"
      "  ferrers analyze model.yaml              which constraints are redundant, which reactions are unique\n"
      "  ferrers simulate model.yaml --end 10    how it moves under its forces\n"
      "  ferrers sweep model.yaml --table p.csv  where that ends for many sets of parameter values\n"
      "  ferrers new door -o door.yaml           a model to start from\n"
      "\n'ferrers help VERB', or 'ferrers VERB --help', tells the options of a verb. Results go to stdout, progress "
      "and\n"
      "diagnostics to stderr. NO_COLOR is honoured.");
}

std::vector<std::string> verb_names(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* verb : command.get_subcommands(nullptr)) names.push_back(verb->get_name());
  return names;
}

std::vector<std::string> option_names(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(fmt::format("--{}", name));
    for (const std::string& name : option->get_snames()) names.push_back(fmt::format("-{}", name));
  }
  return names;
}

std::string with_hint(std::string text, const std::string& hint) { return hint.empty() ? text : text + "; " + hint; }

/// The words of the command line, with `help` and `help VERB` as the option that they stand for.
std::vector<std::string> words_of(int argc, char** argv) {
  std::vector<std::string> words(argv + std::min(argc, 1), argv + argc);
  const bool asks = !words.empty() && words.front() == "help";
  while (!words.empty() && words.front() == "help") words.erase(words.begin());
  if (asks) words.emplace_back("--help");
  return words;
}

std::string verb_hint(const CLI::App& command, const std::string& word) {
  std::error_code ignored;
  if (std::filesystem::is_regular_file(word, ignored)) {
    return fmt::format("the verb comes first: ferrers analyze {}", word);
  }
  std::vector<std::string> names = verb_names(command);
  const std::string all = fmt::format("the verbs are {}", fmt::join(names, ", "));
  names.emplace_back("help");
  const std::string near = ferrers::did_you_mean(word, names);
  return near.empty() ? all : near;
}

/// What to say about words that nothing took; empty when there are none. `asked` is the verb, or the command.
std::string unknown_words(const CLI::App& command, const CLI::App& asked) {
  const std::vector<std::string> words = asked.remaining(true);
  if (&asked == &command) {
    for (const std::string& word : words) {
      if (word.empty() || word[0] != '-') {
        return with_hint(fmt::format("unknown verb '{}'", word), verb_hint(command, word));
      }
    }
  }
  for (const std::string& word : words) {
    if (word.size() > 1 && word[0] == '-') {
      const std::string name = word.substr(0, word.find('='));
      return with_hint(fmt::format("unknown option '{}'", name), ferrers::did_you_mean(name, option_names(asked)));
    }
  }
  if (words.empty()) return "";
  return fmt::format("'{}' is one word too many", words.front());
}

int explain(const CLI::App& command, const CLI::ParseError& error) {
  const std::vector<CLI::App*> asked = command.get_subcommands();
  const CLI::App& app = asked.empty() ? command : *asked.front();
  const std::string name = asked.empty() ? "ferrers" : "ferrers " + app.get_name();
  const bool asks = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::Success);
  if (asks && (!asked.empty() || command.remaining(true).empty())) {
    const auto* version = dynamic_cast<const CLI::CallForVersion*>(&error);
    print(stdout, version != nullptr ? std::string(error.what()) + "\n" : command.help());
    return kExitDone;
  }
  std::string what = unknown_words(command, app);
  if (what.empty()) what = error.what();
  print(stderr, fmt::format("{}: {}\nSee '{} --help'.\n", name, what, name));
  return kExitCommandLine;
}

int run(int argc, char** argv) {
  CLI::App command;
  command.name("ferrers");
  describe(command);
  Job job;
  for (const auto add : kVerbs) add(command, job);
  for (CLI::App* verb : command.get_subcommands(nullptr)) verb->group("Verbs");
  try {
    std::vector<std::string> words = words_of(argc, argv);
    std::reverse(words.begin(), words.end());  // as parse takes them
    command.parse(std::move(words));
  } catch (const CLI::ParseError& error) {
    return explain(command, error);
  }
  if (!job) {
    print(stderr, command.help() + "\nferrers: a verb is missing\n");
    return kExitCommandLine;
  }
  return job();
}

int our_bug(const char* what, int argc, char** argv) {
  std::string line;
  for (int i = 0; i < argc; ++i) line += fmt::format("{}{}", i > 0 ? " " : "", argv[i]);
  print(stderr, fmt::format("ferrers: this is a bug of ours: {}\n"
                            "  Please report it with this line, the model file and the version:\n"
                            "    {}\n    ferrers " FERRERS_VERSION ", " FERRERS_COMPILER "\n",
                            what, line));
  return kExitOurBug;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& error) {
    return our_bug(error.what(), argc, argv);
  } catch (...) {
    return our_bug("an unknown exception", argc, argv);
  }
}
