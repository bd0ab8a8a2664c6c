#include "ferrers/formats/asmt_assembly.h"

#include <fmt/format.h>

#include <optional>

#include "ferrers/model/pose_spec.h"

namespace ferrers {
namespace {

/// Records that name something, each with a `Name`, below `owner`'s record `list`.
std::vector<AsmtRecord> things(const AsmtRecord& owner, std::string_view list, std::string_view kind) {
  std::vector<AsmtRecord> found;
  const AsmtRecord record = owner.child(list);
  if (!record) return found;
  for (const AsmtRecord& one : record.children()) {
    if (one.name() != kind) continue;
    one.mark_read();
    found.push_back(one);
  }
  return found;
}

/// Records that are told where something stands in them, and not missed where nothing does.
void skip_empty(const AsmtRecord& owner, std::initializer_list<std::string_view> names) {
  for (const AsmtRecord& one : owner.children()) {
    for (const std::string_view name : names) {
      if (one.name() == name && one.empty()) one.mark_read();
    }
  }
}

class PartReader {
 public:
  explicit PartReader(AsmtImport& import) : import_(import) {}

  void read(const AsmtRecord& assembly);

 private:
  void read_markers(const AsmtRecord& owner, int part, const Pose& X_WP, const std::string& path);
  void read_part(const AsmtRecord& record);
  void read_mass(const AsmtRecord& part, BodySpec& body);
  void note_motion(const AsmtRecord& part);
  void tell();

  AsmtImport& import_;
  int placeholders_ = 0, massless_ = 0, moving_ = 0;
  SourceRange placeholder_at_, massless_at_, moving_at_;
};

void PartReader::read_markers(const AsmtRecord& owner, int part, const Pose& X_WP, const std::string& path) {
  for (const AsmtRecord& point : things(owner, "RefPoints", "RefPoint")) {
    const std::optional<Pose> X_PR = import_.geometry.pose(point);
    if (!X_PR) continue;
    for (const AsmtRecord& record : things(point, "Markers", "Marker")) {
      const std::optional<Pose> X_RM = import_.geometry.pose(record);
      if (!X_RM) continue;
      const auto [name, at] = asmt_text(import_, record, "Name");
      const Pose X_PM = *X_PR * *X_RM;
      import_.markers[fmt::format("{}/{}", path, name)].push_back({part, part < 0 ? X_WP * X_PM : X_PM, at});
    }
  }
  skip_empty(owner, {"RefCurves", "RefSurfaces"});
}

// FreeCAD knows no masses here and writes ones for every part.
void PartReader::read_mass(const AsmtRecord& part, BodySpec& body) {
  const AsmtRecord marker = part.child("PrincipalMassMarker");
  if (!marker) return;
  (void)asmt_text(import_, marker, "Name");
  const std::optional<Pose> X_PC = import_.geometry.pose(marker);
  const std::optional<double> mass = import_.geometry.number(marker, "Mass");
  const auto moments = import_.geometry.triple(marker, "MomentOfInertias");
  const std::string density = asmt_text(import_, marker, "Density").first;  // goes with shapes, which nobody reads
  if (!X_PC || !mass || !moments) return;
  const SourceRange at = marker.child("Mass").value_at();
  const SourceRange moments_at = marker.child("MomentOfInertias").value_at();
  body.mass = Number(*mass);
  body.mass->at = at;
  body.com = asmt_number3(X_PC->p, marker.child("Position3D").value_at());
  if (!moments->isZero(0)) {
    const double per_metre = import_.geometry.per_metre();
    body.inertia.kind = InertiaSpec::Kind::kTensor;
    body.inertia.moments = asmt_number3(*moments / (per_metre * per_metre), moments_at);
    body.inertia.rotation = pose_spec(*X_PC, moments_at).rotation;
    body.inertia.at = moments_at;
  }
  const bool ones = *mass == 1 && *moments == Eigen::Vector3d::Ones() && density == "1";
  if (ones && placeholders_++ == 0) placeholder_at_ = at;
  if (*mass == 0 && massless_++ == 0) massless_at_ = at;
}

void PartReader::note_motion(const AsmtRecord& part) {
  for (const std::string_view name : {"Velocity3D", "Omega3D"}) {
    if (!part.child(name)) continue;
    const auto rate = import_.geometry.triple(part, name);
    if (rate && !rate->isZero(0) && moving_++ == 0) moving_at_ = part.child(name).value_at();
  }
}

void PartReader::read_part(const AsmtRecord& record) {
  const int part = static_cast<int>(import_.parts.size());
  const auto [name, at] = asmt_text(import_, record, "Name");
  const std::optional<Pose> X_WP = import_.geometry.pose(record);
  BodySpec body;
  body.name = NameRef(import_.add_name("bodies", "body", name), at);
  body.pose = pose_spec(X_WP.value_or(Pose()), record.at());
  note_motion(record);
  read_mass(record, body);
  skip_empty(record, {"FeatureOrder"});
  import_.parts.push_back(body.name.name);
  import_.poses.push_back(X_WP.value_or(Pose()));
  import_.spec.bodies.push_back(std::move(body));
  read_markers(record, part, import_.poses.back(), "/" + import_.assembly + "/" + name);
}

void PartReader::tell() {
  const std::size_t parts = import_.parts.size();
  if (placeholders_ > 0) {
    import_.diagnostics.warning(
        "F603", placeholder_at_,
        fmt::format("{} of {} parts have mass 1 kg and moments of inertia of 1, which FreeCAD writes whatever the part",
                    placeholders_, parts),
        "ranks, mobility and driven motion do not depend on it; for forces put the true mass data in");
  }
  if (massless_ > 0) {
    import_.diagnostics.notice("F603", massless_at_,
                               fmt::format("{} of {} parts have mass 0, as the file says", massless_, parts));
  }
  if (moving_ > 0) {
    import_.diagnostics.notice("F601", moving_at_, "velocities of parts are not read",
                               "say with 'initial' of the native format how joints start");
  }
}

void PartReader::read(const AsmtRecord& assembly) {
  import_.assembly = asmt_text(import_, assembly, "Name").first;
  const Pose X_WA = import_.geometry.pose(assembly).value_or(Pose());
  if (!X_WA.R.isIdentity(0) || !X_WA.p.isZero(0)) {
    import_.diagnostics.notice("F603", assembly.child("Position3D").value_at(),
                               "the assembly's own frame places its own markers only; parts are given in the world");
  }
  note_motion(assembly);
  read_markers(assembly, -1, X_WA, "/" + import_.assembly);
  for (const AsmtRecord& part : things(assembly, "Parts", "Part")) read_part(part);
  tell();
}

}  // namespace

const AsmtMarker* AsmtImport::marker(const AsmtRecord& owner, std::string_view which) {
  const auto [path, at] = asmt_text(*this, owner, which);
  if (path.empty()) {
    diagnostics.error("F202", at, fmt::format("'{}' has no '{}'", owner.name(), which));
    return nullptr;
  }
  const auto found = markers.find(path);
  if (found == markers.end()) {
    diagnostics.error("F604", at, fmt::format("there is no marker '{}'", path),
                      "a marker is named '/assembly/part/marker' or '/assembly/marker'");
    return nullptr;
  }
  if (found->second.size() > 1) {
    diagnostics.error("F604", at, fmt::format("{} markers are called '{}'", found->second.size(), path),
                      "give parts, and markers of one part, names of their own");
    return nullptr;
  }
  return &found->second.front();
}

std::string AsmtImport::body(const AsmtMarker& marker) const {
  return marker.part < 0 ? "ground" : parts[static_cast<std::size_t>(marker.part)];
}

Pose AsmtImport::world(const AsmtMarker& marker) const {
  return marker.part < 0 ? marker.X_PM : poses[static_cast<std::size_t>(marker.part)] * marker.X_PM;
}

std::string AsmtImport::add_name(std::string_view space, std::string_view kind, std::string_view original) {
  if (!shared_prefix.empty() && original.substr(0, shared_prefix.size()) == shared_prefix) {
    original.remove_prefix(shared_prefix.size());
  }
  return names.add(space, kind, original);
}

std::pair<std::string, SourceRange> asmt_text(AsmtImport& import, const AsmtRecord& owner, std::string_view name) {
  const AsmtRecord record = owner.child(name);
  if (!record) return {{}, owner.at()};
  return {std::string(record.value(import.diagnostics)), record.value_at()};
}

void read_asmt_parts(const AsmtRecord& assembly, AsmtImport& import) { PartReader(import).read(assembly); }

}  // namespace ferrers
