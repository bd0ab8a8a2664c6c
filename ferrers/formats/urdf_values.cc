#include "ferrers/formats/urdf_values.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

namespace ferrers {
namespace {

std::string what(const XmlElement& element, std::string_view name) {
  return fmt::format("'{}' of <{}>", name, element.name());
}

}  // namespace

std::optional<std::string_view> required_attribute(const XmlElement& element, std::string_view name,
                                                   Diagnostics& diagnostics) {
  const std::optional<std::string_view> value = element.attribute(name);
  if (!value) diagnostics.error("F202", element.at(), fmt::format("<{}> needs '{}'", element.name(), name));
  return value;
}

XmlElement required_child(const XmlElement& element, std::string_view name, Diagnostics& diagnostics) {
  const XmlElement child = element.child(name);
  if (!child) diagnostics.error("F202", element.at(), fmt::format("<{}> needs <{}>", element.name(), name));
  return child;
}

std::optional<Number> attribute_number(const XmlElement& element, std::string_view name, Diagnostics& diagnostics) {
  const std::optional<std::string_view> text = element.attribute(name);
  if (!text) return std::nullopt;
  const SourceRange at = element.attribute_at(name);
  const auto numbers = read_numbers(*text, at, what(element, name), 1, diagnostics);
  if (!numbers) return std::nullopt;
  Number number((*numbers)[0]);
  number.at = at;
  return number;
}

std::optional<Number> required_number(const XmlElement& element, std::string_view name, Diagnostics& diagnostics) {
  if (!required_attribute(element, name, diagnostics)) return std::nullopt;
  return attribute_number(element, name, diagnostics);
}

Eigen::Vector3d attribute_vector(const XmlElement& element, std::string_view name, const Eigen::Vector3d& otherwise,
                                 Diagnostics& diagnostics) {
  const std::optional<std::string_view> text = element.attribute(name);
  if (!text) return otherwise;
  const auto numbers = read_numbers(*text, element.attribute_at(name), what(element, name), 3, diagnostics);
  return numbers ? Eigen::Vector3d((*numbers)[0], (*numbers)[1], (*numbers)[2]) : otherwise;
}

Pose read_origin(const XmlElement& element, Diagnostics& diagnostics) {
  Pose pose;
  const XmlElement origin = element.child("origin");
  if (!origin) return pose;
  pose.p = attribute_vector(origin, "xyz", Eigen::Vector3d::Zero(), diagnostics);
  const Eigen::Vector3d rpy = attribute_vector(origin, "rpy", Eigen::Vector3d::Zero(), diagnostics);
  using Eigen::AngleAxisd;
  pose.R = (AngleAxisd(rpy.z(), Eigen::Vector3d::UnitZ()) * AngleAxisd(rpy.y(), Eigen::Vector3d::UnitY()) *
            AngleAxisd(rpy.x(), Eigen::Vector3d::UnitX()))
               .toRotationMatrix();
  return pose;
}

Eigen::Vector3d read_axis(const XmlElement& element, Diagnostics& diagnostics) {
  const XmlElement axis = element.child("axis");
  if (!axis) return Eigen::Vector3d::UnitX();
  const Eigen::Vector3d direction = attribute_vector(axis, "xyz", Eigen::Vector3d::UnitX(), diagnostics);
  const double largest = direction.cwiseAbs().maxCoeff();
  if (largest > 0) return (direction / largest).normalized();
  diagnostics.error("F206", axis.attribute_at("xyz"), "'xyz' of <axis> has no direction: its length is zero");
  return Eigen::Vector3d::UnitX();
}

Number3 number3(const Eigen::Vector3d& vector, SourceRange at) {
  Number3 numbers = number3(vector.x(), vector.y(), vector.z());
  for (Number& one : numbers) one.at = at;
  return numbers;
}

Pose along_axis(const Pose& frame, const Eigen::Vector3d& axis) {
  if (axis == Eigen::Vector3d::UnitZ()) return frame;
  return {frame.R * frame_from_z(axis), frame.p};
}

}  // namespace ferrers
