#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "ferrers/formats/asmt_document.h"
#include "ferrers/formats/asmt_geometry.h"
#include "ferrers/formats/imported_model.h"
#include "ferrers/formats/name_map.h"

namespace ferrers {

/// A frame on a part, or on the assembly itself.
struct AsmtMarker {
  int part = -1;  ///< -1: the assembly, which does not move.
  Pose X_PM;      ///< In the part's frame; of the assembly: in the world.
  SourceRange at;
};

/// What all readers of parts of one ASMT file share: the specification that they fill, and what they found.
struct AsmtImport {
  AsmtImport(const ImportContext& given, double per_metre)
      : context(given), diagnostics(given.diagnostics), geometry(per_metre, given.diagnostics) {}

  const ImportContext& context;
  Diagnostics& diagnostics;
  AsmtGeometry geometry;
  ModelSpec spec;
  NameMap names;

  std::string assembly;            ///< Its name in the file.
  std::string shared_prefix;       ///< "Document#", where every name of the file that has a '#' starts so.
  std::vector<std::string> parts;  ///< Names of the bodies, by part.
  std::vector<Pose> poses;         ///< Of the parts in the world, as stored.
  std::unordered_map<std::string, std::vector<AsmtMarker>> markers;  ///< By "/assembly/part/marker".

  /// The marker that `owner`'s record `which` names; nothing, with an error (F202, F604), where there is none or
  /// several.
  const AsmtMarker* marker(const AsmtRecord& owner, std::string_view which);

  std::string body(const AsmtMarker& marker) const;
  /// In the world, as stored.
  Pose world(const AsmtMarker& marker) const;
  /// A new thing's name, by its name in the file without the document's.
  std::string add_name(std::string_view space, std::string_view kind, std::string_view original);
};

/// The value of `owner`'s record `name`, with its place; empty where there is no such record or value.
std::pair<std::string, SourceRange> asmt_text(AsmtImport& import, const AsmtRecord& owner, std::string_view name);

/// Reads the assembly's own frame and markers, and its parts with theirs.
void read_asmt_parts(const AsmtRecord& assembly, AsmtImport& import);

}  // namespace ferrers
