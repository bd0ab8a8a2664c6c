#include "ferrers/dynamics/modes.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "ferrers/dynamics/stability.h"
#include "ferrers/math/rank.h"

namespace ferrers {
namespace {

using Complex = std::complex<double>;

constexpr double kSame = 1e-7;  // relative difference of eigenvalues that are one
constexpr double kErrors = 20;  // error estimates within which a damping is none
constexpr double kNothing = 1e-12;

// Coordinates in which M is the unit matrix: s = L⁻ᵀ y.
struct MassCoordinates {
  explicit MassCoordinates(const MatrixXd& M) : llt(M) {}
  MatrixXd of(const MatrixXd& X) const {
    const MatrixXd left = llt.matrixL().solve(X);
    return llt.matrixL().solve(MatrixXd(left.transpose())).transpose();
  }
  Eigen::VectorXcd shape(const Eigen::VectorXcd& y) const {
    Eigen::VectorXcd s(y.size());
    s.real() = llt.matrixU().solve(VectorXd(y.real()));
    s.imag() = llt.matrixU().solve(VectorXd(y.imag()));
    return s;
  }
  Eigen::LLT<MatrixXd> llt;
};

ModeKind kind_of(const Complex& value) {
  if (value == 0.0) return ModeKind::kNeutral;
  if (value.imag() != 0) return ModeKind::kOscillation;
  return value.real() < 0 ? ModeKind::kDecay : ModeKind::kGrowth;
}

// One mode per eigenvalue, or per pair; `times`: how often a real one stands in the list.
void add_mode(const Complex& value, Eigen::VectorXcd shape, int times, ModalAnalysis& out) {
  Mode mode;
  mode.kind = kind_of(value);
  mode.eigenvalue = value;
  mode.shape = std::move(shape);
  out.modes.push_back(std::move(mode));
  for (int i = 0; i < times; ++i) out.eigenvalues.push_back(value);
  if (value.imag() != 0) out.eigenvalues.push_back(std::conj(value));
}

void sort_and_group(ModalAnalysis& out) {
  const auto before = [](const Complex& a, const Complex& b) {
    if (std::abs(std::abs(a) - std::abs(b)) > kSame * std::abs(b)) return std::abs(a) < std::abs(b);
    return std::pair(a.real(), a.imag()) < std::pair(b.real(), b.imag());
  };
  std::stable_sort(out.modes.begin(), out.modes.end(),
                   [&](const Mode& a, const Mode& b) { return std::abs(a.eigenvalue) < std::abs(b.eigenvalue); });
  std::stable_sort(out.eigenvalues.begin(), out.eigenvalues.end(), before);
  for (Mode& a : out.modes) {
    a.multiplicity = static_cast<int>(std::count_if(out.modes.begin(), out.modes.end(), [&](const Mode& b) {
      return std::abs(a.eigenvalue - b.eigenvalue) <= kSame * std::abs(a.eigenvalue);
    }));
  }
}

bool is_undamped(const EstimatedMatrix& C, const MatrixXd& M, const MatrixXd& K) {
  const double scale = std::sqrt(M.cwiseAbs().maxCoeff() * K.cwiseAbs().maxCoeff());
  return (C.value.cwiseAbs().array() <= kErrors * C.error.array() + kNothing * scale).all();
}

void solve_symmetric(const MassCoordinates& mass, const MatrixXd& K, int neutral, int unstable, ModalAnalysis& out) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(0.5 * (K + K.transpose()));
  for (int k = 0; k < K.rows(); ++k) {  // ascending: those that run away, neutral ones, vibrations
    const double squared = solver.eigenvalues()[k];
    const Eigen::VectorXcd shape = mass.shape(solver.eigenvectors().col(k).cast<Complex>());
    if (k >= unstable && k < unstable + neutral) {
      add_mode(0, shape, 2, out);
    } else if (k < unstable) {
      add_mode(std::sqrt(std::abs(squared)), shape, 1, out);
      add_mode(-std::sqrt(std::abs(squared)), shape, 1, out);
    } else {
      add_mode({0, std::sqrt(std::abs(squared))}, shape, 1, out);
    }
  }
}

MatrixXd state_matrix(const MatrixXd& K, const MatrixXd& C, double rate) {
  const long n = K.rows();
  MatrixXd A = MatrixXd::Zero(2 * n, 2 * n);
  A.topRightCorner(n, n).setIdentity();
  A.bottomLeftCorner(n, n) = -K / (rate * rate);
  A.bottomRightCorner(n, n) = -C / rate;
  return A;
}

// Adds the modes of a state matrix whose time is counted in 1/rate; `zeros` eigenvalues of least size are zero.
template <typename Shape>
void add_general(const MatrixXd& A, double rate, long zeros, ModalAnalysis& out, Shape shape) {
  const Eigen::EigenSolver<MatrixXd> solver(A);
  std::vector<long> order;
  for (long k = 0; k < A.rows(); ++k) order.push_back(k);
  const Eigen::VectorXcd& values = solver.eigenvalues();
  std::stable_sort(order.begin(), order.end(),
                   [&](long a, long b) { return std::abs(values[a]) < std::abs(values[b]); });
  for (long i = 0; i < A.rows(); ++i) {
    const long k = order[static_cast<std::size_t>(i)];
    if (values[k].imag() < 0) continue;  // the other of a pair
    const Complex value = i < zeros ? Complex(0) : rate * values[k];
    add_mode(value, shape(value, Eigen::VectorXcd(solver.eigenvectors().col(k).head(A.rows() / 2))), 1, out);
  }
}

}  // namespace

std::string_view to_string(ModeKind kind) {
  switch (kind) {
    case ModeKind::kOscillation:
      return "oscillation";
    case ModeKind::kDecay:
      return "decay";
    case ModeKind::kGrowth:
      return "growth";
    case ModeKind::kNeutral:
      break;
  }
  return "neutral";
}

double Mode::damping_ratio() const {
  const double size = std::abs(eigenvalue);
  return size > 0 ? 0.0 - eigenvalue.real() / size : 0;
}

ModalAnalysis analyze_modes_at_rest(const MatrixXd& M, const EstimatedMatrix& K, const EstimatedMatrix& C, int neutral,
                                    int unstable) {
  ModalAnalysis out;
  const long w = M.rows();
  out.undamped = w == 0 || (is_undamped(C, M, K.value) && is_symmetric(K));
  if (w == 0) return out;
  const MassCoordinates mass(M);
  const MatrixXd K_m = mass.of(K.value), C_m = mass.of(C.value);
  if (out.undamped) {
    solve_symmetric(mass, K_m, neutral, unstable, out);
    sort_and_group(out);
    return out;
  }
  const double rate = std::max(std::sqrt(K_m.norm()), C_m.norm());
  MatrixXd resistance(2 * w, w);
  resistance << K_m / (rate * rate), C_m / rate;
  const MatrixXd Y = analyze_rank(resistance, 1.0).right_null;  // free motions
  const long n = w - Y.cols();
  MatrixXd rest = MatrixXd::Identity(w, w);
  if (Y.cols() > 0) rest = (Y.householderQr().householderQ() * rest).eval().rightCols(n);
  for (long k = 0; k < Y.cols(); ++k) add_mode(0, mass.shape(Y.col(k).cast<Complex>()), 2, out);
  if (n > 0) {
    const MatrixXd K_n = rest.transpose() * K_m * rest, C_n = rest.transpose() * C_m * rest;
    const long zeros = n - decide_rank(compute_singular_values(K_n / (rate * rate)), 1.0).rank;
    const MatrixXd coupling_K = Y.transpose() * K_m * rest, coupling_C = Y.transpose() * C_m * rest;
    add_general(state_matrix(K_n, C_n, rate), rate, zeros, out, [&](const Complex& value, const Eigen::VectorXcd& b) {
      Eigen::VectorXcd y = rest * b;
      if (value != 0.0 && Y.cols() > 0) {  // free motions follow where they are pushed
        y -= Y * Eigen::VectorXcd((coupling_K * b + value * (coupling_C * b)) / (value * value));
      }
      return mass.shape(y);
    });
  }
  sort_and_group(out);
  return out;
}

ModalAnalysis analyze_modes(const MatrixXd& M, const MatrixXd& A) {
  ModalAnalysis out;
  const long w = M.rows();
  if (w == 0) return out;
  const MassCoordinates mass(M);
  const MatrixXd lower = mass.llt.matrixU(), upper = mass.llt.matrixU().solve(MatrixXd::Identity(w, w));
  MatrixXd A_m(2 * w, 2 * w);
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) A_m.block(i * w, k * w, w, w) = lower * A.block(i * w, k * w, w, w) * upper;
  }
  double rate = std::max({std::sqrt(A_m.bottomLeftCorner(w, w).norm()), A_m.bottomRightCorner(w, w).norm(),
                          A_m.topLeftCorner(w, w).norm()});
  if (!(rate > 0)) rate = 1;  // nothing pulls: all neutral
  A_m.bottomLeftCorner(w, w) /= rate * rate;
  A_m.bottomRightCorner(w, w) /= rate;
  A_m.topLeftCorner(w, w) /= rate;
  const VectorXd sizes = Eigen::EigenSolver<MatrixXd>(A_m, false).eigenvalues().cwiseAbs();
  long zeros = 0;
  for (const double size : sizes) zeros += is_negligible(size, sizes.maxCoeff()) ? 1 : 0;
  add_general(A_m, rate, zeros, out, [&](const Complex&, const Eigen::VectorXcd& y) { return mass.shape(y); });
  sort_and_group(out);
  return out;
}

}  // namespace ferrers
