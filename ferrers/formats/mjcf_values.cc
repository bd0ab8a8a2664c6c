#include "ferrers/formats/mjcf_values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ferrers::mjcf {
namespace {

constexpr double kNoLength = 1e-14;  // as MuJoCo has it
constexpr std::string_view kForms[] = {"quat", "axisangle", "xyaxes", "zaxis", "euler"};

std::string described(std::string_view name, const Element& element) {
  return fmt::format("'{}' of <{}>", name, element.name());
}

/// A rotation, or nothing after a message.
std::optional<Matrix3d> rotation_by(std::string_view form, const Element& element, const Settings& settings) {
  const std::size_t wanted = form == "xyaxes" ? 6 : form == "zaxis" || form == "euler" ? 3 : 4;
  const auto numbers = read_numbers(*element.attribute(form), element.attribute_at(form), described(form, element),
                                    wanted, element.diagnostics());
  if (!numbers) return std::nullopt;
  const std::vector<double>& n = *numbers;
  const Eigen::Map<const Vector3d> first(n.data());
  bool usable = true;
  Matrix3d R = Matrix3d::Identity();
  if (form == "euler") {
    R = euler_rotation(settings.eulerseq, settings.angle_unit * first);
  } else if (form == "quat") {
    const Eigen::Vector4d q = Eigen::Map<const Eigen::Vector4d>(n.data()).stableNormalized();
    usable = q.norm() > 0.5;
    if (usable) R = quaternion_matrix(q.data());
  } else if (form == "axisangle") {
    usable = first.stableNorm() > kNoLength;
    if (usable) R = Eigen::AngleAxisd(n[3] * settings.angle_unit, first.stableNormalized()).toRotationMatrix();
  } else if (form == "zaxis") {
    usable = first.stableNorm() > kNoLength;
    if (usable) R = rotation_to(first);
  } else {
    const Vector3d x = first.stableNormalized();
    const Vector3d y = Eigen::Map<const Vector3d>(n.data() + 3).stableNormalized();
    const Vector3d across = y - x * x.dot(y);
    usable = x.norm() > 0.5 && across.norm() > kNoLength;
    if (usable) R.col(0) = x, R.col(1) = across.normalized(), R.col(2) = x.cross(across.normalized());
  }
  if (usable && R.allFinite()) return R;
  element.diagnostics().error("F318", element.attribute_at(form),
                              fmt::format("{} gives no direction", described(form, element)),
                              "its vectors must have a length and must not be parallel");
  return std::nullopt;
}

void read_compiler(const Attributes& compiler, Settings& settings) {
  constexpr std::string_view kAngles[] = {"degree", "radian"};
  constexpr std::string_view kInertia[] = {"false", "true", "auto"};
  constexpr std::string_view kCoordinates[] = {"local", "global"};
  if (compiler.has("angle") && compiler.choice("angle", kAngles, 0) == 1) settings.angle_unit = 1;
  if (compiler.has("angle") && compiler.choice("angle", kAngles, 0) == 0) settings.angle_unit = Settings().angle_unit;
  settings.autolimits = compiler.truth("autolimits", settings.autolimits);
  settings.inertia_from_geom = static_cast<Settings::InertiaFromGeom>(
      compiler.choice("inertiafromgeom", kInertia, static_cast<int>(settings.inertia_from_geom)));
  settings.bound_mass = compiler.number("boundmass", settings.bound_mass);
  settings.bound_inertia = compiler.number("boundinertia", settings.bound_inertia);
  settings.total_mass = compiler.number("settotalmass", settings.total_mass);
  settings.balance_inertia = compiler.truth("balanceinertia", settings.balance_inertia);
  for (const char* folder : {"assetdir", "meshdir"}) {
    if (const auto text = compiler.text(folder)) settings.mesh_folder = *text;
  }
  if (const auto groups = compiler.numbers("inertiagrouprange", 2, 2)) {
    settings.lowest_group = (*groups)[0];
    settings.highest_group = (*groups)[1];
  }
  if (compiler.choice("coordinate", kCoordinates, 0) == 1) {
    compiler.element().diagnostics().error("F602", compiler.element().attribute_at("coordinate"),
                                           "coordinates given in the world are not supported",
                                           "MuJoCo dropped them in version 2.3.4; it can convert such files before");
  }
  if (const auto sequence = compiler.text("eulerseq")) {
    if (sequence->size() == 3 && sequence->find_first_not_of("xyzXYZ") == std::string::npos) {
      settings.eulerseq = *sequence;
    } else {
      compiler.element().diagnostics().error(
          "F209", compiler.element().attribute_at("eulerseq"),
          fmt::format("'eulerseq' is '{}', not three of x, y, z, X, Y, Z", *sequence));
    }
  }
}

void read_flags(const Attributes& flags, Settings& settings) {
  constexpr std::string_view kStates[] = {"enable", "disable"};
  const auto disabled = [&](std::string_view name) { return flags.choice(name, kStates, 0) == 1; };
  if (disabled("gravity")) settings.gravity = Vector3d::Zero();
  if (disabled("limit")) settings.limits = false;
  const bool passive = disabled("passive");
  if (disabled("spring") || passive) settings.springs = false;
  if (disabled("damper") || passive) settings.damping = false;
  const bool all = disabled("constraint");
  if (!disabled("equality") && !all) return;
  settings.equality = false;
  flags.element().diagnostics().notice("F603", flags.element().at(),
                                       "the flags of <option> switch equality constraints off: none of them is read");
}

}  // namespace

Attributes::Attributes(Element own, std::vector<Element> defaults) : sources_(std::move(defaults)) {
  sources_.insert(sources_.begin(), own);
}

Element Attributes::source(std::string_view name) const {
  for (const Element& one : sources_) {
    if (one.attribute(name)) return one;
  }
  return {};
}

std::optional<std::string> Attributes::text(std::string_view name) const {
  const Element from = source(name);
  if (!from) return std::nullopt;
  return std::string(*from.attribute(name));
}

std::optional<std::vector<double>> Attributes::numbers(std::string_view name, std::size_t least,
                                                       std::size_t most) const {
  const Element from = source(name);
  if (!from) return std::nullopt;
  const SourceRange at = from.attribute_at(name);
  auto found = read_numbers(*from.attribute(name), at, described(name, from), 0, from.diagnostics());
  if (!found || (found->size() >= least && found->size() <= most)) return found;
  const std::string wanted = least == most ? fmt::format("{}", least) : fmt::format("{} to {}", least, most);
  from.diagnostics().error("F208", at,
                           fmt::format("{} has {} numbers, not {}", described(name, from), found->size(), wanted));
  return std::nullopt;
}

std::vector<double> Attributes::layered(std::string_view name, std::size_t most) const {
  std::vector<double> all;
  for (std::size_t i = sources_.size(); i-- > 0;) {
    const auto own = Attributes(sources_[i]).numbers(name, 1, most);
    if (!own) continue;
    all.resize(std::max(all.size(), own->size()));
    std::copy(own->begin(), own->end(), all.begin());
  }
  return all;
}

double Attributes::number(std::string_view name, double otherwise) const {
  const auto found = numbers(name, 1, 1);
  return found ? found->front() : otherwise;
}

Vector3d Attributes::vector(std::string_view name, const Vector3d& otherwise) const {
  const auto found = numbers(name, 3, 3);
  return found ? Vector3d(found->data()) : otherwise;
}

int Attributes::choice(std::string_view name, std::span<const std::string_view> choices, int otherwise) const {
  const Element from = source(name);
  if (!from) return otherwise;
  const std::string_view text = *from.attribute(name);
  const auto found = std::find(choices.begin(), choices.end(), text);
  if (found != choices.end()) return static_cast<int>(found - choices.begin());
  from.diagnostics().error("F209", from.attribute_at(name), fmt::format("{} is '{}'", described(name, from), text),
                           fmt::format("it can be {}", fmt::join(choices, ", ")));
  return otherwise;
}

bool Attributes::truth(std::string_view name, bool otherwise) const {
  constexpr std::string_view kTruths[] = {"false", "true"};
  return choice(name, kTruths, otherwise ? 1 : 0) == 1;
}

Settings read_settings(const Element& root) {
  Settings settings;
  for (const Element& one : root.children("compiler")) read_compiler(Attributes(one), settings);
  for (const Element& one : root.children("option")) {
    settings.gravity = Attributes(one).vector("gravity", settings.gravity);
  }
  for (const Element& one : root.children("option")) {
    for (const char* name : {"density", "viscosity"}) {
      if (Attributes(one).number(name, 0) == 0) continue;
      one.diagnostics().warning("F601", one.attribute_at(name), "forces of a fluid around the bodies are not read");
    }
    for (const Element& flags : one.children("flag")) read_flags(Attributes(flags), settings);
  }
  return settings;
}

Matrix3d rotation_to(const Vector3d& direction) {
  const Vector3d d = direction.stableNormalized();
  const Vector3d axis = Vector3d::UnitZ().cross(d);
  const double sine = axis.norm();
  const double angle = std::atan2(sine, d.z());
  if (sine < 1e-10) return Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix();
  return Eigen::AngleAxisd(angle, axis / sine).toRotationMatrix();
}

Matrix3d euler_rotation(const std::string& sequence, const Vector3d& angles_rad) {
  Matrix3d R = Matrix3d::Identity();
  for (std::size_t i = 0; i < 3; ++i) {
    const bool fixed_axis = sequence[i] < 'a';
    const int axis = fixed_axis ? sequence[i] - 'X' : sequence[i] - 'x';
    const Matrix3d turn = Eigen::AngleAxisd(angles_rad[static_cast<int>(i)], Vector3d::Unit(axis)).toRotationMatrix();
    R = fixed_axis ? Matrix3d(turn * R) : Matrix3d(R * turn);
  }
  return R;
}

Matrix3d read_rotation(const Attributes& attributes, const Settings& settings) {
  for (const Element& source : attributes.sources()) {
    std::vector<std::string_view> found;
    for (const std::string_view form : kForms) {
      if (source.attribute(form)) found.push_back(form);
    }
    if (found.size() > 1) {
      source.diagnostics().error(
          "F211", source.attribute_at(found[1]),
          fmt::format("<{}> says its orientation by '{}' and by '{}'", source.name(), found[0], found[1]),
          "keep one of them");
    }
    if (!found.empty()) return rotation_by(found[0], source, settings).value_or(Matrix3d::Identity());
  }
  return Matrix3d::Identity();
}

Pose read_pose(const Attributes& attributes, const Settings& settings) {
  return {read_rotation(attributes, settings), attributes.vector("pos", Vector3d::Zero())};
}

}  // namespace ferrers::mjcf
