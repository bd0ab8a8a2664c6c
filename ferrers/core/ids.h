#pragma once

#include <compare>
#include <cstddef>
#include <functional>

namespace ferrers {

/// Index of one kind of thing in a `Model`; ids of different kinds cannot be mixed.
///
/// An id is valid only for the model (or topology) that handed it out, and for every model that
/// `Model::with_parameters` makes of it. A default-constructed id is invalid.
template <class Tag>
class Id {
 public:
  constexpr Id() = default;
  constexpr explicit Id(int index) : index_(index) {}
  constexpr explicit Id(std::size_t index) : index_(static_cast<int>(index)) {}

  constexpr bool valid() const { return index_ >= 0; }
  constexpr int index() const { return index_; }
  constexpr auto operator<=>(const Id&) const = default;

 private:
  int index_ = -1;
};

using BodyId = Id<struct BodyTag>;          ///< A body; 0 is ground.
using JointId = Id<struct JointTag>;        ///< A joint, in the order of the file.
using CouplingId = Id<struct CouplingTag>;  ///< A coupling of joint coordinates.
using ForceId = Id<struct ForceTag>;        ///< A force element.
using DriveId = Id<struct DriveTag>;        ///< A drive.

inline constexpr BodyId kGround{0};

}  // namespace ferrers

template <class Tag>
struct std::hash<ferrers::Id<Tag>> {
  std::size_t operator()(ferrers::Id<Tag> id) const noexcept { return std::hash<int>{}(id.index()); }
};
