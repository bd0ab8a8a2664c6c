#include <algorithm>

#include "ferrers/dynamics/forward_kkt.h"
#include "ferrers/kinematics/scaling.h"

namespace ferrers {
namespace {

// The order of elimination is chosen from the first equations solved.
class SparseSolver final : public ForwardSolver {
 public:
  SparseSolver(const System& system, const Selection& selection)
      : rows_(selection.rows),
        m_(system.m),
        column_scale_(system.scaling.columns),
        structure_(make_kkt_structure(system, selection.rows)) {}

  void solve(const Equations& eq, ForwardResult& out) override {
    if (!compiled_) compile(eq);
    out.status = kkt_.factor(eq.M, eq.constraints.G);
    if (out.status == ForwardStatus::kSolved) resolve(eq.force, eq.constraints.gamma, out);
    if (out.status == ForwardStatus::kSolved && !out.vdot.allFinite()) out.status = ForwardStatus::kWornSelection;
  }

  void resolve(const VectorXd& force, const VectorXd& gamma, ForwardResult& out) override {
    out.status = ForwardStatus::kSolved;
    kkt_.solve(force, gamma, out.vdot, out.lambda);
  }

  double smallest_pivot() const override { return kkt_.smallest_pivot(); }
  const SparseKkt* order() const override { return compiled_ && kkt_.is_complete() ? &kkt_ : nullptr; }

 private:
  void compile(const Equations& eq) {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i] >= m_) structure_.rows[i] = eq.driven_columns.at(rows_[i] - m_);
    }
    take_values(rows_, eq.constraints.G, structure_);
    kkt_ = SparseKkt(structure_, rows_, column_scale_);
    compiled_ = true;
  }

  std::vector<int> rows_;
  int m_;
  VectorXd column_scale_;
  KktStructure structure_;
  SparseKkt kkt_;
  bool compiled_ = false;
};

}  // namespace

std::unique_ptr<ForwardSolver> make_sparse_solver(const System& system, const Selection& selection) {
  return std::make_unique<SparseSolver>(system, selection);
}

}  // namespace ferrers
