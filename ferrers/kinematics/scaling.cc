#include "ferrers/kinematics/scaling.h"

#include <algorithm>

namespace ferrers {
namespace {

double largest_distance(const std::vector<Vector3d>& points) {
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) largest = std::max(largest, (points[i] - points[j]).norm());
  }
  return largest;
}

}  // namespace

double characteristic_length(const Model& model) {
  std::vector<std::vector<Vector3d>> places(model.bodies().size());
  double magnitude = 0;
  for (const Joint& joint : model.joints()) {
    places[joint.first.index()].push_back(joint.X_1F.p);
    places[joint.second.index()].push_back(joint.X_2M.p);
    magnitude = std::max({magnitude, joint.X_1F.p.norm(), joint.X_2M.p.norm()});
  }
  std::vector<double> sizes;
  for (std::size_t b = 1; b < places.size(); ++b) {
    const double size = largest_distance(places[b]);
    if (size > 1e-9 * magnitude) sizes.push_back(size);
  }
  if (sizes.empty()) {  // one joint per body: take how far the joints, or the mass centres, are apart
    for (std::size_t b = 1; b < places.size(); ++b) {
      const Body& body = model.bodies()[b];
      if (body.has_mass && !places[b].empty()) sizes.push_back((body.com_m - places[b].front()).norm());
    }
  }
  std::sort(sizes.begin(), sizes.end());  // the sum must not depend on the order of the file
  double sum = 0;
  for (const double size : sizes) sum += size;
  return sum > 0 ? sum / static_cast<double>(sizes.size()) : 1.0;
}

Scaling make_scaling(const System& system) {
  Scaling s;
  s.length_m = characteristic_length(*system.model);
  s.rows = VectorXd::Ones(system.m);
  s.columns = VectorXd::Ones(system.nv);
  for (const CutJoint& cut : system.cuts) {
    for (int i = 0; i < cut.type->row_count(); ++i) {
      if (cut.type->row_components[i] >= 3) s.rows[cut.row + i] = s.length_m;
    }
  }
  const auto is_angular = [](CoordinateKind kind) {
    return kind == CoordinateKind::kAngle || kind == CoordinateKind::kRotationRate;
  };
  for (const Node& node : system.nodes) {
    for (int k = 0; k < node.nv; ++k) {
      if (is_angular(node.type->coordinates[k].kind)) s.columns[node.v + k] = 1 / s.length_m;
    }
  }
  for (std::size_t c = 0; c < system.couplings.size(); ++c) {
    // A coupling's row takes the unit of its coordinates: bring angles to lengths, and its largest coefficient to one.
    const Coupling& coupling = system.model->couplings()[c];
    double largest = 0;
    for (std::size_t i = 0; i < coupling.coordinates.size(); ++i) {
      const JointCoordinate ref = coupling.coordinates[i];
      const CoordinateInfo& info = joint_type_info(system.model->joint(ref.joint).type).coordinates[ref.index];
      largest = std::max(largest, std::abs(coupling.coefficients[i]) / (is_angular(info.kind) ? s.length_m : 1.0));
    }
    if (largest > 0) s.rows[system.couplings[c].row] = 1 / largest;
  }
  return s;
}

}  // namespace ferrers
