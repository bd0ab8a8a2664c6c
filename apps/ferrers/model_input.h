#pragma once

#include <CLI/App.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/formats/formats.h"
#include "ferrers/kinematics/assembly.h"
#include "ferrers/redundancy/consistent_geometry.h"
#include "ferrers/redundancy/contradiction.h"

/// The part that every verb with a model shares: its options, reading, and telling what is wrong.

struct ModelOptions {
  std::string file;
  std::vector<std::string> parameters;  ///< name=value
  std::vector<std::string> edits;       ///< path=value
  std::string write_model;              ///< Empty: not asked for.
  ferrers::ImportOptions import;        ///< For files of other programs.
  /// Relative; absent: what numbers of the file's format are good to.
  std::optional<double> geometric_tolerance;
  bool json = false;
};

/// MODEL, -p, --set, --write-model, --base, --ignore, --closures, --geometric-tolerance, --json.
void add_model_options(CLI::App& verb, ModelOptions& options);

/// --base, --ignore, --closures.
void add_import_options(CLI::App& verb, ferrers::ImportOptions& options);

struct LoadedModel {
  std::shared_ptr<const ferrers::Model> model;  ///< Null: the model has errors, which were printed.
  ferrers::Diagnostics diagnostics;
  std::string source;
  ferrers::ModelFormat format = ferrers::ModelFormat::kNative;
  bool as_read = true;                         ///< The text of the file says all of the model.
  std::vector<ferrers::RenamedThing> renamed;  ///< Names of a foreign file that had to change.
  std::vector<ferrers::VisualShape> visuals;
  /// What was done about numbers that are good to a tolerance only; empty where it was 0 or the model has errors.
  std::optional<ferrers::ConsistentGeometry> geometry;
};

/// Reads the model, prints its diagnostics to stderr, makes its geometry consistent and tells so.
LoadedModel load_model(const ModelOptions& options);

/// The same without the last: the numbers as they are written.
LoadedModel load_model_as_written(const ModelOptions& options);

/// Replaces the model by one of consistent geometry where its numbers are good to a tolerance only.
void make_geometry_consistent(const ModelOptions& options, LoadedModel& loaded);

/// Prints diagnostics to stderr; `source` is the text of their file.
void print_diagnostics(const ferrers::Diagnostics& diagnostics, std::string_view source);
void print_new_diagnostic(const LoadedModel& loaded);  ///< The last one.

/// Adds and prints one more.
void report(LoadedModel& loaded, std::string_view code, ferrers::SourceRange at, std::string message,
            std::string hint = {});

/// The model's specification with the parameters that the command line sets.
ferrers::ModelSpec edited_spec(const ModelOptions& options, const LoadedModel& loaded);

/// The text of the model as it was read, changes included, in the native format.
std::string model_text(const ModelOptions& options, const LoadedModel& loaded);

/// Does `--write-model`. Returns what went wrong, or an empty text.
std::string write_model_if_asked(const ModelOptions& options, const LoadedModel& loaded);

/// Reports why a mechanism is not assembled: contradictory geometry with its misclosure and joints, else the gaps of
/// the joints that stay open.
void report_open(LoadedModel& loaded, const ferrers::AssemblyResult& assembly,
                 const ferrers::ContradictionReport& contradiction);
void report_open(LoadedModel& loaded, const ferrers::AssemblyResult& assembly);

/// Reports bodies whose mass was left out, with their places.
void report_masses(LoadedModel& loaded, const std::vector<std::string>& bodies);

/// Prints a fault of the command line or of a file to be written; returns its exit code.
int command_line_error(std::string_view message);
