#include "ferrers/simulate/stepper.h"

#include <algorithm>
#include <cmath>

namespace ferrers {

bool Stepper::interpolate(Evaluator& /*evaluator*/, const State& /*from*/, const State& /*to*/, double /*t*/,
                          State& /*state*/, VectorXd& /*vdot*/) {
  return false;
}

const std::vector<double>& Stepper::gaps() const {
  static const std::vector<double> middle = {0.5};
  return middle;
}

ErrorScale::ErrorScale(const System& system, const Scaling& scaling)
    : q_(VectorXd::Ones(system.nq)), v_(VectorXd::Ones(system.nv)) {
  for (int k = 0; k < system.nv; ++k) v_[k] = 1 / (scaling.columns[k] * scaling.length_m);
  for (const Node& node : system.nodes) {
    const bool quaternion = node.type != nullptr && node.type->quaternion_at >= 0;
    if (node.nq == node.nv) {
      q_.segment(node.q, node.nq) = v_.segment(node.v, node.nv);
    } else if (quaternion) {  // positions before the quaternion, where there are any, are lengths
      q_.segment(node.q, node.type->quaternion_at).setConstant(1 / scaling.length_m);
    }
  }
}

void ErrorScale::see(const VectorXd& v, const VectorXd& vdot) {
  const double rate = v.cwiseProduct(v_).lpNorm<Eigen::Infinity>();
  const double curvature = vdot.cwiseProduct(v_).lpNorm<Eigen::Infinity>();
  fastest_ = std::max({fastest_, rate, std::sqrt(curvature)});
}

double ErrorScale::size(const VectorXd& q_error, const VectorXd& v_error) const {
  const double q = q_error.size() > 0 ? q_error.cwiseProduct(q_).lpNorm<Eigen::Infinity>() : 0;
  const double v = v_error.size() > 0 ? v_error.cwiseProduct(v_).lpNorm<Eigen::Infinity>() : 0;
  return std::max(q, fastest_ > 0 ? v / fastest_ : 0.0);
}

double ErrorScale::size_of_velocities(const VectorXd& dq, const VectorXd& v_error) const {
  const double q = dq.size() > 0 ? dq.cwiseProduct(v_).lpNorm<Eigen::Infinity>() : 0;
  return std::max(q, size(VectorXd(), v_error));
}

}  // namespace ferrers
