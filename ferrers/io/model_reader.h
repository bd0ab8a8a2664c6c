#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ferrers/core/diagnostics.h"
#include "ferrers/model/model.h"
#include "ferrers/model/spec.h"

namespace ferrers {

struct ReadModelOptions {
  /// Parameter values (SI) that override the file's.
  std::map<std::string, double> parameters;
  /// The same as text, 'name=value' with or without a unit, as on a command line; these win.
  std::vector<std::string> parameter_texts;
  /// Changes of any field before the file is read, 'path=value': path as in `bodies.crank.mass` or
  /// `bodies.crank.com[0]`, value in YAML. The path must exist but for its last key, which may be a field that the file
  /// leaves out.
  std::vector<std::string> edits;
  bool keep_welds = false;  ///< Nothing is merged, whatever welds say.
  /// Folder of law files, for `read_model_text`; without one a law file is an error.
  std::optional<std::filesystem::path> folder;
};

struct ModelReadResult {
  std::optional<Model> model;  ///< Present when there is no error.
  ModelSpec spec;              ///< As far as it could be read.
  Diagnostics diagnostics;     ///< Errors, warnings and notices, sorted by place.
  std::string source;          ///< The text, for `format_diagnostic`.
};

/// Reads a model file, YAML or JSON. All errors of the file at once; nothing throws. Cost: linear in its size.
ModelReadResult read_model_file(const std::filesystem::path& path, const ReadModelOptions& options = {});

/// The same from a text; `name` is how messages call it.
ModelReadResult read_model_text(std::string text, std::string name, const ReadModelOptions& options = {});

}  // namespace ferrers
