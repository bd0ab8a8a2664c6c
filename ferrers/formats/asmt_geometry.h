#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "ferrers/formats/asmt_document.h"
#include "ferrers/math/rotation.h"
#include "ferrers/model/spec.h"

namespace ferrers {

/// Positions and rotations of an ASMT file, in SI. Remembers the worst rotation matrix for one notice about all.
class AsmtGeometry {
 public:
  AsmtGeometry(double per_metre, Diagnostics& diagnostics) : per_metre_(per_metre), diagnostics_(diagnostics) {}

  double per_metre() const { return per_metre_; }  ///< Units of length of the file in a metre.

  /// Three numbers under `owner`'s record `name`; nothing, with an error (F202, F206, F208), where they are not there.
  std::optional<Eigen::Vector3d> triple(const AsmtRecord& owner, std::string_view name) const;
  /// One number under `owner`'s record `name`, in the same way.
  std::optional<double> number(const AsmtRecord& owner, std::string_view name) const;
  /// `Position3D` and `RotationMatrix` of `owner`. A matrix is replaced by the rotation nearest to it; one that is
  /// farther than 1e-3 from it, in any entry, is refused (F206).
  std::optional<Pose> pose(const AsmtRecord& owner);

  /// Says (F603) how far matrices were from rotations, where that is beyond rounding.
  void tell_rounded() const;

 private:
  std::optional<std::vector<double>> numbers(const AsmtRecord& owner, std::string_view name, std::size_t count) const;

  std::optional<Eigen::Matrix3d> rotation(const AsmtRecord& owner);

  double per_metre_;
  Diagnostics& diagnostics_;
  int rounded_ = 0;  ///< Matrices farther than 1e-9 from a rotation.
  double worst_ = 0;
  SourceRange worst_at_;
};

/// As a specification holds it.
Number3 asmt_number3(const Eigen::Vector3d& vector, SourceRange at);

}  // namespace ferrers
