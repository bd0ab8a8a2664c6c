#include "ferrers/kinematics/scaling.h"

#include <algorithm>
#include <cmath>

#include "ferrers/kinematics/formula_rows.h"
#include "ferrers/kinematics/initial_values.h"

namespace ferrers {
namespace {

double largest_distance(const std::vector<Vector3d>& points) {
  double largest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (std::size_t j = i + 1; j < points.size(); ++j) largest = std::max(largest, (points[i] - points[j]).norm());
  }
  return largest;
}

bool is_angular(const Model& model, const StateScalar& scalar) {
  if (scalar.is_point()) return false;
  return joint_type_info(model.joint(scalar.coordinate.joint).type).coordinates[scalar.coordinate.index].is_angular();
}

// A system of generalized coordinates has no joints that are somewhere: its lengths are those of its parameters, else
// of its coordinates at the guess.
double length_of_formulas(const Model& model) {
  std::vector<double> sizes;
  const auto add = [&sizes](double value) {
    if (value != 0 && std::isfinite(value)) sizes.push_back(std::abs(value));
  };
  for (const Parameter& parameter : model.parameters()) {
    if (parameter.dimension == kLength) add(parameter.value);
  }
  if (sizes.empty()) {
    for (const InitialValue& value : model.initial()) {
      if (model.joint(value.coordinate.joint).type == JointType::kLengthCoordinate && !value.position.empty()) {
        add(value.position.front());
      }
    }
  }
  std::sort(sizes.begin(), sizes.end());
  double sum = 0;
  for (const double size : sizes) sum += size;
  return sum > 0 ? sum / static_cast<double>(sizes.size()) : 1.0;
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
  if (sizes.empty() && model.coordinates_begin() < model.joints().size()) return length_of_formulas(model);
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
  for (const Node& node : system.nodes) {
    for (int k = 0; k < node.nv; ++k) {
      if (node.type->coordinates[k].is_angular()) s.columns[node.v + k] = 1 / s.length_m;
    }
  }
  // A coupling's row takes the unit of its scalars: bring angles to lengths, and its largest coefficient to one. A
  // relation is taken at the guess.
  const State guess = make_guessed_state(system);
  PositionKinematics pos = make_position_kinematics(system);
  if (!system.formulas.empty()) compute_positions(system, guess.q, pos);
  const std::vector<std::vector<double>> coefficients = coupling_coefficients(system, guess, pos);
  for (std::size_t c = 0; c < system.couplings.size(); ++c) {
    double largest = 0;
    for (std::size_t i = 0; i < coefficients[c].size(); ++i) {
      const StateScalar& scalar = system.model->couplings()[c].scalars[i];
      largest =
          std::max(largest, std::abs(coefficients[c][i]) / (is_angular(*system.model, scalar) ? s.length_m : 1.0));
    }
    if (largest > 0 && std::isfinite(largest)) s.rows[system.couplings[c].row] = 1 / largest;
  }
  return s;
}

}  // namespace ferrers
