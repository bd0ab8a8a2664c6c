#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "exit_code.h"
#include "ferrers/formats/writers.h"
#include "ferrers/io/run_folder.h"
#include "model_input.h"
#include "terminal.h"
#include "verbs.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

struct ConvertOptions : ModelOptions {
  std::string output, to;
  bool force = false, snap = false;
};

ModelFormat target(const ConvertOptions& options) {
  for (const ModelFormat format : written_formats()) {
    if (options.to == format_word(format)) return format;
  }
  return options.output.empty() ? ModelFormat::kNative : format_of(options.output, "");
}

void print_json(const ConvertOptions& options, const LoadedModel& loaded, ModelFormat format,
                const std::vector<std::string>& files) {
  nlohmann::ordered_json renamed = nlohmann::ordered_json::array();
  for (const RenamedThing& one : loaded.renamed) {
    renamed.push_back({{"kind", one.kind}, {"original", one.original}, {"name", one.name}});
  }
  nlohmann::ordered_json told = nlohmann::ordered_json::array();
  for (const Diagnostic& one : loaded.diagnostics.items()) {
    told.push_back({{"code", one.code}, {"line", one.at.line}, {"column", one.at.column}, {"message", one.message}});
  }
  const nlohmann::ordered_json object = {{"schema", "ferrers.convert/1"},
                                         {"ok", loaded.model != nullptr},
                                         {"file", options.file},
                                         {"from", format_name(loaded.format)},
                                         {"to", format_name(format)},
                                         {"written", files},
                                         {"renamed", renamed},
                                         {"diagnostics", told}};
  print(stdout, object.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
}

/// Every joint that moved, to stderr.
void tell_moves(const LoadedModel& loaded) {
  if (!loaded.geometry) return;
  if (loaded.geometry->verdict == GeometryVerdict::kExact) {
    print(stderr, "ferrers: nothing had to move\n");
    return;
  }
  for (const SeatMove& move : loaded.geometry->moves) {
    print(stderr, fmt::format("ferrers: the seats of '{}' moved by {} and {}\n", move.joint,
                              length_text(move.distance_m), angle_text(move.angle_rad)));
  }
}

/// The native format takes numbers at their word.
void tell_noise(const ConvertOptions& options, LoadedModel& loaded) {
  LoadedModel treated = loaded;
  make_geometry_consistent(options, treated);
  if (!treated.geometry || !treated.geometry->spec) return;
  loaded.diagnostics.warning("F515", {},
                             fmt::format("the numbers are good to {:.2g} only, and are written as they are: in the "
                                         "native format they would be taken at their word",
                                         treated.geometry->tolerance),
                             "--snap moves the joints to where they are exact");
  print_new_diagnostic(loaded);
}

/// A file of closures from before that the model's file would be read with.
std::string stale_closures(const std::vector<WrittenFile>& files) {
  if (files.size() != 1 || format_of(files[0].name, "") != ModelFormat::kUrdf) return "";
  std::filesystem::path beside = files[0].name;
  beside.replace_extension(".closures.yaml");
  std::error_code ignored;
  return std::filesystem::exists(beside, ignored) ? beside.string() : "";
}

int convert(const ConvertOptions& options) {
  const ModelFormat format = target(options);
  if (options.json && options.output.empty())
    return command_line_error("'--json' needs '-o FILE' to write the model to");
  LoadedModel loaded = load_model_as_written(options);
  if (!loaded.model) {
    if (options.json) print_json(options, loaded, format, {});
    return kExitModel;
  }
  if (options.snap) {
    make_geometry_consistent(options, loaded);
    tell_moves(loaded);
  } else if (format == ModelFormat::kNative) {
    tell_noise(options, loaded);
  }
  if (const std::string error = write_model_if_asked(options, loaded); !error.empty()) return command_line_error(error);
  Diagnostics told(options.file);
  const std::vector<WrittenFile> files =
      write_any_model(edited_spec(options, loaded), format, options.output, loaded.visuals, told);
  print_diagnostics(told, loaded.source);
  loaded.diagnostics.append(told);
  if (told.has_errors()) return kExitModel;
  if (options.output.empty()) {
    for (const WrittenFile& file : files) print(stdout, file.text);
    return kExitDone;
  }
  std::vector<std::string> written;
  for (const WrittenFile& file : files) {
    std::error_code ignored;
    if (std::filesystem::exists(file.name, ignored) && !options.force) {
      return command_line_error(fmt::format("'{}' exists; --force replaces it", file.name));
    }
  }
  if (const std::string stale = stale_closures(files); !stale.empty()) {
    if (!options.force) {
      return command_line_error(
          fmt::format("'{}' exists, and would close loops of this model; --force removes it", stale));
    }
    std::error_code ignored;
    std::filesystem::remove(stale, ignored);
  }
  for (const WrittenFile& file : files) {
    if (const std::string error = write_file_whole(file.name, file.text); !error.empty())
      return command_line_error(error);
    written.push_back(file.name);
  }
  if (options.json) {
    print_json(options, loaded, format, written);
    return kExitDone;
  }
  for (const RenamedThing& one : loaded.renamed) {
    print(stdout, fmt::format("{} '{}' is '{}' now\n", one.kind, one.original, one.name));
  }
  print(stdout, fmt::format("wrote {} ({})\n", fmt::join(written, ", "), format_name(format)));
  return kExitDone;
}

}  // namespace

void add_convert(CLI::App& command, Job& job) {
  auto options = std::make_shared<ConvertOptions>();
  CLI::App* verb = command.add_subcommand("convert", "write a model of any format in another one");
  add_model_options(*verb, *options);
  verb->add_option("-o,--output", options->output, "file to write; without it the text goes to stdout")
      ->type_name("FILE");
  verb->add_option("--to", options->to, "format; else by the ending of FILE, else native")
      ->check(CLI::IsMember(written_format_words()))
      ->type_name("FORMAT");
  verb->add_flag("--snap", options->snap,
                 "move the joints to the consistent geometry within --geometric-tolerance, and tell how far");
  verb->add_flag("--force", options->force, "replace the file when it exists");
  verb->footer(
      "Examples:\n"
      "  ferrers convert robot.urdf -o robot.yaml\n"
      "  ferrers convert press.yaml --to mjcf\n"
      "\nWhat the written format cannot say is listed (F607). Exit codes: 0 done; 2 the file exists, or cannot be "
      "written; 3 the\nmodel has errors.");
  verb->callback([options, &job] { job = [options] { return convert(*options); }; });
}
