#include "ferrers/redundancy/second_order.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

#include "ferrers/math/damped_step.h"
#include "ferrers/math/rank.h"

namespace ferrers {
namespace {

constexpr int kLargestSearched = 4;

VectorXd random_direction(int size, std::mt19937& random) {
  std::normal_distribution<double> normal;
  VectorXd z(size);
  for (double& entry : z) entry = normal(random);
  return z.normalized();
}

// Gauss-Newton onto the common zeros from z, staying on the unit sphere.
bool descend(const QuadraticForms& forms, VectorXd& z) {
  constexpr int kIterations = 80;
  double last = INFINITY;
  for (int i = 0; i < kIterations; ++i) {
    const VectorXd f = forms.evaluate(z);
    const double size = f.norm();
    if (size < 1e-16 || (size > 0.9 * last && is_negligible(size, 1.0))) break;
    last = size;
    VectorXd step = compute_damped_step(forms.gradient(z), f, 1e-14);
    if (step.norm() > 0.5) step *= 0.5 / step.norm();
    z = (z + step).normalized();
  }
  return is_negligible(forms.evaluate(z).norm(), 1.0);
}

bool is_definite(const MatrixXd& A, double& smallest, VectorXd& at) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(A);
  smallest = eigen.eigenvalues()[0];
  at = eigen.eigenvectors().col(0);
  return smallest > 0 && !is_negligible(smallest, 1.0);
}

// Is some combination of the forms positive definite? Then all values on the sphere lie on one side of the origin.
bool is_prestress_stable(const QuadraticForms& forms) {
  constexpr int kIterations = 300;
  VectorXd z = VectorXd::Unit(forms.size, 0);
  VectorXd p = forms.evaluate(z);
  double smallest = 0;
  for (int i = 0; i < kIterations && !is_negligible(p.norm(), 1.0); ++i) {
    if (is_definite(forms.combine(p.normalized()), smallest, z)) return true;
    const VectorXd towards = forms.evaluate(z) - p;
    const double square = towards.squaredNorm();
    if (square <= 0) break;
    p += std::min(1.0, std::max(0.0, -p.dot(towards) / square)) * towards;
  }
  return false;
}

// One part of a face of the cube: coordinate `face` is 1, the others within `radius` of `centre`.
struct Part {
  VectorXd centre;
  double radius;
};

// Somewhere in the part all forms might vanish, as far as a first-order bound tells.
bool may_vanish(const QuadraticForms& forms, const Part& part) {
  const VectorXd f = forms.evaluate(part.centre);
  if (f.norm() <= 0) return true;
  const MatrixXd A = forms.combine(f.normalized());
  const double change = 2 * (A * part.centre).lpNorm<1>() * part.radius +
                        A.norm() * part.radius * part.radius * static_cast<double>(forms.size - 1);
  const double bound = f.norm() - change;
  return bound < 0 || is_negligible(bound, 1.0);
}

// Covers the sphere (seen as a cube, opposite points being alike) with parts that hold no zero.
bool has_no_zero(const QuadraticForms& forms) {
  constexpr int kMostParts = 20000;
  const int w = forms.size;
  int looked = 0;
  for (int face = 0; face < w; ++face) {
    std::vector<Part> open = {{VectorXd::Unit(w, face), 1.0}};
    while (!open.empty()) {
      const Part part = open.back();
      open.pop_back();
      if (++looked > kMostParts) return false;
      if (!may_vanish(forms, part)) continue;
      for (int corner = 0; corner < 1 << (w - 1); ++corner) {
        Part child{part.centre, 0.5 * part.radius};
        for (int k = 0, bit = 0; k < w; ++k) {
          if (k != face) child.centre[k] += (corner >> bit++ & 1 ? 0.5 : -0.5) * part.radius;
        }
        open.push_back(std::move(child));
      }
    }
  }
  return true;
}

void add_if_new(const VectorXd& z, std::vector<VectorXd>& flexes) {
  for (const VectorXd& other : flexes) {
    if (std::abs(z.dot(other)) > 1 - 1e-6) return;
  }
  flexes.push_back(z);
}

// The subspace that the zeros span, and whether all of it are zeros.
void find_span(const QuadraticForms& forms, FlexCone& cone) {
  MatrixXd zeros(forms.size, static_cast<long>(cone.flexes.size()));
  for (std::size_t i = 0; i < cone.flexes.size(); ++i) zeros.col(static_cast<long>(i)) = cone.flexes[i];
  const Eigen::JacobiSVD<MatrixXd> svd(zeros, Eigen::ComputeFullU);
  const int dimension = decide_rank(svd.singularValues(), 1.0, kDoubleZeroBlur).rank;
  cone.span = svd.matrixU().leftCols(dimension);
  cone.is_linear = make_quadratic_forms(forms.on(cone.span), dimension, kDoubleZeroBlur).A.empty();
}

// A single semidefinite form vanishes on its null space and nowhere else.
bool solve_semidefinite(const QuadraticForms& forms, int starts, std::mt19937& random, FlexCone& cone) {
  if (forms.A.size() != 1) return false;
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(forms.A[0]);
  std::vector<int> order(forms.size);  // largest first, whatever the sign
  std::iota(order.begin(), order.end(), 0);
  const VectorXd size = eigen.eigenvalues().cwiseAbs();
  std::sort(order.begin(), order.end(), [&](int a, int b) { return size[a] > size[b]; });
  const RankDecision decision = decide_rank(size(order), 1.0);
  const VectorXd kept = eigen.eigenvalues()(order).head(decision.rank);
  if (kept.minCoeff() < 0 && kept.maxCoeff() > 0) return false;
  const int null = forms.size - decision.rank;
  cone.is_rigid = null == 0;
  cone.confident = cone.confident && decision.confident;
  cone.span = eigen.eigenvectors()(Eigen::all, order).rightCols(null);
  for (int i = 0; i < starts && null > 0; ++i) add_if_new(cone.span * random_direction(null, random), cone.flexes);
  return true;
}

}  // namespace

VectorXd QuadraticForms::evaluate(const VectorXd& z) const {
  VectorXd f(static_cast<long>(A.size()));
  for (long k = 0; k < f.size(); ++k) f[k] = z.dot(A[k] * z);
  return f;
}

MatrixXd QuadraticForms::gradient(const VectorXd& z) const {
  MatrixXd J(static_cast<long>(A.size()), size);
  for (long k = 0; k < J.rows(); ++k) J.row(k) = 2 * (A[k] * z).transpose();
  return J;
}

MatrixXd QuadraticForms::combine(const VectorXd& y) const {
  MatrixXd sum = MatrixXd::Zero(size, size);
  for (long k = 0; k < y.size(); ++k) sum += y[k] * A[k];
  return sum;
}

std::vector<MatrixXd> QuadraticForms::on(const MatrixXd& B) const {
  std::vector<MatrixXd> out;
  for (const MatrixXd& form : A) out.emplace_back(B.transpose() * form * B);
  return out;
}

QuadraticForms make_quadratic_forms(const std::vector<MatrixXd>& forms, int size, double blur) {
  QuadraticForms out;
  out.size = size;
  if (forms.empty() || size == 0) return out;
  MatrixXd vectors(size * size, static_cast<long>(forms.size()));
  for (std::size_t k = 0; k < forms.size(); ++k) vectors.col(static_cast<long>(k)) = forms[k].reshaped();
  const Eigen::JacobiSVD<MatrixXd> svd(vectors, Eigen::ComputeThinU);
  const double scale = std::max(1.0, svd.singularValues()[0]);
  RankDecision decision = decide_rank(svd.singularValues(), scale);
  if (!decision.confident && blur > 0) decision = decide_rank(svd.singularValues(), scale, blur);
  out.confident = decision.confident;
  for (int k = 0; k < decision.rank; ++k) out.A.emplace_back(svd.matrixU().col(k).reshaped(size, size));
  return out;
}

QuadraticForms compute_second_order_forms(PoseProbe& probe, const LocalMotion& motion, double blur) {
  const int w = motion.mobility(), s = motion.redundant();
  std::vector<MatrixXd> forms(s, MatrixXd::Zero(w, w));
  const auto along = [&](const VectorXd& x) -> VectorXd { return motion.Z.transpose() * probe.curvature(x); };
  for (int i = 0; i < w && s > 0; ++i) {
    const VectorXd square = along(motion.N.col(i));
    for (int k = 0; k < s; ++k) forms[k](i, i) = square[k];
  }
  for (int i = 0; i < w && s > 0; ++i) {
    for (int j = 0; j < i; ++j) {
      const VectorXd sum = along(motion.N.col(i) + motion.N.col(j));
      for (int k = 0; k < s; ++k) {
        forms[k](i, j) = forms[k](j, i) = 0.5 * (sum[k] - forms[k](i, i) - forms[k](j, j));
      }
    }
  }
  return make_quadratic_forms(forms, w, blur);
}

FlexCone find_second_order_flexes(const QuadraticForms& forms, int starts, unsigned seed) {
  FlexCone cone;
  cone.confident = forms.confident;
  std::mt19937 random(seed);
  if (forms.A.empty()) {
    cone.is_rigid = forms.size == 0;
    cone.span = MatrixXd::Identity(forms.size, forms.size);
    for (int i = 0; i < starts && forms.size > 0; ++i) add_if_new(random_direction(forms.size, random), cone.flexes);
    return cone;
  }
  if (solve_semidefinite(forms, starts, random, cone)) return cone;
  for (int i = 0; i < starts; ++i) {
    VectorXd z = random_direction(forms.size, random);
    if (descend(forms, z)) add_if_new(z, cone.flexes);
  }
  if (!cone.flexes.empty()) {
    find_span(forms, cone);
    return cone;
  }
  cone.span = MatrixXd::Zero(forms.size, 0);
  cone.is_rigid = is_prestress_stable(forms) || (forms.size <= kLargestSearched && has_no_zero(forms));
  return cone;
}

CommonKernel find_common_kernel(const QuadraticForms& forms) {
  if (forms.A.empty()) return {MatrixXd::Identity(forms.size, forms.size), forms.confident};
  MatrixXd stacked(static_cast<long>(forms.A.size()) * forms.size, forms.size);
  for (std::size_t k = 0; k < forms.A.size(); ++k) {
    stacked.middleRows(static_cast<long>(k) * forms.size, forms.size) = forms.A[k];
  }
  RankAnalysis analysis = analyze_rank(stacked, 1.0);
  if (!analysis.decision.confident) analysis = analyze_rank(stacked, 1.0, kDoubleZeroBlur);
  return {analysis.right_null, forms.confident && analysis.decision.confident};
}

}  // namespace ferrers
