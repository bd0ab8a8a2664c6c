#include "ferrers/formats/asmt.h"

#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ferrers/formats/asmt_assembly.h"
#include "ferrers/formats/asmt_document.h"
#include "ferrers/formats/asmt_joints.h"
#include "ferrers/formats/asmt_motions.h"
#include "ferrers/formats/body_groups.h"

namespace ferrers {
namespace {

constexpr std::string_view kOndsel = "OndselSolver";
constexpr std::string_view kAskoh = "freeCAD: 3D CAD with Motion Simulation";

/// Units of length in a metre, by the first line; nothing, with an error, where this is no ASMT file.
std::optional<double> unit_of_length(const std::vector<AsmtRecord>& top, Diagnostics& diagnostics) {
  const bool ondsel = !top.empty() && top.front().name() == kOndsel;
  const bool askoh = !top.empty() && top.front().name().substr(0, kAskoh.size()) == kAskoh;
  if (!ondsel && !askoh) {
    diagnostics.error("F605", top.empty() ? SourceRange{} : top.front().at(), "this is no ASMT file",
                      fmt::format("its first line is '{}'", kOndsel));
    return std::nullopt;
  }
  top.front().mark_read();
  diagnostics.notice("F603", top.front().at(),
                     ondsel ? "lengths are read as millimetres, masses as kg, angles as rad"
                            : "lengths are read as metres, masses as kg, angles as rad",
                     "the first line decides: FreeCAD's Assembly workbench writes 'OndselSolver' and works in mm");
  return ondsel ? 1000.0 : 1.0;
}

/// "Document#", where all names of parts and joints that have a '#' start so.
std::string shared_prefix(const AsmtRecord& assembly) {
  std::optional<std::string> shared;
  const auto look = [&](const AsmtRecord& list) {
    if (!list) return true;
    for (const AsmtRecord& one : list.children()) {
      for (const AsmtRecord& record : one.children()) {
        if (record.name() != "Name" || record.empty()) continue;
        const std::string_view name = record.children().front().name();
        const std::size_t end = name.rfind('#');
        if (end == std::string_view::npos) continue;
        const std::string prefix(name.substr(0, end + 1));
        if (shared && *shared != prefix) return false;
        shared = prefix;
      }
    }
    return true;
  };
  const AsmtRecord sets = assembly.child("ConstraintSets");
  const bool same = look(assembly.child("Parts")) && (!sets || look(sets.child("Joints")));
  return same ? shared.value_or("") : std::string();
}

/// What takes part in the mechanics and has no counterpart here.
void refuse(const AsmtRecord& owner, std::string_view list, std::string_view what, Diagnostics& diagnostics) {
  const AsmtRecord record = owner.child(list);
  if (!record) return;
  for (const AsmtRecord& one : record.children()) {
    if (one.name().empty()) continue;
    one.mark_read_with_all();
    diagnostics.error("F602", one.at(), fmt::format("{} of the class '{}' are not supported", what, one.name()),
                      "leave it out of the file and describe it in the native format");
  }
}

void read_notes(const AsmtRecord& assembly, AsmtImport& import) {
  const AsmtRecord notes = assembly.child("Notes");
  if (!notes) return;
  std::string doc;
  for (const AsmtRecord& line : notes.values()) {
    if (line.name().substr(0, 16) == "(Text string: ''") continue;  // how an empty note is written
    if (!doc.empty()) doc += ' ';
    doc += line.name();
  }
  import.spec.doc = doc;
}

void read_gravity(const AsmtRecord& assembly, AsmtImport& import) {
  import.spec.gravity = number3(0, 0, 0);
  const AsmtRecord gravity = assembly.child("ConstantGravity");
  if (!gravity) return;
  const auto g = import.geometry.triple(assembly, "ConstantGravity");
  if (!g) return;
  import.spec.gravity = asmt_number3(*g / import.geometry.per_metre(), gravity.value_at());
  if (g->isZero(0)) {
    import.diagnostics.notice("F603", gravity.value_at(), "there is no gravity, as the file says");
  }
}

void tell_simulation(const AsmtRecord& assembly, AsmtImport& import) {
  const AsmtRecord record = assembly.child("SimulationParameters");
  if (!record) return;
  record.mark_read_with_all();
  const auto text = [&](std::string_view name) -> std::string {
    Diagnostics ignored;  // nobody needs these numbers
    const auto value = AsmtGeometry(1, ignored).number(record, name);
    return value ? fmt::format("{}", *value) : "?";
  };
  import.diagnostics.notice("F601", record.at(),
                            fmt::format("'SimulationParameters' are not part of a model: the file asks for {} to {} s "
                                        "in steps of {} s",
                                        text("tstart"), text("tend"), text("hout")),
                            "times of runs are options of the command");
}

void tell_results(const std::vector<AsmtRecord>& top, Diagnostics& diagnostics) {
  if (top.size() < 3) return;
  for (std::size_t i = 2; i < top.size(); ++i) top[i].mark_read_with_all();
  diagnostics.notice("F601", top[2].at(),
                     fmt::format("results of an earlier run, {} lines from here on, are not read", top.size() - 2));
}

/// A part is free by itself: one that no joint holds is given the joint that says so.
void free_loose_parts(AsmtImport& import) {
  BodyGroups groups;
  const std::string ground = "ground";
  for (const JointSpec& joint : import.spec.joints) groups.join(joint.bodies[0].name, joint.bodies[1].name);
  for (const BodySpec& body : import.spec.bodies) {
    if (groups.are_joined(body.name.name, ground)) continue;
    groups.join(body.name.name, ground);
    JointSpec joint;
    joint.name = NameRef(import.names.add("joints", "joint", "float_" + body.name.name), body.name.at);
    joint.type = JointType::kFree;
    joint.bodies = {NameRef(ground, body.name.at), body.name};
    import.spec.joints.push_back(std::move(joint));
    import.diagnostics.notice(
        "F603", body.name.at,
        fmt::format("no joint holds '{}' to the assembly: it floats, with all that hangs on it", body.name.name));
  }
}

void read_assembly(const AsmtRecord& assembly, AsmtImport& import) {
  for (const std::string_view name : {"Parts", "ConstraintSets", "ConstantGravity"}) {  // in this order in every file
    if (assembly.child(name)) continue;
    import.diagnostics.error("F202", assembly.at(), fmt::format("'Assembly' has no '{}'", name),
                             "the file may have been cut off");
    return;
  }
  import.shared_prefix = shared_prefix(assembly);
  if (import.context.options.base != ImportBase::kAsInFile) {
    import.diagnostics.warning("F601", assembly.at(), "what is fixed to ground is said by joints of the file alone");
  }
  if (!import.shared_prefix.empty()) {
    import.diagnostics.notice("F603", assembly.at(),
                              fmt::format("names are read without '{}', the document's name", import.shared_prefix));
  }
  read_notes(assembly, import);
  read_asmt_parts(assembly, import);
  import.spec.name = import.assembly == "OndselAssembly" ? std::string() : import.assembly;  // what all are called
  if (const AsmtRecord sets = assembly.child("ConstraintSets")) {
    const AsmtJoints joints = read_asmt_joints(sets, import);
    read_asmt_motions(sets, joints, import);
    read_asmt_limits(sets, joints, import);
    refuse(sets, "GeneralConstraintSets", "constraints", import.diagnostics);
  }
  free_loose_parts(import);
  refuse(assembly, "ForceTorques", "forces", import.diagnostics);
  read_gravity(assembly, import);
  tell_simulation(assembly, import);
  if (const AsmtRecord animation = assembly.child("AnimationParameters")) animation.mark_read_with_all();
  for (const std::string_view list : {"KinematicIJs", "Assemblies"}) {
    for (const AsmtRecord& one : assembly.children()) {
      if (one.name() == list && one.empty()) one.mark_read();
    }
  }
  import.geometry.tell_rounded();
}

}  // namespace

ImportedModel read_asmt(std::string_view text, const ImportContext& context) {
  ImportedModel model;
  const std::unique_ptr<const AsmtDocument> document = AsmtDocument::parse(text, context.diagnostics);
  if (!document) return model;
  const std::vector<AsmtRecord> top = document->top();
  const std::optional<double> per_metre = unit_of_length(top, context.diagnostics);
  if (!per_metre) return model;
  if (top.size() < 2 || top[1].name() != "Assembly") {
    context.diagnostics.error("F605", top.back().at(), "the second line is not 'Assembly'");
    return model;
  }
  top[1].mark_read();
  AsmtImport import(context, *per_metre);
  read_assembly(top[1], import);
  tell_results(top, context.diagnostics);
  if (!context.diagnostics.has_errors()) document->report_unread(context.diagnostics);
  model.spec = std::move(import.spec);
  model.renamed = import.names.renamed();
  return model;
}

}  // namespace ferrers
