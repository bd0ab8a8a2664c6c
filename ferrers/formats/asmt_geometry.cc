#include "ferrers/formats/asmt_geometry.h"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <string>
#include <vector>

#include "ferrers/formats/xml_document.h"

namespace ferrers {
namespace {

// How far a matrix may be from a rotation: not worth a word, and too far to be one.
constexpr double kRounding = 1e-9;
constexpr double kNoRotation = 1e-3;

}  // namespace

std::optional<std::vector<double>> AsmtGeometry::numbers(const AsmtRecord& owner, std::string_view name,
                                                         std::size_t count) const {
  const AsmtRecord record = owner.child(name);
  if (!record || record.empty()) {
    diagnostics_.error("F202", record ? record.at() : owner.at(), fmt::format("'{}' has no '{}'", owner.name(), name));
    return std::nullopt;
  }
  return read_numbers(record.value(diagnostics_), record.value_at(), fmt::format("'{}'", name), count, diagnostics_);
}

std::optional<Eigen::Vector3d> AsmtGeometry::triple(const AsmtRecord& owner, std::string_view name) const {
  const auto all = numbers(owner, name, 3);
  if (!all) return std::nullopt;
  return Eigen::Vector3d((*all)[0], (*all)[1], (*all)[2]);
}

std::optional<double> AsmtGeometry::number(const AsmtRecord& owner, std::string_view name) const {
  const auto all = numbers(owner, name, 1);
  return all ? std::optional(all->front()) : std::nullopt;
}

std::optional<Eigen::Matrix3d> AsmtGeometry::rotation(const AsmtRecord& owner) {
  const AsmtRecord record = owner.child("RotationMatrix");
  if (!record) {
    diagnostics_.error("F202", owner.at(), fmt::format("'{}' has no 'RotationMatrix'", owner.name()));
    return std::nullopt;
  }
  const std::vector<AsmtRecord> rows = record.values();
  if (rows.size() != 3) {
    diagnostics_.error("F208", record.at(), fmt::format("'RotationMatrix' has {} rows, not 3", rows.size()));
    return std::nullopt;
  }
  Eigen::Matrix3d written;
  for (int i = 0; i < 3; ++i) {
    const AsmtRecord& row = rows[static_cast<std::size_t>(i)];
    const auto numbers = read_numbers(row.name(), row.at(), "a row of 'RotationMatrix'", 3, diagnostics_);
    if (!numbers) return std::nullopt;
    written.row(i) << (*numbers)[0], (*numbers)[1], (*numbers)[2];
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(written, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  const double off = (nearest - written).cwiseAbs().maxCoeff();
  if (!(off <= kNoRotation) || nearest.determinant() < 0) {
    diagnostics_.error("F206", rows.front().at(),
                       nearest.determinant() < 0
                           ? std::string("'RotationMatrix' is a reflection, not a rotation")
                           : fmt::format("'RotationMatrix' is no rotation: it is off the nearest one by {:.2g}", off));
    return std::nullopt;
  }
  if (off > kRounding) {
    ++rounded_;
    if (off > worst_) worst_ = off, worst_at_ = rows.front().at();
  }
  return nearest;
}

std::optional<Pose> AsmtGeometry::pose(const AsmtRecord& owner) {
  const std::optional<Eigen::Vector3d> position = triple(owner, "Position3D");
  const std::optional<Eigen::Matrix3d> turned = rotation(owner);
  if (!position || !turned) return std::nullopt;
  return Pose(*turned, *position / per_metre_);
}

void AsmtGeometry::tell_rounded() const {
  if (rounded_ == 0) return;
  diagnostics_.notice("F603", worst_at_,
                      fmt::format("{} rotation matri{} off by up to {:.2g} from the nearest rotation, which is used",
                                  rounded_, rounded_ == 1 ? "x is" : "ces are", worst_));
}

Number3 asmt_number3(const Eigen::Vector3d& vector, SourceRange at) {
  Number3 numbers = number3(vector.x(), vector.y(), vector.z());
  for (Number& one : numbers) one.at = at;
  return numbers;
}

}  // namespace ferrers
