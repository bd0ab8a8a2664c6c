#include "ferrers/math/extrapolated_difference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace ferrers {
namespace {

constexpr int kMostRefusals = 8;  // halvings of a first step at which f does not exist
constexpr int kFewestLevels = 4, kMostLevels = 12;
constexpr int kPatience = 2;    // levels without improvement
constexpr double kGood = 1e-9;  // relative error with which nobody looks further
constexpr int kMostAttempts = 4;
constexpr double kNextAttempt = 1.0 / 128;  // its first step over that of the one before

class Extrapolation {
 public:
  Extrapolation(const CurveFunction& f, long size) : f_(f), plus_(size), minus_(size), size_(size) {
    constexpr double kUnknown = std::numeric_limits<double>::infinity();
    out_.value = Eigen::VectorXd::Zero(size);
    out_.error = Eigen::VectorXd::Constant(size, kUnknown);
    rounding_ = Eigen::VectorXd::Zero(size);
  }

  void run(double h) {
    for (int refusals = 0; !add_level(h); h /= 2) {
      if (++refusals > kMostRefusals) return;
    }
    double before = std::numeric_limits<double>::infinity();
    for (int level = 1, idle = 0; level < kMostLevels; ++level) {
      h /= 2;
      if (!add_level(h)) return;
      out_.valid = true;
      const double error = out_.error.sum();
      idle = error < 0.5 * before ? 0 : idle + 1;
      before = std::min(before, error);
      if (level >= kFewestLevels && idle >= kPatience) return;
    }
  }

  /// Largest error beside the largest entry; infinite where nothing is known.
  double relative_error() const {
    if (!out_.valid) return std::numeric_limits<double>::infinity();
    const double size = size_ > 0 ? out_.value.cwiseAbs().maxCoeff() : 0;
    return size > 0 ? out_.error.maxCoeff() / size : 0;
  }
  bool is_good() const {
    return out_.valid && (relative_error() <= kGood || (out_.error.array() <= 8 * rounding_.array()).all());
  }
  const DifferenceResult& result() const { return out_; }

 private:
  bool add_level(double h) {
    if (!f_(h, plus_) || !f_(-h, minus_)) return false;
    row_.assign(1, (plus_ - minus_) / (2 * h));
    const double unit = std::numeric_limits<double>::epsilon() / h;
    const Eigen::VectorXd rounding = unit * plus_.cwiseAbs().cwiseMax(minus_.cwiseAbs());
    double power = 1;
    for (std::size_t j = 1; j <= above_.size(); ++j) {
      power *= 4;
      row_.push_back((power * row_[j - 1] - above_[j - 1]) / (power - 1));
      const Eigen::VectorXd contradiction =
          (row_[j] - row_[j - 1]).cwiseAbs().cwiseMax((row_[j] - above_[j - 1]).cwiseAbs());
      take_best(row_[j], contradiction + rounding, rounding);
    }
    above_ = row_;
    return true;
  }

  void take_best(const Eigen::VectorXd& value, const Eigen::VectorXd& error, const Eigen::VectorXd& rounding) {
    for (long k = 0; k < size_; ++k) {
      if (!(error[k] < out_.error[k])) continue;
      out_.value[k] = value[k];
      out_.error[k] = error[k];
      rounding_[k] = rounding[k];
    }
  }

  const CurveFunction& f_;
  Eigen::VectorXd plus_, minus_, rounding_;
  long size_;
  std::vector<Eigen::VectorXd> row_, above_;
  DifferenceResult out_;
};

}  // namespace

DifferenceResult compute_extrapolated_difference(const CurveFunction& f, long size, double step) {
  DifferenceResult best;
  double error = std::numeric_limits<double>::infinity();
  for (int attempt = 0; attempt < kMostAttempts; ++attempt, step *= kNextAttempt) {
    Extrapolation table(f, size);
    table.run(step);
    if (attempt == 0 || table.relative_error() < error) {
      best = table.result();
      error = table.relative_error();
    }
    if (table.is_good() || !table.result().valid) break;
  }
  return best;
}

}  // namespace ferrers
