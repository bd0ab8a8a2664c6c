#include <fmt/format.h>

#include <cmath>

#include "ferrers/model/build_internal.h"

namespace ferrers {
namespace {

constexpr double kParallel = 1e-9;  // sine of the angle below which two directions drawn are the same line

}  // namespace

/// The unit vector along `n`; nothing, with a message, where it has no length.
std::optional<Vector3d> ModelAssembler::direction(const Number3& n, Field field) {
  const Vector3d v = vector(n, std::nullopt, field);
  if (!v.allFinite()) return std::nullopt;
  const double scale = v.cwiseAbs().maxCoeff();
  if (scale > 0) return (v / scale).normalized();
  diagnostics_.error("F318", place_of(n[0], field),
                     fmt::format("'{}' of '{}' has no direction: it is zero", field.key, field.owner.name));
  return std::nullopt;
}

/// Sorts the entries of a place that is given body by body. `needed`: which of the two
/// bodies must have an entry.
std::array<const Number3*, 2> ModelAssembler::on_bodies(const PlaceSpec& place, Field field, const BodyPair& pair,
                                                        std::array<bool, 2> needed) {
  std::array<const Number3*, 2> sorted = {nullptr, nullptr};
  for (const auto& [name, value] : place.on_body) {
    const int which = name.name == pair.names[0].name ? 0 : name.name == pair.names[1].name ? 1 : -1;
    if (which < 0) {
      diagnostics_.error("F320", place_or(name.at, field.owner),
                         fmt::format("'{}' of '{}' names '{}', which is not one of its bodies", field.key,
                                     field.owner.name, name.name),
                         fmt::format("its bodies are '{}' and '{}'", pair.names[0].name, pair.names[1].name));
    } else if (sorted[static_cast<std::size_t>(which)] != nullptr) {
      diagnostics_.error("F320", place_or(name.at, field.owner),
                         fmt::format("'{}' of '{}' names '{}' twice", field.key, field.owner.name, name.name));
    } else {
      sorted[static_cast<std::size_t>(which)] = &value;
    }
  }
  for (std::size_t i = 0; i < 2; ++i) {
    if (sorted[i] != nullptr || !needed[i]) continue;
    diagnostics_.error(
        "F320", place_or(place.at, field.owner),
        fmt::format("'{}' of '{}' does not say where it sits on '{}'", field.key, field.owner.name, pair.names[i].name),
        needed[0] && needed[1] ? "given body by body, both bodies must be named" : "");
  }
  return sorted;
}

std::optional<OnBoth> ModelAssembler::points_on_both(const PlaceSpec& place, Field field, const BodyPair& pair) {
  if (!place.given()) {
    diagnostics_.error("F317", field.owner.at, fmt::format("'{}' needs '{}'", field.owner.name, field.key));
    return std::nullopt;
  }
  if (place.drawn) {
    const Vector3d point = vector(*place.drawn, kLength, field);
    return point.allFinite() ? std::optional(OnBoth{point, point}) : std::nullopt;
  }
  const std::array<const Number3*, 2> given = on_bodies(place, field, pair, {true, true});
  if (given[0] == nullptr || given[1] == nullptr) return std::nullopt;
  OnBoth points;
  for (std::size_t i = 0; i < 2; ++i) points[i] = body(pair.bodies[i]).X_WB * vector(*given[i], kLength, field);
  return points[0].allFinite() && points[1].allFinite() ? std::optional(points) : std::nullopt;
}

std::optional<OnBoth> ModelAssembler::directions_on_both(const PlaceSpec& place, Field field, const BodyPair& pair) {
  if (place.given() && !place.drawn) on_bodies(place, field, pair, {true, true});  // for its messages
  const std::optional<Vector3d> first = direction_on(0, place, field, pair);
  if (!first) return std::nullopt;
  if (place.drawn) return OnBoth{*first, *first};
  const std::optional<Vector3d> second = direction_on(1, place, field, pair);
  return second ? std::optional(OnBoth{*first, *second}) : std::nullopt;
}

/// A direction that belongs to one body, in the world as drawn.
std::optional<Vector3d> ModelAssembler::direction_on(int which, const PlaceSpec& place, Field field,
                                                     const BodyPair& pair) {
  if (!place.given()) {
    diagnostics_.error("F317", field.owner.at, fmt::format("'{}' needs '{}'", field.owner.name, field.key));
    return std::nullopt;
  }
  if (place.drawn) return direction(*place.drawn, field);
  const std::size_t i = static_cast<std::size_t>(which);
  const NameRef& name = pair.names[i];
  for (const auto& [given, value] : place.on_body) {
    if (given.name != name.name) continue;
    const std::optional<Vector3d> own = direction(value, field);
    return own ? std::optional<Vector3d>(body(pair.bodies[i]).X_WB.R * *own) : std::nullopt;
  }
  return std::nullopt;
}

/// The joint's axes on the first body, in the world: z given, x by the key or by the rule.
std::optional<Matrix3d> ModelAssembler::frame_on_first(const Vector3d& z, const std::optional<Number3>& x,
                                                       const NameRef& owner) {
  if (!z.allFinite()) return std::nullopt;
  if (!x) return frame_from_z(z);
  const std::optional<Vector3d> along = direction(*x, {"x", owner});
  if (!along) return std::nullopt;
  if (along->cross(z).norm() > kParallel) return frame_from_zx(z, *along);
  diagnostics_.error("F319", place_of((*x)[0], {"x", owner}),
                     fmt::format("'x' of '{}' is parallel to its axis", owner.name),
                     "'x' turns the joint's frame about the axis, so it must point across it");
  return std::nullopt;
}

}  // namespace ferrers
