#include "ferrers/formats/asmt_formulas.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace ferrers {
namespace {

AsmtVector numbers(const Eigen::Vector3d& v) {
  return {fmt::format("({})", v.x()), fmt::format("({})", v.y()), fmt::format("({})", v.z())};
}

}  // namespace

AsmtVector operator-(const AsmtVector& a, const AsmtVector& b) {
  AsmtVector difference;
  for (std::size_t i = 0; i < 3; ++i) difference[i] = fmt::format("({} - {})", a[i], b[i]);
  return difference;
}

std::string dot(const AsmtVector& a, const AsmtVector& b) {
  return fmt::format("({}*{} + {}*{} + {}*{})", a[0], b[0], a[1], b[1], a[2], b[2]);
}

AsmtVector AsmtFrameFormulas::point(int which) {
  constexpr std::array<std::string_view, 4> kEndings = {"", "x", "y", "z"};
  const auto index = static_cast<std::size_t>(which);
  const Eigen::Vector3d place = marker_.X_PM.p + (which == 0 ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                                                             : Eigen::Vector3d(marker_.X_PM.R.col(which - 1)));
  if (marker_.part < 0) return numbers(place);
  if (recorded_[index].empty()) {
    recorded_[index] = import_.names.add("joints", "point", name_ + std::string(kEndings[index]));
    RecordSpec record;
    record.name = NameRef(recorded_[index], at_);
    record.body = NameRef(import_.body(marker_), at_);
    record.place = asmt_number3(place, at_);
    record.at = at_;
    import_.spec.records.push_back(std::move(record));
  }
  return {recorded_[index] + ".x", recorded_[index] + ".y", recorded_[index] + ".z"};
}

AsmtVector AsmtFrameFormulas::origin() { return point(0); }

AsmtVector AsmtFrameFormulas::axis(int which) {
  if (marker_.part < 0) return numbers(marker_.X_PM.R.col(which));
  return point(which + 1) - point(0);
}

void add_asmt_constraint(AsmtImport& import, std::string_view name, const std::string& formula, SourceRange at) {
  Diagnostics own;
  const std::optional<Expression> parsed = Expression::parse(formula, at, own);
  if (!parsed) throw std::logic_error("a formula of the ASMT reader cannot be parsed: " + formula);
  ConstraintSpec constraint;
  constraint.name = NameRef(import.names.add("joints", "constraint", name), at);
  constraint.formula = parsed->simplified();
  constraint.at = at;
  import.spec.constraints.push_back(std::move(constraint));
}

}  // namespace ferrers
