#include <fmt/format.h>

#include <cmath>

#include "ferrers/model/build_internal.h"
#include "ferrers/model/mass_properties.h"

namespace ferrers {

void ModelAssembler::build_bodies() {
  Body ground;
  ground.name = "ground";
  model_.bodies_.push_back(std::move(ground));
  has_mass_centre_.push_back(false);
  for (const BodySpec& spec : spec_->bodies) {
    Body body;
    body.name = spec.name.name;
    has_mass_centre_.push_back(false);
    build_body(spec, body);
    model_.bodies_.push_back(std::move(body));
  }
}

void ModelAssembler::build_body(const BodySpec& spec, Body& body) {
  if (spec.pose) body.X_WB = pose(*spec.pose, spec.name);
  place_mass_centre(spec, body);
  build_mass(spec, body);
}

/// The mass centre: as given, else the middle of a shape that has end points.
void ModelAssembler::place_mass_centre(const BodySpec& spec, Body& body) {
  const InertiaSpec& shape = spec.inertia;
  std::optional<Vector3d> middle;
  if (shape.from && shape.to) {
    middle = 0.5 * (vector(*shape.from, kLength, {"from", spec.name}) + vector(*shape.to, kLength, {"to", spec.name}));
  }
  if (spec.com) {
    body.com_m = vector(*spec.com, kLength, {"com", spec.name});
    const double length = middle ? 2.0 * (*middle - vector(*shape.from, kLength, {"from", spec.name})).norm() : 0.0;
    if (middle && (*middle - body.com_m).norm() > 1e-9 * std::max(length, body.com_m.norm())) {
      diagnostics_.warning("F333", place_of((*spec.com)[0], {"com", spec.name}),
                           fmt::format("'com' of '{}' is not the middle of its shape", spec.name.name),
                           "the shape gives the inertia about its own middle, which is then used about 'com'");
    }
  } else if (middle) {
    body.com_m = *middle;
  }
  has_mass_centre_.back() = spec.com || middle;
}

void ModelAssembler::build_mass(const BodySpec& spec, Body& body) {
  const bool has_inertia = spec.inertia.kind != InertiaSpec::Kind::kPoint;
  if (!spec.mass) {
    if (has_inertia) {
      diagnostics_.error("F313", place_or(spec.inertia.at, spec.name),
                         fmt::format("the body '{}' has an inertia but no mass", spec.name.name), "give it a 'mass'");
    }
    return;
  }
  body.has_mass = true;
  body.mass_kg = number_at_least_zero(*spec.mass, kMass, {"mass", spec.name});
  if (body.mass_kg > 0 && !has_mass_centre_.back()) {
    diagnostics_.error("F312", place_or(spec.mass->at, spec.name),
                       fmt::format("the body '{}' has a mass but no mass centre", spec.name.name), "give it a 'com'");
  }
  if (!has_inertia) return;
  body.inertia_kgm2 = shape_inertia(spec, body.mass_kg);
  if (spec.inertia.rotation) {
    body.inertia_kgm2 = rotate_inertia(body.inertia_kgm2, rotation(*spec.inertia.rotation, spec.name));
  }
  check_physical(spec, body);
}

Matrix3d ModelAssembler::shape_inertia(const BodySpec& spec, double mass_kg) {
  const InertiaSpec& shape = spec.inertia;
  switch (shape.kind) {
    case InertiaSpec::Kind::kPoint:
      break;
    case InertiaSpec::Kind::kTensor:
      return inertia_tensor(vector(shape.moments, kInertia, {"moments", spec.name}),
                            vector(shape.products, kInertia, {"products", spec.name}));
    case InertiaSpec::Kind::kRod:
    case InertiaSpec::Kind::kCylinder:
      return spanned_inertia(spec, mass_kg);
    case InertiaSpec::Kind::kBox: {
      Vector3d size;
      for (std::size_t i = 0; i < 3; ++i) {
        size[static_cast<int>(i)] = number_at_least_zero(shape.size[i], kLength, {"size", spec.name});
      }
      return box_inertia(mass_kg, size);
    }
    case InertiaSpec::Kind::kSphere:
      return sphere_inertia(mass_kg, number_at_least_zero(shape.radius, kLength, {"radius", spec.name}));
  }
  return Matrix3d::Zero();
}

/// Shapes with two end points: rod and cylinder.
Matrix3d ModelAssembler::spanned_inertia(const BodySpec& spec, double mass_kg) {
  const InertiaSpec& shape = spec.inertia;
  if (!shape.from || !shape.to) {
    diagnostics_.error("F317", place_or(shape.at, spec.name),
                       fmt::format("the shape of '{}' needs its end points 'from' and 'to'", spec.name.name));
    return Matrix3d::Zero();
  }
  const Vector3d span =
      vector(*shape.to, kLength, {"to", spec.name}) - vector(*shape.from, kLength, {"from", spec.name});
  if (span.norm() == 0) {
    diagnostics_.error("F321", place_of((*shape.to)[0], {"to", spec.name}),
                       fmt::format("the end points of the shape of '{}' coincide", spec.name.name));
    return Matrix3d::Zero();
  }
  if (shape.kind == InertiaSpec::Kind::kRod) return rod_inertia(mass_kg, span);
  return cylinder_inertia(mass_kg, span, number_at_least_zero(shape.radius, kLength, {"radius", spec.name}));
}

void ModelAssembler::check_physical(const BodySpec& spec, const Body& body) {
  const SourceRange at = place_or(spec.inertia.at, spec.name);
  const bool mass_is_wrong = body.mass_kg < 0;  // has its own message
  const InertiaVerdict verdict = mass_is_wrong ? InertiaVerdict::kPhysical : check_inertia(body.inertia_kgm2);
  if (verdict == InertiaVerdict::kNegative) {
    diagnostics_.error("F314", at, fmt::format("the inertia of '{}' has a negative principal moment", body.name),
                       "'products' are the tensor's off-diagonal entries, -integral of x y dm, about the mass centre");
  }
  if (verdict == InertiaVerdict::kTriangle && spec.inertia.unphysical) {
    diagnostics_.warning(
        "F314", at,
        fmt::format("in the inertia of '{}' one principal moment exceeds the sum of the others; it is taken as given",
                    body.name),
        "no body is like that: check where the numbers come from");
  } else if (verdict == InertiaVerdict::kTriangle) {
    diagnostics_.error(
        "F314", at, fmt::format("in the inertia of '{}' one principal moment exceeds the sum of the others", body.name),
        "no body is like that; give moments about the mass centre");
  }
  if (body.mass_kg == 0 && body.inertia_kgm2.norm() > 0) {
    diagnostics_.warning("F333", at, fmt::format("the body '{}' has an inertia but its mass is zero", body.name));
  }
}

Pose ModelAssembler::pose(const PoseSpec& spec, const NameRef& owner) {
  Pose X;
  X.p = vector(spec.position, kLength, {"position", owner});
  if (spec.rotation) X.R = rotation(*spec.rotation, owner);
  return X;
}

Matrix3d ModelAssembler::rotation(const RotationSpec& spec, const NameRef& owner) {
  const SourceRange at = place_or(spec.at, owner);
  if (spec.axis_angle && spec.quaternion) {
    diagnostics_.error("F327", at, fmt::format("the rotation of '{}' has both an axis and a quaternion", owner.name),
                       "give one of the two");
  } else if (spec.axis_angle) {
    const double angle = number(spec.axis_angle->second, kPureNumber, {"angle", owner});
    const std::optional<Vector3d> axis = direction(spec.axis_angle->first, {"axis", owner});
    if (axis) return Eigen::AngleAxisd(angle, *axis).toRotationMatrix();
  } else if (spec.quaternion) {
    Eigen::Vector4d wxyz;
    for (std::size_t i = 0; i < 4; ++i) {
      wxyz[static_cast<int>(i)] = number((*spec.quaternion)[i], kPureNumber, {"quaternion", owner});
    }
    constexpr double kRounding = 1e-3;  // what four digits may be off
    if (std::abs(wxyz.norm() - 1.0) > kRounding) {
      diagnostics_.error("F327", at,
                         fmt::format("the quaternion of '{}' has the length {}, not 1", owner.name, wxyz.norm()),
                         "a quaternion is [w, x, y, z], w being the cosine of half the angle");
    }
    wxyz.normalize();
    return quaternion_matrix(wxyz.data());
  }
  return Matrix3d::Identity();
}

void ModelAssembler::check_bodies_have_joints() {
  std::vector<bool> held(model_.bodies_.size(), false);
  const auto first = [&](int body) {
    return static_cast<std::size_t>(groups_.empty() ? body : groups_[static_cast<std::size_t>(body)].first);
  };
  held[0] = true;
  for (const JointSpec& spec : spec_->joints) {
    for (const NameRef& name : spec.bodies) {
      const auto found = body_index_.find(name.name);
      if (found != body_index_.end()) held[first(found->second)] = true;
    }
  }
  for (std::size_t i = 0; i < spec_->bodies.size(); ++i) {
    const NameRef& name = spec_->bodies[i].name;
    const bool named_before = body_index_.at(name.name) != static_cast<int>(i) + 1;  // has its own message
    if (held[first(static_cast<int>(i) + 1)] || named_before) continue;
    diagnostics_.error("F315", name.at, fmt::format("the body '{}' has no joint", name.name),
                       "a body that moves freely takes a joint of type 'free'");
  }
}

}  // namespace ferrers
