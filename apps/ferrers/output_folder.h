#pragma once

#include <filesystem>
#include <string>

#include "model_input.h"

/// The folder of a verb's results, with the model file as it was run and the law files that it names.
class OutputFolder {
 public:
  /// `folder` empty: out/MODELNAME-VERB. `result`: the file by which a folder of this kind of results is known.
  OutputFolder(const std::string& folder, const std::string& verb, std::string result, const ModelOptions& options,
               const LoadedModel& loaded);

  const std::filesystem::path& path() const { return path_; }
  const std::string& model_file() const { return model_file_; }
  /// Why nothing may be written there, or an empty text: it is the model's own folder, or somebody else's, with files
  /// that would be replaced, but not by their like.
  std::string refusal() const;
  /// Whether the folder is that of the model file itself: then nothing tells later with which model its results were
  /// made.
  bool holds_model() const { return holds_model_; }
  /// Writes the model and the law files that it names. Returns what went wrong, or an empty text.
  std::string write_model() const;
  /// How the model files that stand there differ from what `write_model` would write, or an empty text.
  std::string find_other_model() const;

 private:
  std::vector<std::string> law_files() const;
  std::string copy_law_file(const std::string& name) const;

  const ModelOptions& options_;
  const LoadedModel& loaded_;
  std::filesystem::path path_;
  std::string result_, model_file_;
  bool holds_model_ = false;  ///< The model file itself lies there.
};
