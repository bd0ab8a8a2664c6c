#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "ferrers/model/spec.h"

/// Short ways to write a `ModelSpec` in C++, for the zoo and for tests.
namespace ferrers::witness {

using Point = Eigen::Vector3d;

Number3 numbers(const Point& p);
Point values(const Number3& n);  ///< Literals only.

/// Thin straight rod (no inertia about itself) between two drawn points; mass centre in the middle.
BodySpec rod_body(const std::string& name, const Point& from, const Point& to, double mass_kg);

/// Round bar with inertia about every axis.
BodySpec bar_body(const std::string& name, const Point& from, const Point& to, double mass_kg, double radius_m);

/// Solid box with edges along the world axes.
BodySpec box_body(const std::string& name, const Point& centre, const Point& size_m, double mass_kg);

/// Any tensor about the mass centre, world axes as drawn.
BodySpec tensor_body(const std::string& name, const Point& centre, const Eigen::Matrix3d& inertia_kgm2, double mass_kg);

/// A drawn joint; `axis` is the axis or normal, left out for types without one.
JointSpec joint(JointType type, const std::string& name, const std::string& first, const std::string& second,
                const Point& at, const Point& axis = Point::UnitZ());
JointSpec universal_joint(const std::string& name, const std::string& first, const std::string& second, const Point& at,
                          const Point& first_axis, const Point& second_axis);
JointSpec distance_joint(const std::string& name, const std::string& first, const std::string& second,
                         const Point& on_first, const Point& on_second);
JointSpec mesh_joint(const std::string& name, const std::string& first, const std::string& second,
                     const Point& pitch_point, const Point& line_of_action, const Point& axis, const Point& centre_1,
                     const Point& centre_2);

LawSpec law(const std::string& expression);
DriveSpec coordinate_drive(const std::string& name, const std::string& on_joint, const std::string& motion,
                           const std::string& effort = {});
InitialSpec initial_velocity(const std::string& of_joint, double velocity);
RecordSpec record(const std::string& name, const std::string& body, const Point& at);

/// "rod" and 3 give "rod3".
std::string numbered(const std::string& stem, int number);

}  // namespace ferrers::witness
