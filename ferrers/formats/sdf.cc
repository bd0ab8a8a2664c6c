#include "ferrers/formats/sdf.h"

#include <optional>

#include "ferrers/formats/name_map.h"
#include "ferrers/formats/sdf_base.h"
#include "ferrers/formats/sdf_couplings.h"
#include "ferrers/formats/sdf_joints.h"
#include "ferrers/formats/sdf_links.h"
#include "ferrers/formats/sdf_tree.h"

namespace ferrers {
namespace {

void read_gravity(const SdfTree& tree, const SdfElement& root, ModelSpec& spec) {
  spec.gravity = number3(0, 0, -9.8);  // what SDF says of a world that gives none
  if (!tree.world) {
    root.notice("F603", "the file has no world: gravity is 9.8 m/s^2 downwards, as in a world that gives none");
    return;
  }
  const SdfElement physics = tree.world.child("physics");  // where versions before 1.6 have it
  const SdfElement where = physics && physics.child("gravity") ? physics : tree.world;
  if (const auto given = where.vector("gravity")) spec.gravity = numbers_of(*given, where.child("gravity").text_at());
}

/// Asks for every frame, so that references to nothing are told of frames too that nobody uses.
void check_frames(SdfFrames& frames) {
  for (int i = 0; i < frames.size(); ++i) {
    frames.pose_in_world(i);
    frames.body_of(i);
  }
}

}  // namespace

ImportedModel read_sdf(std::string_view text, const ImportContext& context) {
  ImportedModel model;
  SdfLibrary library(context);
  const SdfFile* file = library.open_main(text);
  if (!file) return model;
  const SdfElement root(*file, file->document().root());
  SdfTree tree = read_sdf_tree(*file, library, context.options.base == ImportBase::kFree);
  if (context.diagnostics.has_errors()) return model;
  check_frames(tree.frames);
  read_gravity(tree, root, model.spec);
  if (!tree.only_moving.empty()) model.spec.name = tree.only_moving.substr(0, tree.only_moving.size() - 2);
  NameMap names;
  const SdfBodies bodies = read_sdf_links(tree, names, model);
  const std::vector<SdfMadeJoint> made = read_sdf_joints(tree, bodies, context.options, names, model.spec);
  read_sdf_couplings(tree, bodies, made, names, model.spec);
  add_sdf_bases(tree, bodies, made, context.options, names, model.spec);
  if (model.spec.bodies.empty() && !context.diagnostics.has_errors()) {
    root.error("F605", "nothing in the file can move");
  }
  library.report_unread();
  model.renamed = names.renamed();
  return model;
}

}  // namespace ferrers
