#include <fmt/format.h>

#include <algorithm>

#include "ferrers/formats/mjcf_tree.h"

namespace ferrers::mjcf {
namespace {

constexpr std::string_view kKinds[] = {"hinge", "slide", "ball", "free"};
constexpr std::string_view kLimited[] = {"false", "true", "auto"};

Polynomial read_polynomial(const Attributes& attributes, std::string_view name) {
  Polynomial polynomial = {0, 0, 0};
  const std::vector<double> numbers = attributes.layered(name, polynomial.size());
  std::copy(numbers.begin(), numbers.end(), polynomial.begin());
  return polynomial;
}

void read_range(const Attributes& attributes, const Settings& settings, double unit, TreeJoint& joint) {
  const auto range = attributes.numbers("range", 2, 2);
  const int limited = attributes.choice("limited", kLimited, 2);
  if (!range || !settings.limits || limited == 0 || joint.kind == JointKind::kFree) return;
  const Element from = attributes.source("range");
  if (limited == 2 && !settings.autolimits) {
    from.diagnostics().error("F605", from.attribute_at("range"),
                             "a joint has a 'range' but does not say whether it is 'limited'",
                             "with autolimits=\"false\" write limited=\"true\" or limited=\"false\"");
    return;
  }
  if (joint.kind == JointKind::kBall) {
    from.diagnostics().notice("F601", from.attribute_at("range"), "limits of ball joints are not read");
    return;
  }
  if (limited == 2 && (*range)[0] == 0 && (*range)[1] == 0) return;  // as if it was not there
  if ((*range)[0] >= (*range)[1]) {
    from.diagnostics().error(
        "F326", from.attribute_at("range"),
        fmt::format("the upper limit of a joint is not above the lower one: {} {}", (*range)[0], (*range)[1]));
    return;
  }
  joint.range = {(*range)[0] * unit, (*range)[1] * unit};
}

void tell_what_is_left_out(const Attributes& attributes) {
  const auto notice = [&](std::string_view name, std::string_view what) {
    const Element from = attributes.source(name);
    if (!from) return;
    const auto numbers = attributes.numbers(name, 1, 2);
    const bool used = numbers && std::any_of(numbers->begin(), numbers->end(), [](double x) { return x != 0; });
    if (used) from.diagnostics().notice("F601", from.attribute_at(name), fmt::format("{} is not read", what));
  };
  notice("frictionloss", "the dry friction of joints ('frictionloss')");
  notice("springyield", "the yield of joint springs ('springyield')");
}

void read_springdamper(const Attributes& attributes, const Settings& settings, TreeJoint& joint) {
  const auto numbers = attributes.numbers("springdamper", 2, 2);
  if (!numbers || (*numbers)[0] <= 0 || (*numbers)[1] <= 0) return;
  if (settings.springs && settings.damping) joint.springdamper = {(*numbers)[0], (*numbers)[1]};
  if (settings.springs == settings.damping) return;
  const Element from = attributes.source("springdamper");
  from.diagnostics().error("F602", from.attribute_at("springdamper"),
                           "'springdamper' is not supported where springs or dampers are switched off");
}

}  // namespace

TreeJoint read_joint(const Element& element, const Attributes& attributes, const Settings& settings) {
  TreeJoint joint;
  joint.element = element;
  joint.original = element.text_of("name");
  if (element.name() == "freejoint") {
    joint.kind = JointKind::kFree;
    return joint;
  }
  joint.kind = static_cast<JointKind>(attributes.choice("type", kKinds, 0));
  const double unit = joint.kind == JointKind::kSlide ? 1 : settings.angle_unit;
  joint.pos = attributes.vector("pos", Vector3d::Zero());
  if (joint.kind == JointKind::kFree) joint.pos.setZero();
  const Vector3d axis = attributes.vector("axis", Vector3d::UnitZ());
  if (joint.scalar() && axis.stableNorm() <= 1e-14) {
    const Element from = attributes.source("axis");
    from.diagnostics().error("F318", from.attribute_at("axis"), "the axis of a joint has no length");
  } else if (joint.scalar()) {
    joint.axis = axis.stableNormalized();
  }
  const double ref = attributes.number("ref", 0), springref = attributes.number("springref", 0);
  if (joint.scalar()) joint.ref = ref * unit;
  if (joint.scalar()) joint.springref = springref * unit;
  if (settings.springs) joint.stiffness = read_polynomial(attributes, "stiffness");
  if (settings.damping) joint.damping = read_polynomial(attributes, "damping");
  joint.armature = attributes.number("armature", 0);
  read_range(attributes, settings, unit, joint);
  read_springdamper(attributes, settings, joint);
  tell_what_is_left_out(attributes);
  return joint;
}

}  // namespace ferrers::mjcf
