#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers::mjcf {
namespace {

using Inertia = Settings::InertiaFromGeom;

/// The first geom of those that count whose mass is not known.
const Geom* unknown_among(const std::vector<Geom>& geoms) {
  const auto found = std::find_if(geoms.begin(), geoms.end(), is_unknown);
  return found == geoms.end() ? nullptr : &*found;
}

std::vector<Geom> geoms_that_weigh(const TreeBody& body, const Settings& settings) {
  std::vector<Geom> geoms;
  for (const Geom& geom : body.geoms) {
    if (geom.group >= settings.lowest_group && geom.group <= settings.highest_group) geoms.push_back(geom);
  }
  return geoms;
}

/// Nothing, after a message, where a moving body's mass depends on a mesh.
std::optional<MassProperties> mass_of_body(const TreeBody& body, const Settings& settings) {
  MassProperties mass;
  if (body.inertial && settings.inertia_from_geom != Inertia::kAlways) {
    mass = *body.inertial;
  } else if (settings.inertia_from_geom != Inertia::kNever) {
    const std::vector<Geom> geoms = geoms_that_weigh(body, settings);
    if (const Geom* unknown = unknown_among(geoms)) {
      if (body.moves) {
        body.element.diagnostics().warning(
            "F603", unknown->element.at(),
            fmt::format("the mass of the body '{}' is not known: it depends on the mesh '{}', and meshes are not "
                        "loaded",
                        body.name, unknown->mesh),
            "give the body an <inertial>; MuJoCo writes it with saveinertial=\"true\"; 'analyze' works without");
        return std::nullopt;
      }
      body.element.diagnostics().notice(
          "F603", unknown->element.at(),
          fmt::format("the mass of the body '{}' depends on a mesh and is taken as zero: the body does not move",
                      body.name));
      return mass;
    }
    mass = mass_of(geoms);
  }
  apply_bounds(settings, mass);
  return mass;
}

/// Where <compiler settotalmass> asks for it: by which factor all masses become that total.
double mass_factor(const Import& import) {
  if (import.settings.total_mass <= 0) return 1;
  double total = 0;
  for (const TreeBody& body : import.tree.bodies) {
    if (!body.mass) {
      import.root.diagnostics().error("F602", import.root.at(),
                                      "'settotalmass' cannot be followed where a mass is not known");
      return 1;
    }
    total += body.mass->mass;
  }
  return total > 0 ? import.settings.total_mass / total : 1;
}

void fill_mass(const MassProperties& mass, SourceRange at, BodySpec& spec) {
  spec.mass = Number(mass.mass);
  spec.mass->at = at;
  spec.com = vector_spec(mass.com);
  const Matrix3d& I = mass.inertia;
  if (I.isZero(0)) return;
  spec.inertia.kind = InertiaSpec::Kind::kTensor;
  spec.inertia.at = at;
  spec.inertia.moments = number3(I(0, 0), I(1, 1), I(2, 2));
  spec.inertia.products = number3(I(0, 1), I(0, 2), I(1, 2));
}

void name_bodies(Import& import) {
  for (const TreeBody& body : import.tree.bodies) import.names.keep("bodies", body.original);
  for (std::size_t i = 1; i < import.tree.bodies.size(); ++i) {
    TreeBody& body = import.tree.bodies[i];
    if (body.original.empty()) body.original = fmt::format("{}_body", import.body(body.parent).original);
    body.name = import.names.add("bodies", "body", body.original);
  }
}

void name_joints(Import& import) {
  for (const TreeBody& body : import.tree.bodies) {
    for (const TreeJoint& joint : body.joints) import.names.keep("joints", joint.original);
  }
  for (TreeBody& body : import.tree.bodies) {
    for (TreeJoint& joint : body.joints) {
      if (joint.original.empty()) joint.original = body.original + "_joint";
      joint.name = import.names.add("joints", "joint", joint.original);
    }
  }
}

JointType type_of(const TreeJoint& joint) {
  if (joint.replaced) return JointType::kWeld;
  switch (joint.kind) {
    case JointKind::kHinge:
      return JointType::kRevolute;
    case JointKind::kSlide:
      return JointType::kPrismatic;
    case JointKind::kBall:
      return JointType::kSpherical;
    case JointKind::kFree:
      break;
  }
  return JointType::kFree;
}

/// The joint's frame in the frame of the body that it moves.
Pose frame_of(const TreeJoint& joint) {
  return {joint.scalar() ? frame_from_z(joint.axis) : Matrix3d(Matrix3d::Identity()), joint.pos};
}

/// The same on the body before it, whose frame sees the moved body at `X` as drawn, where the coordinate is `ref`: so
/// that coordinates are MuJoCo's. A free joint has those of the world.
Pose frame_before(const TreeJoint& joint, const Pose& X) {
  if (joint.kind == JointKind::kFree && !joint.replaced) return Pose();
  Pose back;
  if (joint.kind == JointKind::kSlide) back.p = {0, 0, -joint.ref};
  if (joint.kind == JointKind::kHinge) back.R = Eigen::AngleAxisd(-joint.ref, Vector3d::UnitZ()).toRotationMatrix();
  return X * frame_of(joint) * back;
}

/// The joints of a body one after the other; `before` is the body's frame in its parent, then in the massless bodies.
void add_chain(Import& import, TreeBody& body) {
  std::string before = import.body(body.parent).name;
  Pose X = body.X_PB;
  for (std::size_t i = 0; i < body.joints.size(); ++i) {
    TreeJoint& joint = body.joints[i];
    std::string after = body.name;
    if (i + 1 < body.joints.size()) {
      after = import.names.add("bodies", "body", fmt::format("{}_after_{}", body.name, joint.name));
      BodySpec between;
      between.name = {after, joint.element.main_at()};
      between.mass = Number(0);
      between.pose = pose_spec(body.X_WB, joint.element.main_at());
      import.spec().bodies.push_back(std::move(between));
    }
    JointSpec spec;
    spec.name = {joint.name, joint.element.main_at()};
    spec.type = type_of(joint);
    spec.bodies = {NameRef(before, joint.element.main_at()), NameRef(after, joint.element.main_at())};
    const SourceRange at = joint.element.main_at();
    spec.frames = {pose_spec(frame_before(joint, X), at), pose_spec(frame_of(joint), at)};
    if (joint.range) spec.limits = {Number((*joint.range)[0]), Number((*joint.range)[1])};
    import.spec().joints.push_back(std::move(spec));
    joint.bodies = {before, after};
    before = after;
    X = Pose();
  }
}

void add_weld(Import& import, const TreeBody& body) {
  const SourceRange at = body.element.main_at();
  JointSpec spec;
  spec.name = {import.names.add("joints", "joint", body.original + "_weld"), at};
  spec.type = JointType::kWeld;
  spec.bodies = {NameRef(import.body(body.parent).name, at), NameRef(body.name, at)};
  spec.frames = {pose_spec(body.X_PB, at), pose_spec(Pose(), at)};
  mark_fixed(spec);
  import.spec().joints.push_back(std::move(spec));
}

}  // namespace

Number3 vector_spec(const Vector3d& v) { return number3(v.x(), v.y(), v.z()); }

Expression position_of(const TreeJoint& joint) { return Expression::variable(joint.name + ".position"); }

void apply_base(Import& import) {
  for (TreeBody& body : import.tree.bodies) {
    if (body.parent != 0 || body.mocap) continue;
    if (import.options.base == ImportBase::kFixed) {
      for (TreeJoint& joint : body.joints) {
        joint.replaced = joint.kind == JointKind::kFree;
        if (joint.replaced) body.moves = false;
      }
    }
    if (import.options.base == ImportBase::kFree && body.joints.empty()) {
      TreeJoint joint;
      joint.kind = JointKind::kFree;
      joint.added = true;
      joint.element = body.element;
      body.joints.push_back(joint);
    }
  }
  for (TreeBody& body : import.tree.bodies) {
    const bool joined =
        std::any_of(body.joints.begin(), body.joints.end(), [](const TreeJoint& j) { return !j.replaced; });
    body.moves = joined || (body.parent >= 0 && import.body(body.parent).moves);
  }
}

void add_bodies(Import& import) {
  name_bodies(import);
  name_joints(import);
  for (TreeBody& body : import.tree.bodies) {
    body.mass = body.parent < 0 ? MassProperties() : mass_of_body(body, import.settings);
  }
  const double factor = mass_factor(import);
  for (TreeBody& body : import.tree.bodies) {
    if (body.parent < 0) continue;
    BodySpec spec;
    spec.name = {body.name, body.element.main_at()};
    spec.pose = pose_spec(body.X_WB, body.element.main_at());
    if (body.mass) {
      body.mass->mass *= factor;
      body.mass->inertia *= factor;
      fill_mass(*body.mass, body.element.main_at(), spec);
    }
    import.spec().bodies.push_back(std::move(spec));
  }
}

void add_joints(Import& import) {
  for (std::size_t i = 1; i < import.tree.bodies.size(); ++i) {
    TreeBody& body = import.tree.bodies[i];
    if (body.mocap) {
      body.element.diagnostics().notice("F603", body.element.at(),
                                        fmt::format("the mocap body '{}' stays where it is drawn", body.name));
    }
    if (body.joints.empty()) {
      add_weld(import, body);
    } else {
      add_chain(import, body);
    }
  }
}

}  // namespace ferrers::mjcf
