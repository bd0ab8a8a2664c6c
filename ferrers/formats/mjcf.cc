#include "ferrers/formats/mjcf.h"

#include <fmt/format.h>

#include "ferrers/formats/mjcf_import.h"

namespace ferrers {
namespace mjcf {
namespace {

// What draws, says how geoms touch, steers MuJoCo's own solvers or sizes its memory.
constexpr std::string_view kQuiet[] = {"visual",
                                       "statistic",
                                       "size",
                                       "texture",
                                       "material",
                                       "hfield",
                                       "skin",
                                       "light",
                                       "camera",
                                       "custom",
                                       "lengthrange",
                                       "geom@material",
                                       "geom@rgba",
                                       "geom@group",
                                       "geom@solref",
                                       "geom@solimp",
                                       "geom@solmix",
                                       "geom@hfield",
                                       "geom@fitscale",
                                       "geom@user",
                                       "geom@priority",
                                       "geom@size",
                                       "geom@fluidshape",
                                       "geom@fluidcoef",
                                       "geom@contype",
                                       "geom@conaffinity",
                                       "geom@condim",
                                       "geom@friction",
                                       "geom@margin",
                                       "geom@gap",
                                       "geom@surfacevel",
                                       "geom@adhesion",
                                       "site@type",
                                       "site@size",
                                       "site@rgba",
                                       "site@material",
                                       "site@group",
                                       "site@user",
                                       "site@pos",
                                       "site@quat",
                                       "joint@group",
                                       "joint@solreflimit",
                                       "joint@solimplimit",
                                       "joint@solreffriction",
                                       "joint@solimpfriction",
                                       "joint@margin",
                                       "joint@user",
                                       "joint@actuatorfrcrange",
                                       "joint@actuatorfrclimited",
                                       "joint@actuatorgravcomp",
                                       "freejoint@group",
                                       "body@user",
                                       "body@sleep",
                                       "body@simple",
                                       "body@fuse",
                                       "connect@solref",
                                       "connect@solimp",
                                       "weld@solref",
                                       "weld@solimp",
                                       "joint@solref",
                                       "joint@solimp",
                                       "tendon@solref",
                                       "tendon@solimp",
                                       "equality@solref",
                                       "equality@solimp",
                                       "flag",
                                       "fixed@limited",
                                       "fixed@range",
                                       "fixed@solreflimit",
                                       "fixed@solimplimit",
                                       "fixed@group",
                                       "fixed@user",
                                       "fixed@margin",
                                       "fixed@rgba",
                                       "fixed@width",
                                       "fixed@springlength",
                                       "fixed@class",
                                       "option@timestep",
                                       "option@integrator",
                                       "option@solver",
                                       "option@iterations",
                                       "option@tolerance",
                                       "option@cone",
                                       "option@jacobian",
                                       "option@impratio",
                                       "option@apirate",
                                       "option@noslip_iterations",
                                       "option@noslip_tolerance",
                                       "option@ls_iterations",
                                       "option@ls_tolerance",
                                       "option@ccd_iterations",
                                       "option@ccd_tolerance",
                                       "option@sdf_iterations",
                                       "option@sdf_initpoints",
                                       "option@o_margin",
                                       "option@o_solref",
                                       "option@o_solimp",
                                       "option@o_friction",
                                       "option@mpr_iterations",
                                       "option@mpr_tolerance",
                                       "option@actuatorgroupdisable",
                                       "option@magnetic",
                                       "option@collision",
                                       "compiler@texturedir",
                                       "compiler@discardvisual",
                                       "compiler@usethread",
                                       "compiler@strippath",
                                       "compiler@convexhull",
                                       "compiler@fusestatic",
                                       "compiler@fitaabb",
                                       "compiler@saveinertial",
                                       "compiler@exactmeshinertia",
                                       "compiler@savecompiled",
                                       "compiler@savecanonical",
                                       "compiler@conflict",
                                       "compiler@passthrough",
                                       "mesh@class",
                                       "mesh@vertex",
                                       "mesh@normal",
                                       "mesh@texcoord",
                                       "mesh@face",
                                       "mesh@refpos",
                                       "mesh@refquat",
                                       "mesh@smoothnormal",
                                       "mesh@maxhullvert",
                                       "mesh@inertia",
                                       "mesh@builtin",
                                       "mesh@params",
                                       "mesh@content_type",
                                       "mesh@octree_maxdepth",
                                       "mesh@material",
                                       "motor",
                                       "position",
                                       "velocity",
                                       "intvelocity",
                                       "damper",
                                       "cylinder",
                                       "muscle",
                                       "adhesion",
                                       "general",
                                       "pair"};

void refuse_other_sections(const Element& root) {
  const auto refuse = [](const Element& element, std::string_view what) {
    element.mark_read_with_all();
    element.diagnostics().error("F602", element.at(), fmt::format("{} is not supported", what));
  };
  for (const Element& section : root.children("deformable")) {
    for (const Element& flex : section.children("flex")) refuse(flex, "<flex>");
  }
  for (const Element& section : root.children("asset")) {
    for (const Element& model : section.children("model")) refuse(model, "<model>, a model within the model,");
  }
}

ImportedModel read(const Element& root, const ImportOptions& options) {
  const Settings settings = read_settings(root);
  Defaults defaults(root);
  Tree tree = read_tree(root, settings, defaults);
  Import import{root, settings, std::move(defaults), std::move(tree), options, {}, {}};
  import.spec().name = root.text_of("model");
  import.spec().gravity = vector_spec(settings.gravity);
  apply_base(import);
  add_bodies(import);
  add_joints(import);
  add_joint_forces(import);
  const FixedTendons tendons = read_tendons(import);
  add_equalities(import, tendons);
  add_drives(import, tendons);
  add_initial_state(import);
  add_visuals(import);
  refuse_other_sections(root);
  import.result.renamed = import.names.renamed();
  return std::move(import.result);
}

}  // namespace
}  // namespace mjcf

ImportedModel read_mjcf(std::string_view text, const ImportContext& context) {
  const std::unique_ptr<mjcf::Document> document = mjcf::Document::load(text, context);
  if (!document) return {};
  const mjcf::Element root = document->root();
  if (root.name() != "mujoco" && root.name() != "mujocoinclude") {
    context.diagnostics.error("F605", root.at(), fmt::format("the root element is <{}>, not <mujoco>", root.name()));
    return {};
  }
  ImportedModel model = mjcf::read(root, context.options);
  document->report_unread(mjcf::kQuiet);
  document->flush(context.diagnostics);
  return model;
}

}  // namespace ferrers
