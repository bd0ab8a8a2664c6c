#include "ferrers/formats/urdf.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

#include "ferrers/formats/joint_recognition.h"
#include "ferrers/formats/urdf_import.h"

namespace ferrers {
namespace {

constexpr std::array<std::string_view, 1> kQuiet = {"robot@version"};

bool is_xacro(std::string_view name) { return name.rfind("xacro:", 0) == 0; }

/// Macros are another language, which is expanded before anybody reads the file.
bool refuse_macros(const XmlElement& robot, Diagnostics& diagnostics) {
  for (const XmlElement& child : robot.children()) {
    if (!is_xacro(child.name())) continue;
    diagnostics.error("F602", child.at(),
                      fmt::format("<{}> is a macro of xacro, which is not expanded here", child.name()),
                      "expand the file first: xacro robot.urdf.xacro > robot.urdf");
    return true;
  }
  return false;
}

void mark_name_spaces(const XmlElement& robot) {
  for (const std::string_view name : robot.attribute_names()) {
    if (name.rfind("xmlns", 0) == 0) robot.attribute(name);
  }
}

/// Rows of revolute joints that stand for one: merged where that is asked for or loops are closed, else told.
void treat_revolute_rows(ImportedModel& model, const ImportContext& context) {
  const std::vector<RevoluteRow> rows = find_revolute_rows(model.spec);
  if (rows.empty()) return;
  const bool has_loops = model.spec.joints.size() > model.spec.bodies.size();
  if (!context.options.merge_revolute_rows.value_or(has_loops)) {
    const RevoluteRow& first = rows.front();
    context.diagnostics.notice(
        "F603", {},
        fmt::format("the revolute joints '{}' move like one {} joint and stay as they are{}",
                    fmt::join(first.joints, "', '"), first.type == JointType::kSpherical ? "spherical" : "universal",
                    rows.size() > 1 ? fmt::format(", and so do {} more rows", rows.size() - 1) : ""));
    return;
  }
  merge_revolute_rows(model.spec, rows, context.diagnostics);
  const auto is_gone = [&](const VisualShape& shape) {
    return std::any_of(rows.begin(), rows.end(), [&](const RevoluteRow& row) {
      return std::find(row.between.begin(), row.between.end(), shape.body) != row.between.end();
    });
  };
  const auto gone = std::remove_if(model.visuals.begin(), model.visuals.end(), is_gone);
  if (gone == model.visuals.end()) return;
  context.diagnostics.notice(
      "F603", {}, fmt::format("{} shapes of links between merged joints are left out", model.visuals.end() - gone));
  model.visuals.erase(gone, model.visuals.end());
}

}  // namespace

ImportedModel read_urdf(std::string_view text, const ImportContext& context) {
  const std::unique_ptr<const XmlDocument> document = XmlDocument::parse(text, context.diagnostics);
  if (!document) return {};
  const XmlElement robot = document->root();
  if (robot.name() != "robot") {
    context.diagnostics.error("F605", robot.at(), fmt::format("the root element is <{}>, not <robot>", robot.name()));
    return {};
  }
  mark_name_spaces(robot);
  if (refuse_macros(robot, context.diagnostics)) return {};
  std::optional<UrdfTree> tree = read_urdf_tree(robot, context.diagnostics);
  if (!tree) return {};
  const std::optional<UrdfClosures> closures = read_urdf_closures(context);
  UrdfImport import{context, robot, std::move(*tree), {}, {}, {}, {}, {}};
  import.spec().name = robot.attribute("name").value_or("");
  if (closures) replace_urdf_joint_types(import, *closures);
  import_urdf_links(import);
  import_urdf_visuals(import);
  import_urdf_joints(import);
  import_urdf_base(import);
  import_urdf_loops(import);
  import_urdf_transmissions(import);
  if (closures) import_urdf_closures(import, *closures);
  treat_revolute_rows(import.model, context);
  document->report_unread(context.diagnostics, kQuiet);
  import.model.renamed = import.names.renamed();
  return std::move(import.model);
}

}  // namespace ferrers
