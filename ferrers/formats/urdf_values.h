#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "ferrers/formats/imported_model.h"
#include "ferrers/formats/xml_document.h"

/// Values as URDF writes them.
namespace ferrers {

/// An attribute that must be there; F202 where it is missing.
std::optional<std::string_view> required_attribute(const XmlElement& element, std::string_view name,
                                                   Diagnostics& diagnostics);

/// A child that must be there; F202 and an element that does not exist where it is missing.
XmlElement required_child(const XmlElement& element, std::string_view name, Diagnostics& diagnostics);

/// The number of an attribute, with its place; nothing where there is no such attribute, or an error (F206, F208).
std::optional<Number> attribute_number(const XmlElement& element, std::string_view name, Diagnostics& diagnostics);
/// The same, and F202 where it is missing.
std::optional<Number> required_number(const XmlElement& element, std::string_view name, Diagnostics& diagnostics);
/// Three numbers; `otherwise` where there is no such attribute.
Eigen::Vector3d attribute_vector(const XmlElement& element, std::string_view name, const Eigen::Vector3d& otherwise,
                                 Diagnostics& diagnostics);

/// `<origin xyz rpy>` of `element`: turned by roll, pitch, yaw about fixed axes. Identity where it is missing.
Pose read_origin(const XmlElement& element, Diagnostics& diagnostics);

/// `<axis xyz>` of `element` as a unit vector, else x; F206 where it has no direction.
Eigen::Vector3d read_axis(const XmlElement& element, Diagnostics& diagnostics);

/// A vector as a specification keeps it.
Number3 number3(const Eigen::Vector3d& vector, SourceRange at);

/// The same frame, turned so that its z axis is `axis` (a unit vector of the frame). Its x axis is a coordinate axis
/// where `axis` is one.
Pose along_axis(const Pose& frame, const Eigen::Vector3d& axis);

}  // namespace ferrers
