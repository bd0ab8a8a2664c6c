#include "output_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>
#include <variant>

#include "ferrers/io/run_folder.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

namespace fs = std::filesystem;

/// A name that is one folder on any system.
std::string folder_name(std::string name) {
  for (char& c : name) {
    const bool plain =
        (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
    if (!plain && c != '.') c = '_';
  }
  return name.empty() || name[0] == '.' ? "_" + name : name;
}

bool has_text(const fs::path& file, const std::string& text) {
  std::ifstream in(file, std::ios::binary);
  return in && std::equal(std::istreambuf_iterator<char>(in), {}, text.begin(), text.end());
}

bool same_content(const fs::path& one, const fs::path& other) {
  std::ifstream a(one, std::ios::binary), b(other, std::ios::binary);
  using Bytes = std::istreambuf_iterator<char>;
  return a && b && std::equal(Bytes(a), {}, Bytes(b), {});
}

}  // namespace

OutputFolder::OutputFolder(const std::string& folder, const std::string& verb, std::string result,
                           const ModelOptions& options, const LoadedModel& loaded)
    : options_(options), loaded_(loaded), result_(std::move(result)) {
  path_ = folder.empty() ? fs::path("out") / folder_name(loaded.model->name() + "-" + verb) : fs::path(folder);
  const bool json = fs::path(options.file).extension() == ".json" && loaded.as_read;
  model_file_ = json ? "model.json" : "model.yaml";
  std::error_code ignored;
  holds_model_ = fs::equivalent(path_ / model_file_, options.file, ignored);
}

std::string OutputFolder::refusal() const {
  if (holds_model_ && !loaded_.as_read) {
    return fmt::format("the folder '{}' holds the model file itself; take another -o", path_.string());
  }
  std::error_code ignored;
  if (holds_model_ || !fs::exists(path_ / model_file_, ignored) || fs::exists(path_ / result_, ignored)) return "";
  return fmt::format("the folder '{}' holds a model, but no {}: nothing is replaced there; take another -o",
                     path_.string(), result_);
}

std::string OutputFolder::write_model() const {
  std::string error;
  if (!holds_model_) error = write_file_whole(path_ / model_file_, model_text(options_, loaded_));
  for (const std::string& name : law_files()) {
    if (error.empty()) error = copy_law_file(name);
  }
  return error;
}

std::string OutputFolder::find_other_model() const {
  if (!holds_model_ && !has_text(path_ / model_file_, model_text(options_, loaded_))) {
    return fmt::format("'{}' is another model", (path_ / model_file_).string());
  }
  for (const std::string& name : law_files()) {
    if (!same_content(fs::path(options_.file).parent_path() / name, path_ / name)) {
      return fmt::format("'{}' is another law file", (path_ / name).string());
    }
  }
  return "";
}

std::vector<std::string> OutputFolder::law_files() const {
  std::vector<std::string> names;
  const auto add = [&names](const LawSpec& law) {
    if (!law.file.empty()) names.push_back(law.file);
  };
  for (const DriveSpec& drive : loaded_.model->spec().drives) {
    std::for_each(drive.motion.begin(), drive.motion.end(), add);
    std::for_each(drive.effort.begin(), drive.effort.end(), add);
  }
  for (const auto& [coordinate, law] : loaded_.model->spec().motions) add(law);
  for (const ForceSpec& force : loaded_.model->spec().forces) {
    if (const auto* load = std::get_if<LoadSpec>(&force.element)) {
      std::for_each(load->components.begin(), load->components.end(), add);
    }
  }
  return names;
}

// The model names its law files relative to itself: they go along with it.
std::string OutputFolder::copy_law_file(const std::string& name) const {
  const fs::path from = fs::path(options_.file).parent_path() / name, to = path_ / name;
  std::error_code failed;
  if (fs::equivalent(from, to, failed)) return "";
  fs::create_directories(to.parent_path(), failed);
  failed.clear();
  fs::copy_file(from, to, fs::copy_options::overwrite_existing, failed);
  return failed ? fmt::format("'{}' cannot be copied to the results", name) : "";
}
