#include "ferrers/formats/sdf_tree.h"

#include <fmt/format.h>

#include <utility>

#include "ferrers/formats/sdf_versions.h"

namespace ferrers {
namespace {

constexpr int kDeepestModel = 100;

/// Where a model stands, and what an <include> says instead of the model's own file.
struct Surroundings {
  int scope = 0;
  int top = -1;      ///< The outermost model around; -1 in the world.
  int model = -1;    ///< The model around.
  std::string path;  ///< Before the names of what is inside: "outer::".
  bool is_static = false;
  int depth = 0;
  SdfElement include;  ///< May not exist.
};

class TreeReader {
 public:
  TreeReader(SdfLibrary& library, bool ignore_static) : library_(library), ignore_static_(ignore_static) {}

  SdfTree read(const SdfFile& file);

 private:
  void read_world(const SdfElement& world);
  void read_model(const SdfElement& model, const Surroundings& around);
  void read_include(const SdfElement& include, const Surroundings& around);
  void read_contents(const SdfElement& model, const Surroundings& inside);
  void read_link(const SdfElement& link, const Surroundings& around);
  void read_joint(const SdfElement& joint, const Surroundings& around);
  void read_frame(const SdfElement& frame, const Surroundings& around);

  SdfReference reference_of(const SdfElement& element, std::string_view attribute) const;
  void choose_canonical(int model_frame);
  void find_only_moving();
  void place(SdfFrame& frame, const SdfElement& pose) const;
  void place_model(SdfFrame& frame, const SdfElement& model, const SdfElement& include) const;

  SdfLibrary& library_;
  bool ignore_static_;
  SdfTree tree_;
};

SdfReference TreeReader::reference_of(const SdfElement& element, std::string_view attribute) const {
  return {element.attribute(attribute), element};
}

/// A <pose>, which may not exist.
void TreeReader::place(SdfFrame& frame, const SdfElement& pose) const {
  if (!pose) return;
  frame.X_RF = pose.pose();
  // Version 1.5 and 1.6 had the same under another name.
  frame.relative_to = reference_of(pose, pose.version() >= kUniqueFrameNames ? "relative_to" : "frame");
}

void TreeReader::read_frame(const SdfElement& element, const Surroundings& around) {
  const std::optional<NameRef> name = element.required_name();
  if (!name) return;
  SdfFrame frame;
  frame.kind = SdfFrame::Kind::kFrame;
  frame.name = name->name;
  frame.scope = around.scope;
  frame.attached_to = reference_of(element, "attached_to");
  frame.element = element;
  place(frame, element.child("pose"));
  tree_.frames.add(std::move(frame));
}

void TreeReader::read_link(const SdfElement& element, const Surroundings& around) {
  if (around.model < 0) return element.error("F605", "a link stands in the world, not in a model");
  const std::optional<NameRef> name = element.required_name();
  if (!name) return;
  SdfFrame frame;
  frame.kind = SdfFrame::Kind::kLink;
  frame.name = name->name;
  frame.scope = around.scope;
  frame.element = element;
  place(frame, element.child("pose"));
  const int index = tree_.frames.add(std::move(frame));
  tree_.links.push_back({index, around.model, around.path + name->name, element});
}

void TreeReader::read_joint(const SdfElement& element, const Surroundings& around) {
  const std::optional<NameRef> name = element.required_name();
  if (!name) return;
  SdfJoint joint;
  SdfFrame frame;
  frame.kind = SdfFrame::Kind::kJoint;
  frame.name = name->name;
  frame.scope = around.scope;
  frame.element = element;
  const SdfElement pose = element.child("pose");
  const SdfElement child = element.child("child");
  if (!child) element.error("F202", fmt::format("the joint '{}' has no <child>", name->name));
  frame.attached_to = {child ? child.text() : "", child ? child : element};
  place(frame, pose);
  joint.has_pose = static_cast<bool>(pose);
  joint.scope = around.scope;
  joint.path = around.path + name->name;
  joint.element = element;
  const bool shadowed = element.version() < kUniqueFrameNames && tree_.frames.is_taken(around.scope, name->name);
  joint.frame = tree_.frames.add(std::move(frame), !shadowed);
  tree_.joints.push_back(std::move(joint));
}

/// The link that the model's frame moves with, where the file does not say: its first one, else that of its first inner
/// model.
void TreeReader::choose_canonical(int model_frame) {
  SdfFrames& frames = tree_.frames;
  const int inside = frames[model_frame].inner;
  for (const SdfFrame::Kind kind : {SdfFrame::Kind::kLink, SdfFrame::Kind::kModel}) {
    for (int i = model_frame + 1; i < frames.size(); ++i) {
      if (frames[i].kind != kind || !frames.share_names(frames[i].scope, inside)) continue;
      return frames.attach(model_frame, {frames[i].name, frames[model_frame].element});
    }
  }
  frames[model_frame].element.notice("F603", fmt::format("the model '{}' holds no link", frames[model_frame].name));
}

void TreeReader::place_model(SdfFrame& frame, const SdfElement& model, const SdfElement& include) const {
  frame.placement = reference_of(model, "placement_frame");
  const SdfElement own_pose = model.child("pose");
  const SdfElement pose = include ? include.child("pose") : SdfElement();
  place(frame, pose ? pose : own_pose);
  const SdfElement placement = include ? include.child("placement_frame") : SdfElement();
  if (!placement) return;
  frame.placement = {placement.text(), placement};
  if (!pose) placement.error("F202", "an <include> with a <placement_frame> needs a <pose>");
}

void TreeReader::read_model(const SdfElement& model, const Surroundings& around) {
  const std::optional<NameRef> own_name = model.required_name();
  if (!own_name) return;
  if (around.depth >= kDeepestModel) {
    model.error("F108", fmt::format("models are nested more than {} deep", kDeepestModel));
    return;
  }
  const SdfElement new_name = around.include ? around.include.child("name") : SdfElement();
  const std::string name = new_name && !new_name.text().empty() ? new_name.text() : own_name->name;
  const bool merged = around.include && around.include.flag_attribute("merge", false);
  if (merged && around.model < 0) {
    around.include.attribute_error("merge", "F605", "a model cannot be merged into the world");
    return;
  }
  SdfFrame frame;
  frame.kind = SdfFrame::Kind::kModel;
  frame.name = merged ? fmt::format("_merged__{}__model__", name) : name;
  frame.scope = around.scope;
  frame.attached_to = reference_of(model, "canonical_link");
  frame.element = model;
  place_model(frame, model, around.include);
  frame.inner = tree_.frames.add_scope(tree_.frames.size(), merged ? around.scope : -1);

  Surroundings inside = around;
  inside.include = {};
  inside.scope = frame.inner;
  inside.depth = around.depth + 1;
  const int index = tree_.frames.add(std::move(frame));
  const bool own_static = model.flag("static", false);
  if (!merged) {
    bool is_static = own_static;
    if (around.include) is_static = around.include.flag("static", is_static);
    inside.is_static = !ignore_static_ && (around.is_static || is_static);
    inside.path = around.path + name + "::";
    inside.model = static_cast<int>(tree_.models.size());
    inside.top = around.top < 0 ? inside.model : around.top;
    tree_.models.push_back({index, inside.top, inside.is_static});
  }
  read_contents(model, inside);
  if (tree_.frames[index].attached_to.name.empty()) choose_canonical(index);
}

/// A world's or a model's. One after the other: a joint that is called as a link must find the link taken.
void TreeReader::read_contents(const SdfElement& element, const Surroundings& inside) {
  for (const SdfElement& one : element.children("link")) read_link(one, inside);
  for (const SdfElement& one : element.children("model")) read_model(one, inside);
  for (const SdfElement& one : element.children("include")) read_include(one, inside);
  for (const SdfElement& one : element.children("frame")) read_frame(one, inside);
  for (const SdfElement& one : element.children("joint")) read_joint(one, inside);
  for (const XmlElement& one : element.xml().children()) {
    if (one.name() != "drake:joint") continue;
    one.mark_read_with_all();
    SdfElement(element.file(), one).error("F602", "joints of Drake's own kinds are not read");
  }
}

void TreeReader::read_include(const SdfElement& include, const Surroundings& around) {
  const SdfElement uri = include.child("uri");
  if (!uri || uri.text().empty()) {
    include.error("F202", "an <include> has no <uri>");
    return;
  }
  const SdfFile* file = library_.open_included(include, uri);
  if (!file) return;
  const SdfElement root(*file, file->document().root());
  const SdfElement model = root.child("model");
  if (!model) {
    uri.text_error("F605", fmt::format("'{}' holds no model", uri.text()));
    return;
  }
  Surroundings at_model = around;
  at_model.include = include;
  read_model(model, at_model);
}

void TreeReader::read_world(const SdfElement& world) {
  tree_.world = world;
  read_contents(world, {});
}

SdfTree TreeReader::read(const SdfFile& file) {
  const SdfElement root(file, file.document().root());
  const std::vector<SdfElement> worlds = root.children("world");
  const std::vector<SdfElement> models = root.children("model");
  if (worlds.size() > 1) worlds[1].error("F605", "the file holds several worlds", "put each into a file of its own");
  if (!worlds.empty() && !models.empty()) models[0].error("F605", "the file holds a model beside its world");
  if (worlds.empty() && models.empty()) root.error("F605", "the file holds no model");
  if (!worlds.empty()) {
    read_world(worlds[0]);
  } else {
    for (const SdfElement& one : models) read_model(one, {});
  }
  find_only_moving();
  return std::move(tree_);
}

void TreeReader::find_only_moving() {
  int moving = 0;
  for (std::size_t i = 0; i < tree_.models.size(); ++i) {
    const SdfModel& model = tree_.models[i];
    if (model.is_static || model.top != static_cast<int>(i)) continue;
    tree_.only_moving = ++moving == 1 ? tree_.frames[model.frame].name + "::" : "";
  }
}

}  // namespace

SdfTree read_sdf_tree(const SdfFile& file, SdfLibrary& library, bool ignore_static) {
  return TreeReader(library, ignore_static).read(file);
}

}  // namespace ferrers
