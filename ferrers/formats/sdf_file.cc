#include "ferrers/formats/sdf_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>
#include <set>

#include "ferrers/formats/sdf_versions.h"

namespace ferrers {
namespace {

// More would be a file that multiplies itself.
constexpr std::size_t kMostFiles = 1000;
constexpr std::string_view kModelScheme = "model://";
constexpr std::string_view kFileScheme = "file://";

// Elements and attributes that say nothing about mechanics: drawing, sound, names for the user.
constexpr std::array<std::string_view, 20> kQuiet = {"material",
                                                     "cast_shadows",
                                                     "transparency",
                                                     "laser_retro",
                                                     "visibility_flags",
                                                     "visual@name",
                                                     "meta",
                                                     "self_collide",
                                                     "allow_auto_disable",
                                                     "enable_wind",
                                                     "scene",
                                                     "gui",
                                                     "audio",
                                                     "world@name",
                                                     "submesh",
                                                     "provide_feedback",
                                                     "sdf@xmlns:xacro",
                                                     "model@xmlns:xacro",
                                                     "sdf@xmlns:drake",
                                                     "model@xmlns:drake"};

std::string_view without(std::string_view text, std::string_view prefix) { return text.substr(prefix.size()); }

bool ends_with_sdf(std::string_view path) {
  return path.ends_with(".sdf") || path.ends_with(".world") || path.ends_with(".xml");
}

std::string folder_of(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? std::string() : std::string(path.substr(0, slash + 1));
}

Eigen::Matrix3d turned_by(const Eigen::Vector3d& roll_pitch_yaw) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return (AngleAxisd(roll_pitch_yaw.z(), Vector3d::UnitZ()) * AngleAxisd(roll_pitch_yaw.y(), Vector3d::UnitY()) *
          AngleAxisd(roll_pitch_yaw.x(), Vector3d::UnitX()))
      .toRotationMatrix();
}

}  // namespace

// ---- a file --------------------------------------------------------------------------------------------------------

bool SdfFile::read_version() {
  const SdfElement root(*this, document_->root());
  const std::string written = root.attribute("version");
  if (root.name() != "sdf") {
    root.error("F605", fmt::format("the root element is <{}>, not <sdf>", root.name()));
    return false;
  }
  if (written.empty()) {
    root.error("F202", "<sdf> has no 'version'", "write version=\"1.7\" or the like");
    return false;
  }
  const std::optional<int> minor = sdf_minor_version(written);
  if (!minor || *minor < kOldestSdf || *minor > kNewestSdf) {
    root.attribute_error("version", "F210", fmt::format("version '{}' of SDF is not read", written),
                         fmt::format("read are 1.{} to 1.{}", kOldestSdf, kNewestSdf));
    return false;
  }
  version_ = *minor;
  return true;
}

void SdfFile::tell(Diagnostic one) const {
  if (includer_) one.message = fmt::format("in '{}', line {}: {}", path_, one.at.line, one.message);
  const SourceRange at = place(one.at);
  switch (one.severity) {
    case Severity::kError:
      return diagnostics_->error(one.code, at, std::move(one.message), std::move(one.hint));
    case Severity::kWarning:
      return diagnostics_->warning(one.code, at, std::move(one.message), std::move(one.hint));
    case Severity::kNotice:
      return diagnostics_->notice(one.code, at, std::move(one.message), std::move(one.hint));
  }
}

// ---- an element ----------------------------------------------------------------------------------------------------

std::vector<SdfElement> SdfElement::children(std::string_view name) const {
  std::vector<SdfElement> found;
  for (const XmlElement& one : xml_.children(name)) found.emplace_back(*file_, one);
  return found;
}

std::string SdfElement::attribute(std::string_view name) const {
  return std::string(xml_.attribute(name).value_or(std::string_view()));
}

std::optional<NameRef> SdfElement::required_name() const {
  const std::string name = attribute("name");
  if (!name.empty()) return NameRef{name, attribute_at("name")};
  error("F202", fmt::format("a <{}> has no 'name'", xml_.name()));
  return std::nullopt;
}

std::optional<std::vector<double>> SdfElement::numbers(std::size_t wanted) const {
  Diagnostics own;
  std::optional<std::vector<double>> read =
      read_numbers(xml_.text(), xml_.text_at(), fmt::format("<{}>", xml_.name()), wanted, own);
  for (const Diagnostic& one : own.items()) file_->tell(one);
  return read;
}

Number SdfElement::number(std::string_view child_name, double fallback) const {
  const SdfElement found = child(child_name);
  if (!found) return fallback;
  const std::optional<std::vector<double>> read = found.numbers(1);
  Number number(read ? read->front() : fallback);
  number.at = found.text_at();
  return number;
}

std::optional<Eigen::Vector3d> SdfElement::vector(std::string_view child_name) const {
  const SdfElement found = child(child_name);
  if (!found) return std::nullopt;
  const std::optional<std::vector<double>> read = found.numbers(3);
  if (!read) return std::nullopt;
  return Eigen::Vector3d(read->data());
}

std::optional<bool> SdfElement::truth(std::string_view word, SourceRange own) const {
  if (word == "true" || word == "True" || word == "TRUE" || word == "1") return true;
  if (word == "false" || word == "False" || word == "FALSE" || word == "0") return false;
  file_->tell(
      {Severity::kError, "F203", own, fmt::format("'{}' is neither 'true' nor 'false'", word.substr(0, 40)), ""});
  return std::nullopt;
}

bool SdfElement::flag(std::string_view child_name, bool fallback) const {
  const SdfElement found = child(child_name);
  if (!found) return fallback;
  return found.truth(found.xml_.text(), found.xml_.text_at()).value_or(fallback);
}

bool SdfElement::flag_attribute(std::string_view name, bool fallback) const {
  const std::optional<std::string_view> word = xml_.attribute(name);
  if (!word) return fallback;
  return truth(*word, xml_.attribute_at(name)).value_or(fallback);
}

Pose SdfElement::pose() const {
  const std::string format = attribute("rotation_format");
  const bool degrees = flag_attribute("degrees", false);
  if (!format.empty() && format != "euler_rpy" && format != "quat_xyzw") {
    attribute_error("rotation_format", "F209", fmt::format("'{}' is no known way to write a rotation", format),
                    "known are 'euler_rpy' and 'quat_xyzw'");
    return {};
  }
  if (xml_.text().empty()) return {};
  const bool quaternion = format == "quat_xyzw";
  const std::optional<std::vector<double>> read = numbers(quaternion ? 7 : 6);
  if (!read) return {};
  const Eigen::Vector3d position(read->data());
  if (!quaternion) {
    const double unit = degrees ? std::numbers::pi / 180 : 1;
    return {turned_by(unit * Eigen::Vector3d(read->data() + 3)), position};
  }
  if (degrees) attribute_error("degrees", "F211", "a quaternion has no degrees");
  Eigen::Quaterniond turn((*read)[6], (*read)[3], (*read)[4], (*read)[5]);
  const double length = turn.norm();
  if (!(length > 0) || !std::isfinite(length)) {
    text_error("F327", "the quaternion has no length");
    return {};
  }
  if (std::abs(length - 1) > 1e-3) {  // not a rank decision: what a file rounds to few digits is no mistake
    file_->tell({Severity::kWarning, "F327", xml_.text_at(),
                 fmt::format("the quaternion has the length {:.4g}; it is taken as a unit one", length), ""});
  }
  turn.coeffs() /= length;
  return {turn.toRotationMatrix(), position};
}

void SdfElement::error(std::string_view code, std::string message, std::string hint) const {
  file_->tell({Severity::kError, std::string(code), xml_.at(), std::move(message), std::move(hint)});
}

void SdfElement::warning(std::string_view code, std::string message, std::string hint) const {
  file_->tell({Severity::kWarning, std::string(code), xml_.at(), std::move(message), std::move(hint)});
}

void SdfElement::notice(std::string_view code, std::string message, std::string hint) const {
  file_->tell({Severity::kNotice, std::string(code), xml_.at(), std::move(message), std::move(hint)});
}

void SdfElement::text_error(std::string_view code, std::string message, std::string hint) const {
  file_->tell({Severity::kError, std::string(code), xml_.text_at(), std::move(message), std::move(hint)});
}

void SdfElement::attribute_error(std::string_view attribute, std::string_view code, std::string message,
                                 std::string hint) const {
  file_->tell({Severity::kError, std::string(code), xml_.attribute_at(attribute), std::move(message), std::move(hint)});
}

// ---- all files -----------------------------------------------------------------------------------------------------

const SdfFile* SdfLibrary::open_main(std::string_view text) {
  main_ = XmlDocument::parse(text, context_.diagnostics);
  if (!main_) return nullptr;
  files_.push_back(std::make_unique<SdfFile>(*main_, "", nullptr, SourceRange(), context_.diagnostics));
  return files_.back()->read_version() ? files_.back().get() : nullptr;
}

SdfLibrary::Loaded& SdfLibrary::loaded(const std::string& path) {
  const auto [place, is_new] = loaded_.try_emplace(path);
  if (is_new) place->second.text = context_.load(path);
  return place->second;
}

/// A folder's model.config names its file: the newest one that is read.
std::string SdfLibrary::file_of_folder(const std::string& folder) {
  std::string best;
  Diagnostics ignored;
  Loaded& config = loaded(folder + "/model.config");
  const std::unique_ptr<const XmlDocument> document = config.text ? XmlDocument::parse(*config.text, ignored) : nullptr;
  int best_version = -1;
  for (const XmlElement& one : document ? document->root().children("sdf") : std::vector<XmlElement>()) {
    const int version = sdf_minor_version(one.attribute("version").value_or("")).value_or(0);
    if (version <= best_version || version > kNewestSdf) continue;
    best_version = version;
    best = folder + "/" + std::string(one.text());
  }
  return best.empty() ? folder + "/model.sdf" : best;
}

const SdfFile* SdfLibrary::open_included(const SdfElement& include, const SdfElement& uri) {
  const std::string written = uri.text();
  std::string path = written;
  if (path.starts_with(kModelScheme)) {
    path = without(path, kModelScheme);
  } else if (path.starts_with(kFileScheme)) {
    path = folder_of(uri.file().path()) + std::string(without(path, kFileScheme));
  } else if (path.find("://") != std::string::npos) {
    uri.text_error("F606", fmt::format("'{}' is not read: only files beside the model are", written));
    return nullptr;
  } else {
    path = folder_of(uri.file().path()) + path;
  }
  while (path.ends_with('/')) path.pop_back();
  if (!ends_with_sdf(path)) path = file_of_folder(path);
  return open(path, include, uri);
}

const SdfFile* SdfLibrary::open(const std::string& path, const SdfElement& include, const SdfElement& uri) {
  for (const SdfFile* one = &include.file(); one; one = one->includer()) {
    if (one->path() != path) continue;
    uri.text_error("F605", fmt::format("'{}' includes itself", path));
    return nullptr;
  }
  if (files_.size() > kMostFiles) {
    uri.text_error("F605", fmt::format("more than {} files are included", kMostFiles));
    return nullptr;
  }
  Loaded& further = loaded(path);
  if (!further.text) {
    uri.text_error("F606", fmt::format("'{}' cannot be read: there is no '{}' beside the model", uri.text(), path),
                   "files are looked for in the folder of the model and below");
    return nullptr;
  }
  Diagnostics own;
  if (!further.document) further.document = XmlDocument::parse(*further.text, own);
  if (!further.document) {
    for (const Diagnostic& one : own.items()) {
      uri.text_error(one.code, fmt::format("in '{}', line {}: {}", path, one.at.line, one.message), one.hint);
    }
    return nullptr;
  }
  files_.push_back(
      std::make_unique<SdfFile>(*further.document, path, &include.file(), include.at(), context_.diagnostics));
  return files_.back()->read_version() ? files_.back().get() : nullptr;
}

void SdfLibrary::report_unread() const {
  std::set<const XmlDocument*> told;
  for (const std::unique_ptr<SdfFile>& file : files_) {
    if (!told.insert(&file->document()).second) continue;
    Diagnostics own;
    file->document().report_unread(own, kQuiet);
    for (const Diagnostic& one : own.items()) file->tell(one);
  }
}

}  // namespace ferrers
