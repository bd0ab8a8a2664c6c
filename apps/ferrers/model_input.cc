#include "model_input.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <algorithm>
#include <cstdio>
#include <numbers>

#include "exit_code.h"
#include "ferrers/io/model_writer.h"
#include "ferrers/io/run_folder.h"
#include "terminal.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace): the command speaks the library's language

namespace {

constexpr std::size_t kMostOpenJoints = 10;
constexpr std::size_t kMostRenamed = 12;
constexpr double kRounding = 1e-15;  // m or rad: no share of a contradiction

/// Colours the severity and the underline of a formatted diagnostic.
std::string painted(const std::string& text, const Style& style) {
  if (!style.colored()) return text;
  std::string out;
  std::size_t begin = 0;
  while (begin <= text.size()) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    const std::size_t mark = line.find_first_not_of(" |");
    if (begin == 0) {
      std::size_t at = std::string::npos, length = 0;
      for (const std::string_view word : {"error[", "warning[", "notice["}) {
        if (const std::size_t found = line.find(word); found < at)
          at = found, length = line.find(']', found) + 1 - found;
      }
      if (at == std::string::npos) {
        out += line;
      } else {
        const std::string word = line.substr(at, length);
        out += line.substr(0, at) + (word[0] == 'e' ? style.red(word) : style.yellow(word)) + line.substr(at + length);
      }
    } else if (mark != std::string::npos && line[mark] == '^') {
      out += style.dim(line.substr(0, mark)) + style.red(line.substr(mark));
    } else {
      out += line;
    }
    if (end < text.size()) out += '\n';
    begin = end + 1;
  }
  return out;
}

void print_diagnostic(const Diagnostic& one, const std::string& file, std::string_view source) {
  print(stderr, painted(format_diagnostic(one, file, source), Style(stderr)) + "\n");
}

/// Where a joint or coupling is named in the file.
SourceRange place_of(const ModelSpec& spec, const std::string& name) {
  for (const JointSpec& joint : spec.joints) {
    if (joint.name.name == name) return joint.name.at;
  }
  for (const CouplingSpec& coupling : spec.couplings) {
    if (coupling.name.name == name) return coupling.name.at;
  }
  return {};
}

ImportBase base_of(const std::string& word) { return word == "free" ? ImportBase::kFree : ImportBase::kFixed; }

void ignore(const std::vector<std::string>& words, ImportOptions& options) {
  const auto has = [&](std::string_view word) { return std::find(words.begin(), words.end(), word) != words.end(); };
  options.ignore_armature = has("armature");
  options.ignore_springs = has("springs");
  options.ignore_damping = has("damping");
}

/// The map of names, as one notice.
void tell_renamed(LoadedModel& loaded) {
  if (loaded.renamed.empty()) return;
  std::string map;
  const std::size_t shown = std::min(loaded.renamed.size(), kMostRenamed);
  for (std::size_t i = 0; i < shown; ++i) {
    const RenamedThing& one = loaded.renamed[i];
    map += fmt::format("{}{} '{}' is '{}'", i > 0 ? ", " : "", one.kind, one.original, one.name);
  }
  if (shown < loaded.renamed.size()) map += fmt::format(", and {} more", loaded.renamed.size() - shown);
  loaded.diagnostics.notice("F603", {}, "names that had to change: " + map,
                            shown < loaded.renamed.size() ? "'ferrers convert' lists them all" : "");
}

std::string gap_text(const Model& model, const OpenJoint& open) {
  const bool coupling = std::any_of(model.couplings().begin(), model.couplings().end(),
                                    [&](const Coupling& one) { return one.name == open.name; });
  if (coupling) return fmt::format("'{}' is off by {}", open.name, number(open.angle_rad));
  return fmt::format("joint '{}' stays open by {} mm and {} degrees", open.name, number(1000 * open.gap_m),
                     number(open.angle_rad * 180 / std::numbers::pi));
}

// A joint's share of what is missed, or that it takes part.
std::string share_text(const JointGap& gap, bool elastic) {
  std::string share;
  if (gap.gap_m > kRounding) share = length_text(gap.gap_m);
  if (gap.angle_rad > kRounding) share += (share.empty() ? "" : " and ") + angle_text(gap.angle_rad);
  if (share.empty()) return fmt::format("'{}' takes part in the contradiction", gap.joint);
  return elastic ? fmt::format("joint '{}' has to give {}", gap.joint, share)
                 : fmt::format("joint '{}' would have to give {}, if all gave alike", gap.joint, share);
}

void report_contradiction(LoadedModel& loaded, const ContradictionReport& contradiction) {
  report(loaded, "F510", {}, contradiction.text, contradiction.hint);
  std::size_t shown = 0;
  for (const Contradiction& one : contradiction.contradictions) {
    for (const JointGap& gap : one.joints) {
      if (shown++ == kMostOpenJoints) return;
      report(loaded, "F511", place_of(loaded.model->spec(), gap.joint),
             share_text(gap, contradiction.verdict == ClosureVerdict::kElastic));
    }
  }
}

}  // namespace

void add_import_options(CLI::App& verb, ImportOptions& options) {
  const std::string group = "Files of other programs";
  verb.add_option_function<std::string>(
          "--base", [&options](const std::string& word) { options.base = base_of(word); },
          "whether the root is fixed to ground; else URDF: fixed, others: as the file says")
      ->check(CLI::IsMember({"fixed", "free"}))
      ->type_name("fixed|free")
      ->group(group);
  verb.add_option_function<std::vector<std::string>>(
          "--ignore", [&options](const std::vector<std::string>& words) { ignore(words, options); },
          "leave out armature, springs, damping of joints")
      ->check(CLI::IsMember({"armature", "springs", "damping"}))
      ->delimiter(',')
      ->allow_extra_args(false)
      ->type_name("LIST")
      ->group(group);
  verb.add_option_function<std::string>(
          "--revolute-rows", [&options](const std::string& word) { options.merge_revolute_rows = word == "merge"; },
          "URDF: revolute joints in a row that stand for one joint; else merged where loops are closed")
      ->check(CLI::IsMember({"merge", "keep"}))
      ->type_name("merge|keep")
      ->group(group);
  verb.add_option_function<std::string>(
          "--welds", [&options](const std::string& word) { options.keep_welds = word == "keep"; },
          "fixed joints between bodies: made one rigid group of them, which is usual, or kept with their reactions")
      ->check(CLI::IsMember({"merge", "keep"}))
      ->type_name("merge|keep")
      ->group(group);
  verb.add_option("--closures", options.closures,
                  "URDF: file of closed loops; else NAME.closures.yaml or NAME.yaml beside NAME.urdf")
      ->type_name("FILE")
      ->group(group);
}

void add_model_options(CLI::App& verb, ModelOptions& options) {
  verb.add_option("MODEL", options.file, "model file: YAML or JSON, URDF, MJCF, SDF, ASMT")->required()->type_name("");
  verb.add_option("-p,--parameter", options.parameters, "set a parameter of the model; may carry a unit; repeatable")
      ->type_name("NAME=VALUE")
      ->allow_extra_args(false);
  verb.add_option("--set", options.edits, "set any field, for instance bodies.crank.mass=2; repeatable")
      ->type_name("PATH=VALUE")
      ->allow_extra_args(false);
  verb.add_option("--write-model", options.write_model, "also write the model with these changes")->type_name("FILE");
  add_import_options(verb, options.import);
  verb.add_option("--geometric-tolerance", options.geometric_tolerance,
                  "what its numbers are good to, relative to its size, and rad; else 0, of CAD files 1e-6, others 1e-5")
      ->check(CLI::Range(0.0, 1e-2))
      ->check([](const std::string& text) {
        return text.find_first_of("nN") == std::string::npos ? "" : "must be a number";
      })
      ->type_name("X")
      ->group("Files of other programs");
  verb.add_flag("--json", options.json, "print one JSON object instead of text");
}

LoadedModel load_model(const ModelOptions& options) {
  LoadedModel loaded = load_model_as_written(options);
  make_geometry_consistent(options, loaded);
  if (!loaded.geometry || loaded.geometry->text.empty()) return loaded;
  loaded.diagnostics.notice("F515", {}, loaded.geometry->text);
  print_new_diagnostic(loaded);
  return loaded;
}

void make_geometry_consistent(const ModelOptions& options, LoadedModel& loaded) {
  if (!loaded.model) return;
  const double tolerance = options.geometric_tolerance.value_or(usual_geometric_tolerance(loaded.format));
  if (tolerance <= 0) return;
  loaded.geometry = find_consistent_geometry(*loaded.model, tolerance);
  if (!loaded.geometry->model) return;
  loaded.model = loaded.geometry->model;
  loaded.as_read = false;
}

LoadedModel load_model_as_written(const ModelOptions& options) {
  ReadModelOptions read;
  read.parameter_texts = options.parameters;
  read.edits = options.edits;
  ModelFile file = read_any_model_file(options.file, read, options.import);
  LoadedModel loaded;
  loaded.diagnostics = std::move(file.read.diagnostics);
  loaded.source = std::move(file.read.source);
  loaded.format = file.format;
  loaded.renamed = std::move(file.renamed);
  loaded.visuals = std::move(file.visuals);
  loaded.as_read = loaded.format == ModelFormat::kNative && options.parameters.empty() && options.edits.empty() &&
                   !options.import.keep_welds;
  if (file.read.model) loaded.model = std::make_shared<const Model>(std::move(*file.read.model));
  tell_renamed(loaded);
  print_diagnostics(loaded.diagnostics, loaded.source);
  return loaded;
}

void print_diagnostics(const Diagnostics& diagnostics, std::string_view source) {
  for (const Diagnostic& one : diagnostics.items()) print_diagnostic(one, diagnostics.file(), source);
}

void print_new_diagnostic(const LoadedModel& loaded) {
  print_diagnostic(loaded.diagnostics.items().back(), loaded.diagnostics.file(), loaded.source);
}

void report(LoadedModel& loaded, std::string_view code, SourceRange at, std::string message, std::string hint) {
  loaded.diagnostics.error(code, at, std::move(message), std::move(hint));
  print_new_diagnostic(loaded);
}

ModelSpec edited_spec(const ModelOptions& options, const LoadedModel& loaded) {
  ModelSpec spec = loaded.model->spec();
  for (const std::string& text : options.parameters) {
    const std::string name = text.substr(0, text.find('='));
    for (const Parameter& parameter : loaded.model->parameters()) {
      if (parameter.name != name) continue;
      for (ParameterSpec& one : spec.parameters) {
        if (one.name.name == name) one.value = Number(parameter.value);
      }
    }
  }
  return spec;
}

std::string model_text(const ModelOptions& options, const LoadedModel& loaded) {
  return loaded.as_read ? loaded.source : write_model(edited_spec(options, loaded));
}

std::string write_model_if_asked(const ModelOptions& options, const LoadedModel& loaded) {
  if (options.write_model.empty()) return "";
  return write_file_whole(options.write_model, model_text(options, loaded));
}

void report_open(LoadedModel& loaded, const AssemblyResult& assembly) {
  report_open(loaded, assembly, analyze_contradiction(*make_system(loaded.model), assembly));
}

void report_open(LoadedModel& loaded, const AssemblyResult& assembly, const ContradictionReport& contradiction) {
  if (!contradiction.contradictions.empty()) return report_contradiction(loaded, contradiction);
  const bool initial = assembly.status == AssemblyStatus::kInconsistentInitial;
  report(loaded, initial ? "F503" : "F501", {}, assembly.message,
         initial ? "leave positions out of 'initial', or mark them 'guess: true'"
                 : "check the lengths around the loop, or give 'initial' positions as a guess nearer to a closed pose");
  const std::size_t shown = std::min(assembly.open_joints.size(), kMostOpenJoints);
  for (std::size_t i = 0; i < shown; ++i) {
    const OpenJoint& open = assembly.open_joints[i];
    report(loaded, "F502", place_of(loaded.model->spec(), open.name), gap_text(*loaded.model, open));
  }
}

void report_masses(LoadedModel& loaded, const std::vector<std::string>& bodies) {
  for (const BodySpec& body : loaded.model->spec().bodies) {
    const std::optional<BodyId> whole = loaded.model->find_body(body.name.name);
    for (const std::string& name : bodies) {
      if (body.mass || !whole || loaded.model->body(*whole).name != name) continue;
      report(loaded, "F504", body.name.at, fmt::format("body '{}' has no mass, which dynamics needs", body.name.name),
             "give it a 'mass' and 'com'; zero is a mass as well");
    }
  }
}

int command_line_error(std::string_view message) {
  print(stderr, fmt::format("ferrers: {}\n", message));
  return kExitCommandLine;
}
