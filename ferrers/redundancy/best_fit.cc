#include "ferrers/redundancy/best_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "ferrers/kinematics/constraint_blocks.h"

namespace ferrers {
namespace {

constexpr int kInnerIterations = 30, kOuterIterations = 40;
constexpr int kMostFreeDirections = 8;  ///< More are not searched: each costs two fits a step.
constexpr double kSearchStep = 1e-3;    ///< Of the characteristic length.

class Fit {
 public:
  Fit(const System& system, const Scaling& scaling, const ClusterRows& cluster, const Compliance& compliance)
      : system_(system),
        scaling_(scaling),
        cluster_(cluster),
        rows_(make_all_rows(system, scaling)),
        compliance_(compliance),
        pos_(make_position_kinematics(system)),
        constraints_(make_constraint_blocks(system)),
        local_row_(static_cast<std::size_t>(system.m), -1),
        local_column_(static_cast<std::size_t>(system.nv), -1) {
    for (std::size_t i = 0; i < cluster.rows.size(); ++i) local_row_[cluster.rows[i]] = static_cast<int>(i);
    for (std::size_t k = 0; k < cluster.columns.size(); ++k) local_column_[cluster.columns[k]] = static_cast<int>(k);
  }

  BestFit run(const State& start) {
    BestFit fit = settle(start);
    const int free = static_cast<int>(cluster_.columns.size()) - fit.decision.rank;
    if (free > 0 && free <= kMostFreeDirections && fit.residual > 0) search(fit);
    return fit;
  }

 private:
  // Everything at one pose: f, y, and the directions.
  void evaluate(BestFit& fit) {
    compute_positions(system_, fit.state.q, pos_);
    compute_constraint_blocks(system_, fit.state, pos_, constraints_);
    fit.phi = constraints_.phi(cluster_.rows);
    G_ = MatrixXd::Zero(static_cast<long>(cluster_.rows.size()), static_cast<long>(cluster_.columns.size()));
    for (const ConstraintBlock& block : constraints_.blocks) {
      for (long i = 0; i < block.G.rows(); ++i) {
        const int row = block.row + static_cast<int>(i);
        if (local_row_[row] < 0) continue;
        for (std::size_t k = 0; k < block.columns.size(); ++k) {
          const int column = block.columns[k];
          if (local_column_[column] < 0) continue;
          G_(local_row_[row], local_column_[column]) =
              block.G(i, static_cast<long>(k)) * scaling_.rows[row] * scaling_.columns[column];
        }
      }
    }
    const JointWrenches joints = compute_joint_frame_wrenches(system_, fit.state, pos_);
    const MatrixXd D = joint_loads(joints);
    const std::vector<ComponentMap> maps = compute_component_maps(system_, joints);
    const VectorXd row_scale = scaling_.rows(cluster_.rows);
    metric_.compute(metric(maps, D));
    scaled_phi_ = fit.phi.cwiseProduct(row_scale);
    scaled_stress_ = metric_.solve(scaled_phi_);
    fit.stress = row_scale.cwiseProduct(scaled_stress_);
    fit.joint_stress = D * scaled_stress_;
    fit.residual = std::sqrt(std::max(0.0, scaled_phi_.dot(scaled_stress_)));
    fit.gaps.clear();
    for (std::size_t j = 0; j < maps.size(); ++j) {
      const VectorXd load = maps[j] * fit.joint_stress.segment(rows_.first[j], rows_.count[j]);
      fit.gaps.push_back(compliance_.joints[j].cwiseProduct(load));
    }
  }

  // Loads of all joints' rows (SI) per scaled unit of the closure rows.
  MatrixXd joint_loads(const JointWrenches& joints) const {
    const int m = static_cast<int>(cluster_.rows.size());
    Loads loads = make_loads(system_, m);
    for (int i = 0; i < m; ++i) loads.lambda(cluster_.rows[i], i) = scaling_.rows[cluster_.rows[i]];
    return distribute_to_joints(system_, rows_, scaling_, pos_, joints, std::move(loads));
  }

  // A, scaled.
  MatrixXd metric(const std::vector<ComponentMap>& maps, const MatrixXd& D) const {
    MatrixXd A = MatrixXd::Zero(D.cols(), D.cols());
    for (std::size_t j = 0; j < maps.size(); ++j) {
      if (rows_.count[j] == 0) continue;
      const MatrixXd load = maps[j] * D.middleRows(rows_.first[j], rows_.count[j]);
      A.noalias() += load.transpose() * compliance_.joints[j].asDiagonal() * load;
    }
    for (std::size_t c = maps.size(); c < rows_.first.size(); ++c) {
      const int row = rows_.first[c];
      const Eigen::RowVectorXd load = D.row(row) / rows_.scale[row];
      A.noalias() += compliance_.couplings * load.transpose() * load;
    }
    return A;
  }

  void move(const VectorXd& x, State& state) const {
    VectorXd step = VectorXd::Zero(system_.nv);
    for (long k = 0; k < x.size(); ++k) step[cluster_.columns[k]] = x[k] * scaling_.columns[cluster_.columns[k]];
    displace(system_, step, state.q);
    PositionKinematics pos = make_position_kinematics(system_);
    compute_positions(system_, state.q, pos);
    accept_winding(system_, pos, state);
  }

  // Gauss-Newton in the directions that G resists, as they are at each pose. Ends with `free_` set.
  BestFit settle(const State& start) {
    BestFit fit;
    fit.state = start;
    evaluate(fit);
    for (int i = 0; i < kInnerIterations; ++i) {
      const double blur = scaled_phi_.norm() / scaling_.length_m;
      const RankAnalysis analysis = analyze_rank(G_, std::max(1.0, G_.norm()), blur);
      fit.decision = analysis.decision;
      free_ = analysis.right_null;
      const MatrixXd resisted = row_space(analysis);
      const VectorXd slope = resisted.transpose() * (G_.transpose() * scaled_stress_);
      const double size = scaled_stress_.norm();
      fit.slope = size > 0 ? slope.norm() / (std::max(1.0, G_.norm()) * size) : 0;
      if (resisted.cols() == 0 || fit.slope < 1e-12) break;
      const MatrixXd J = metric_.matrixL().solve(G_ * resisted);
      const VectorXd r = metric_.matrixL().solve(scaled_phi_);
      VectorXd x = -(resisted * J.householderQr().solve(r));
      x *= std::min(1.0, 0.3 * scaling_.length_m / std::max(x.norm(), 1e-300));
      BestFit next = fit;
      move(x, next.state);
      evaluate(next);
      for (int half = 0; half < 8 && next.residual > fit.residual; ++half) {
        x /= 2;
        next.state = fit.state;
        move(x, next.state);
        evaluate(next);
      }
      const bool better = next.residual < fit.residual;
      if (!better) {
        evaluate(fit);
        break;
      }
      const bool done = next.residual > (1 - 1e-12) * fit.residual;
      fit = next;
      if (done && i > 0) break;
    }
    return fit;
  }

  // Orthonormal basis of what G's rows span: the complement of the free directions.
  static MatrixXd row_space(const RankAnalysis& analysis) {
    const MatrixXd& N = analysis.right_null;
    const long n = N.rows(), r = n - N.cols();
    if (N.cols() == 0) return MatrixXd::Identity(n, n);
    const Eigen::HouseholderQR<MatrixXd> qr(N);
    return (qr.householderQ() * MatrixXd::Identity(n, n)).rightCols(r);
  }

  // Quasi-Newton (BFGS) along the free directions; the basis is kept, Gauss-Newton corrects for its turning.
  void search(BestFit& fit) {
    const MatrixXd basis = free_;
    const long d = basis.cols();
    const double h = kSearchStep * scaling_.length_m;
    const auto at = [&](const BestFit& from, const VectorXd& theta) {
      State state = from.state;
      move(basis * theta, state);
      return settle(state);
    };
    const auto slope_at = [&](const BestFit& from) {
      VectorXd g(d);
      for (long k = 0; k < d; ++k) {
        const VectorXd unit = h * VectorXd::Unit(d, k);
        g[k] = (square(at(from, unit).residual) - square(at(from, -unit).residual)) / (2 * h);
      }
      return g;
    };
    VectorXd g = slope_at(fit);
    MatrixXd H = MatrixXd::Identity(d, d) * (0.05 * square(scaling_.length_m) / std::max(square(fit.residual), 1e-300));
    for (int i = 0; i < kOuterIterations; ++i) {
      if (g.norm() * scaling_.length_m <= 1e-6 * square(fit.residual)) break;
      VectorXd step = -(H * g);
      if (step.dot(g) >= 0) step = -g;
      step *= std::min(1.0, 0.3 * scaling_.length_m / step.norm());
      BestFit next = at(fit, step);
      for (int half = 0; half < 12 && next.residual >= fit.residual; ++half) {
        step /= 3;
        next = at(fit, step);
      }
      if (!(next.residual < fit.residual)) break;
      const VectorXd next_g = slope_at(next);
      const VectorXd change = next_g - g;
      const double curvature = step.dot(change);
      if (curvature > 0) {
        const MatrixXd P = MatrixXd::Identity(d, d) - step * change.transpose() / curvature;
        H = P * H * P.transpose() + step * step.transpose() / curvature;
      }
      fit = next;
      g = next_g;
    }
    fit = settle(fit.state);
  }

  static double square(double x) { return x * x; }

  const System& system_;
  const Scaling& scaling_;
  const ClusterRows& cluster_;
  AllRows rows_;
  const Compliance& compliance_;
  PositionKinematics pos_;
  ConstraintBlocks constraints_;
  std::vector<int> local_row_, local_column_;  // −1: of another cluster, or held
  MatrixXd G_, free_;
  VectorXd scaled_phi_, scaled_stress_;
  Eigen::LLT<MatrixXd> metric_;
};

}  // namespace

Compliance equal_compliance(const System& system, double length_m) {
  return {make_joint_springs(system, DistributionBy::kEqualStiffness, length_m).compliance, 1.0};
}

Compliance model_compliance(const System& system, double length_m, bool& any) {
  Compliance out = equal_compliance(system, length_m);
  const JointSprings springs = make_joint_springs(system, DistributionBy::kJointStiffness, length_m);
  double largest = 0;
  for (std::size_t j = 0; j < out.joints.size(); ++j) {
    largest = std::max(largest, springs.compliance[j].cwiseQuotient(out.joints[j]).maxCoeff());
  }
  any = largest > 0;
  const double rigid = 1e-12 * (any ? largest : 1.0);
  for (std::size_t j = 0; j < out.joints.size(); ++j) {
    out.joints[j] = springs.compliance[j] + rigid * out.joints[j];
  }
  out.couplings = rigid;
  return out;
}

std::vector<ClusterRows> cluster_rows(const System& system, const std::vector<int>& held) {
  std::vector<ClusterRows> out;
  for (const Cluster& cluster : system.topology->clusters) {
    ClusterRows one;
    for (const int c : cluster.closures) {
      const Closure& closure = system.topology->closures[c];
      for (int i = 0; i < closure.row_count; ++i) one.rows.push_back(closure.row + i);
    }
    for (const int node : cluster.nodes) {
      for (int v = system.nodes[node].v; v < system.nodes[node].v + system.nodes[node].nv; ++v) {
        if (std::find(held.begin(), held.end(), v) == held.end()) one.columns.push_back(v);
      }
    }
    std::sort(one.columns.begin(), one.columns.end());
    out.push_back(std::move(one));
  }
  return out;
}

BestFit find_best_fit(const System& system, const Scaling& scaling, const ClusterRows& cluster,
                      const Compliance& compliance, const State& start) {
  return Fit(system, scaling, cluster, compliance).run(start);
}

}  // namespace ferrers
