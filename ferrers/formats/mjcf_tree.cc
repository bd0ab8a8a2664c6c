#include "ferrers/formats/mjcf_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace ferrers::mjcf {
namespace {

constexpr std::size_t kMostBodies = 20000;
constexpr std::size_t kMostElements = 500000;

/// Where the walk stands: what the enclosing frames, copies and classes mean for the next element.
struct Place {
  int body = 0;
  Pose X_BF;               ///< Of the enclosing frames in the body's frame.
  std::string childclass;  ///< Empty: the main class.
  std::string suffix;      ///< Of names in copies.
  bool copied = false;     ///< Directly in a <replicate>.
};

class TreeReader {
 public:
  TreeReader(const Settings& settings, const Defaults& defaults) : settings_(settings), defaults_(defaults) {
    tree_.bodies.emplace_back();
    tree_.bodies[0].original = "world";
    tree_.bodies[0].name = "ground";
    tree_.body_index.emplace("world", 0);
  }

  void walk(const Element& parent, const Place& place) {
    for (const Element& child : parent.children()) {
      if (full_ || is_full(child)) return;
      const std::string_view name = child.name();
      if (name == "body") read_body(child, place);
      if (name == "frame") read_frame(child, place);
      if (name == "replicate") read_copies(child, place);
      if (name == "joint" || name == "freejoint") add_joint(child, place);
      if (name == "geom") add_geom(child, place);
      if (name == "site") add_site(child, place);
      if (name == "inertial") add_inertial(child, place);
      if (name == "attach" || name == "composite" || name == "flexcomp") refuse(child);
    }
  }

  Tree finish() {
    for (TreeBody& body : tree_.bodies) {
      const bool carried = body.parent >= 0 && tree_.bodies[static_cast<std::size_t>(body.parent)].moves;
      body.moves = carried || !body.joints.empty();
    }
    return std::move(tree_);
  }

 private:
  /// Copies within copies grow fast.
  bool is_full(const Element& element) {
    full_ = ++elements_ > kMostElements || tree_.bodies.size() > kMostBodies;
    if (full_) {
      element.diagnostics().error(
          "F605", element.at(),
          fmt::format("with its copies the model has more than {} bodies or {} elements", kMostBodies, kMostElements));
    }
    return full_;
  }

  void refuse(const Element& element) {
    element.mark_read_with_all();
    element.diagnostics().error("F602", element.at(), fmt::format("<{}> is not supported", element.name()),
                                "MuJoCo can save the model without it: mj_saveLastXML, or Save xml in simulate");
  }

  std::string childclass_of(const Element& element, const Place& place) {
    defaults_.check_class(element, "childclass");
    const std::string own = element.text_of("childclass");
    return own.empty() ? place.childclass : own;
  }

  std::string named(const Element& element, const Place& place) const {
    const std::string name = element.text_of("name");
    return name.empty() ? name : name + place.suffix;
  }

  template <class Index, class Value>
  void add_name(Index& index, const Element& element, const std::string& name, std::string_view kind,
                const Value& value) {
    if (name.empty() || index.emplace(name, value).second) return;
    element.diagnostics().error("F302", element.attribute_at("name"), fmt::format("two {} are named '{}'", kind, name));
  }

  void read_body(const Element& element, const Place& place) {
    element.mark_read();
    const Attributes attributes(element);
    TreeBody body;
    body.element = element;
    body.original = named(element, place);
    body.parent = place.body;
    body.X_PB = place.X_BF * read_pose(attributes, settings_);
    body.X_WB = tree_.bodies[static_cast<std::size_t>(place.body)].X_WB * body.X_PB;
    body.gravity_compensation = attributes.number("gravcomp", 0);
    body.mocap = attributes.truth("mocap", false);
    const int index = static_cast<int>(tree_.bodies.size());
    add_name(tree_.body_index, element, body.original, "bodies", index);
    tree_.bodies.push_back(std::move(body));
    walk(element, {index, Pose(), childclass_of(element, place), place.suffix, false});
  }

  void read_frame(const Element& element, const Place& place) {
    element.mark_read();
    element.attribute("name");
    for (const char* name : {"scale", "massscale"}) {
      if (!element.attribute(name)) continue;
      element.diagnostics().error("F602", element.attribute_at(name),
                                  fmt::format("'{}' of <frame> is not supported", name));
    }
    const Pose X_BF = place.X_BF * read_pose(Attributes(element), settings_);
    walk(element, {place.body, X_BF, childclass_of(element, place), place.suffix, place.copied});
  }

  void read_copies(const Element& element, const Place& place) {
    element.mark_read();
    const Attributes attributes(element);
    const double asked = attributes.number("count", 0);
    if (asked < 1 || asked != std::floor(asked) || asked > static_cast<double>(kMostBodies)) {
      element.diagnostics().error("F605", element.attribute_at("count"),
                                  fmt::format("<replicate> needs a whole number from 1 to {} as 'count'", kMostBodies));
      return;
    }
    const int count = static_cast<int>(asked);
    const Vector3d angles = attributes.vector("euler", Vector3d::Zero());
    const Pose step(euler_rotation(settings_.eulerseq, settings_.angle_unit * angles),
                    attributes.vector("offset", Vector3d::Zero()));
    const std::size_t digits = std::to_string(count - 1).size();
    Place copy = place;
    copy.copied = true;
    for (int i = 0; i < count && !full_; ++i) {
      copy.suffix = fmt::format("{}{:0{}}{}", element.text_of("sep"), i, digits, place.suffix);
      walk(element, copy);
      copy.X_BF = copy.X_BF * step;
    }
  }

  void add_joint(const Element& element, const Place& place) {
    element.mark_read();
    element.attribute("align");
    const Attributes attributes =
        element.name() == "freejoint" ? Attributes(element) : defaults_.of(element, "joint", place.childclass);
    TreeJoint joint = read_joint(element, attributes, settings_);
    joint.original = named(element, place);
    joint.axis = place.X_BF.R * joint.axis;
    if (joint.kind != JointKind::kFree) joint.pos = place.X_BF * joint.pos;
    TreeBody& body = tree_.bodies[static_cast<std::size_t>(place.body)];
    const auto wrong = [&](const std::string& message) { element.diagnostics().error("F605", element.at(), message); };
    const bool free = joint.kind == JointKind::kFree;
    const bool has_free = std::any_of(body.joints.begin(), body.joints.end(),
                                      [](const TreeJoint& other) { return other.kind == JointKind::kFree; });
    if (place.body == 0) return wrong("the world has a joint");
    if (body.mocap) return wrong("a mocap body has a joint");
    if (free && body.parent != 0) return wrong("a free joint below another body; it stands in children of the world");
    if ((free && !body.joints.empty()) || has_free) return wrong("a free joint beside another joint of its body");
    if (place.copied) return wrong("a joint directly in <replicate>; it stands in a body there");
    add_name(tree_.joint_index, element, joint.original, "joints",
             std::pair(place.body, static_cast<int>(body.joints.size())));
    body.joints.push_back(std::move(joint));
  }

  void add_geom(const Element& element, const Place& place) {
    element.mark_read();
    element.attribute("name");
    Geom geom = read_geom(defaults_.of(element, "geom", place.childclass), settings_);
    geom.X_BG = place.X_BF * geom.X_BG;
    tree_.bodies[static_cast<std::size_t>(place.body)].geoms.push_back(std::move(geom));
  }

  void add_site(const Element& element, const Place& place) {
    element.mark_read();
    const Attributes attributes = defaults_.of(element, "site", place.childclass);
    TreeSite site;
    site.body = place.body;
    site.X_BS = place.X_BF * read_pose(attributes, settings_);
    if (const auto points = attributes.numbers("fromto", 6, 6)) {
      const Vector3d from(points->data()), to(points->data() + 3);
      site.X_BS.p = place.X_BF * Vector3d(0.5 * from + 0.5 * to);
      if ((to - from).stableNorm() > 1e-14) site.X_BS.R = place.X_BF.R * rotation_to(to - from);
    }
    add_name(tree_.sites, element, named(element, place), "sites", site);
  }

  void add_inertial(const Element& element, const Place& place) {
    element.mark_read();
    MassProperties mass = read_inertial(element, settings_);
    mass.com = place.X_BF * mass.com;
    mass.inertia = place.X_BF.R * mass.inertia * place.X_BF.R.transpose();
    TreeBody& body = tree_.bodies[static_cast<std::size_t>(place.body)];
    if (place.body == 0 || body.inertial) {
      element.diagnostics().error("F605", element.at(),
                                  place.body == 0 ? "the world has an <inertial>" : "a body has two <inertial>");
      return;
    }
    body.inertial = mass;
  }

  const Settings& settings_;
  const Defaults& defaults_;
  Tree tree_;
  std::size_t elements_ = 0;
  bool full_ = false;
};

}  // namespace

Tree read_tree(const Element& root, const Settings& settings, const Defaults& defaults) {
  TreeReader reader(settings, defaults);
  for (const Element& world : root.children("worldbody")) {
    defaults.check_class(world, "childclass");
    reader.walk(world, {0, Pose(), world.text_of("childclass"), "", false});
  }
  return reader.finish();
}

}  // namespace ferrers::mjcf
