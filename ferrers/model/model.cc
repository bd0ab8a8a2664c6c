#include "ferrers/model/model.h"

#include "ferrers/core/checks.h"
#include "ferrers/model/joints/joint_type.h"

namespace ferrers {

std::optional<BodyId> Model::find_body(std::string_view name) const {
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    if (bodies_[i].name == name) return BodyId(i);
    for (const Part& part : bodies_[i].parts) {
      if (part.name == name) return BodyId(i);
    }
  }
  return std::nullopt;
}

Part Model::part(std::string_view name) const {
  const std::optional<BodyId> id = find_body(name);
  require(id.has_value(), "part: the model has no such body");
  for (const Part& part : body(*id).parts) {
    if (part.name == name) return part;
  }
  return {std::string(name), {}, body(*id).X_WB};
}

std::size_t Model::spec_index(JointId id) const {
  const auto& all = spec_->joints;
  auto at = static_cast<std::size_t>(id.index());
  while (all.at(at).name.name != joint(id).name) ++at;  // merged welds before it
  return at;
}

std::optional<JointId> Model::find_joint(std::string_view name) const {
  for (std::size_t i = 0; i < joints_.size(); ++i) {
    if (joints_[i].name == name) return JointId(i);
  }
  return std::nullopt;
}

std::string Model::coordinate_name(JointCoordinate coordinate) const {
  const int count = static_cast<int>(joints_.size());
  require(coordinate.joint.valid() && coordinate.joint.index() < count,
          "coordinate_name: the joint is not of this model");
  const Joint& owner = joint(coordinate.joint);
  const auto names = joint_type_info(owner.type).coordinates;
  require(coordinate.index >= 0 && coordinate.index < static_cast<int>(names.size()),
          "coordinate_name: the joint has no such coordinate");
  if (names.size() == 1) return owner.name;
  return owner.name + "." + std::string(names[static_cast<std::size_t>(coordinate.index)].name);
}

namespace {

constexpr std::array<std::string_view, 3> kAxes = {".x", ".y", ".z"};

}  // namespace

std::string Model::scalar_name(const StateScalar& scalar) const {
  if (scalar.is_point()) return records_.at(scalar.point).name + std::string(kAxes.at(scalar.axis));
  const std::string name = coordinate_name(scalar.coordinate);
  const JointTypeInfo& type = joint_type_info(joint(scalar.coordinate.joint).type);
  return type.carries_body && type.nv == 1 ? name + ".position" : name;
}

std::string Model::rate_name(const StateScalar& scalar) const {
  return (scalar.is_point() ? scalar_name(scalar) : coordinate_name(scalar.coordinate)) + ".velocity";
}

}  // namespace ferrers
