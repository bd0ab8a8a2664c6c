#include "ferrers/formats/sdf_base.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "ferrers/formats/body_groups.h"

namespace ferrers {
void add_sdf_bases(SdfTree& tree, const SdfBodies& bodies, const std::vector<SdfMadeJoint>& made,
                   const ImportOptions& options, NameMap& names, ModelSpec& spec) {
  BodyGroups groups;
  const std::string ground(kGround);
  for (const SdfMadeJoint& joint : made) {
    if (!joint.name.empty()) groups.join(joint.bodies[0], joint.bodies[1]);
  }
  const auto tie = [&](const std::string& body, const SdfElement& element, bool is_base) {
    if (body.empty() || groups.are_joined(body, ground)) return;
    const bool fixed = is_base && options.base == ImportBase::kFixed;
    groups.join(body, ground);
    JointSpec joint;
    joint.name = NameRef(names.add("joints", "joint", (fixed ? "base_" : "float_") + body), element.at());
    joint.type = fixed ? JointType::kWeld : JointType::kFree;
    joint.bodies = {NameRef(ground, element.at()), NameRef(body, element.at())};
    if (fixed) {
      const auto found = std::find_if(spec.bodies.begin(), spec.bodies.end(),
                                      [&](const BodySpec& one) { return one.name.name == body; });
      joint.frames = {*found->pose, PoseSpec()};
    } else {
      element.notice("F603", fmt::format("nothing ties '{}' to the world: it floats, with all that hangs on it", body));
    }
    spec.joints.push_back(std::move(joint));
  };
  for (const SdfModel& model : tree.models) {
    const bool outermost = tree.models[static_cast<std::size_t>(model.top)].frame == model.frame;
    if (outermost) tie(bodies.of(tree.frames.body_of(model.frame)), tree.frames[model.frame].element, true);
  }
  for (const SdfLink& link : tree.links) tie(bodies.of(link.frame), link.element, false);
}

}  // namespace ferrers
