#include "ferrers/io/model_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

#include "ferrers/core/closest_name.h"
#include "ferrers/io/document.h"
#include "ferrers/io/document_edit.h"
#include "ferrers/io/spec_reader.h"
#include "ferrers/io/text_file.h"

namespace ferrers {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostDiagnostics = 200;

void add(Diagnostics& to, const Diagnostic& one) {
  switch (one.severity) {
    case Severity::kError:
      return to.error(one.code, one.at, one.message, one.hint);
    case Severity::kWarning:
      return to.warning(one.code, one.at, one.message, one.hint);
    case Severity::kNotice:
      return to.notice(one.code, one.at, one.message, one.hint);
  }
}

/// Of what model building says about a specification that the reader found faulty: only what does not follow from the
/// faults already reported.
class ConsequenceFilter {
 public:
  explicit ConsequenceFilter(const ReaderFaults& faults) : faults_(faults) {}

  bool is_consequence(const Diagnostic& one) const {
    if (one.code == "F309" && (one.at.known() || one.at.column < 0)) return true;  // a number reported before
    if (one.code == "F315" && (faults_.joint_without_bodies || faults_.section_without_entries)) return true;
    if (faults_.section_without_entries &&
        (one.code == "F303" || one.code == "F304" || one.code == "F306" || one.code == "F403")) {
      return true;
    }
    for (const std::string& joint : faults_.joints_without_type) {
      const bool about_coordinate = one.code == "F305" || one.code == "F403" || one.code == "F330";
      if (about_coordinate && one.message.find("'" + joint) != std::string::npos) return true;
    }
    return std::any_of(faults_.entries.begin(), faults_.entries.end(), [&](const FaultyEntry& entry) {
      if (!entry.contains(one.at)) return false;
      if (one.code == "F301" || one.code == "F302") return false;
      const bool about_name_written = one.code == "F303" || one.code == "F304" || one.code == "F305" ||
                                      one.code == "F306" || one.code == "F403" || one.code == "F204";
      return !about_name_written || one.at == entry.name_at;
    });
  }

 private:
  const ReaderFaults& faults_;
};

/// Merges, sorts, drops what is said twice, and stops where nobody reads on.
Diagnostics merged(const Diagnostics& reader, const Diagnostics& builder, const ReaderFaults& faults) {
  Diagnostics all(reader.file());
  std::set<std::tuple<std::string, int, int, std::string>> seen;
  const auto take = [&](const Diagnostic& one) {
    if (seen.emplace(one.code, one.at.line, one.at.column, one.at.known() ? "" : one.message).second) add(all, one);
  };
  for (const Diagnostic& one : reader.items()) take(one);
  const ConsequenceFilter filter(faults);
  for (const Diagnostic& one : builder.items()) {
    if (!filter.is_consequence(one)) take(one);
  }
  all.sort_by_place();
  if (all.items().size() <= kMostDiagnostics) return all;
  Diagnostics first(all.file());
  for (std::size_t i = 0; i < kMostDiagnostics; ++i) add(first, all.items()[i]);
  first.error("F218", {}, fmt::format("{} more are not shown", all.items().size() - kMostDiagnostics));
  return first;
}

/// 'name=value' with a unit that fits the parameter.
void read_parameter_texts(const ReadModelOptions& options, const ModelSpec& spec, ValueReader& values,
                          std::map<std::string, double>& overrides) {
  for (const std::string& text : options.parameter_texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) {
      values.error("F216", {}, fmt::format("{} is not name=value", quoted_in_message(text)),
                   "for instance length=120 mm");
      continue;
    }
    const std::string name = text.substr(0, equals);
    const auto found = std::find_if(spec.parameters.begin(), spec.parameters.end(),
                                    [&](const ParameterSpec& one) { return one.name.name == name; });
    if (found == spec.parameters.end()) {
      std::vector<std::string_view> known;
      for (const ParameterSpec& one : spec.parameters) known.push_back(one.name.name);
      values.error("F216", {}, fmt::format("the model has no parameter {}", quoted_in_message(name)),
                   did_you_mean(name, known));
      continue;
    }
    const auto written =
        values.written_number(std::string_view(text).substr(equals + 1), {}, {name, {}}, found->dimension);
    if (written) overrides[name] = written->value;
  }
}

}  // namespace

ModelReadResult read_model_text(std::string text, std::string name, const ReadModelOptions& options) {
  ModelReadResult result;
  result.source = std::move(text);
  result.diagnostics.set_file(name);
  std::optional<DocumentNode> root = parse_document(result.source, result.diagnostics);
  if (!root) return result;
  edit_document(*root, options.edits, result.diagnostics);
  LawFiles laws(options.folder);
  ValueReader values(laws, result.diagnostics);
  SpecReader reader(values);
  result.spec = reader.read(*root, fs::path(name).stem().string());
  if (options.keep_welds) keep_welds(result.spec);
  std::map<std::string, double> overrides = options.parameters;
  read_parameter_texts(options, result.spec, values, overrides);
  ModelBuildResult built = build_model(result.spec, overrides);
  result.diagnostics = name_edits(merged(result.diagnostics, built.diagnostics, reader.faults()), options.edits);
  if (!built.model && !result.diagnostics.has_errors())
    result.diagnostics = built.diagnostics;  // nothing to follow from
  if (!result.diagnostics.has_errors()) result.model = std::move(built.model);
  return result;
}

ModelReadResult read_model_file(const fs::path& path, const ReadModelOptions& options) {
  Diagnostics diagnostics(path.string());
  std::optional<std::string> text = load_text_file(path, diagnostics);
  if (!text) {
    ModelReadResult failed;
    failed.diagnostics = std::move(diagnostics);
    return failed;
  }
  ReadModelOptions own = options;
  if (!own.folder) own.folder = path.parent_path();
  return read_model_text(std::move(*text), path.string(), own);
}

}  // namespace ferrers
