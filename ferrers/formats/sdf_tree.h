#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ferrers/formats/sdf_file.h"
#include "ferrers/formats/sdf_frames.h"

namespace ferrers {

struct SdfModel {
  int frame = 0;
  int top = 0;  ///< Index of the outermost model that it is in.
  bool is_static = false;
};

struct SdfLink {
  int frame = 0;
  int model = 0;
  std::string path;  ///< "outer::inner::link".
  SdfElement element;
};

struct SdfJoint {
  int frame = 0;
  int scope = 0;
  std::string path;
  bool has_pose = false;
  SdfElement element;
};

/// What a file holds, its included files and inner models taken in: elements by kind, and the frames.
struct SdfTree {
  SdfFrames frames;
  std::vector<SdfModel> models;  ///< Outer before inner.
  std::vector<SdfLink> links;
  std::vector<SdfJoint> joints;
  SdfElement world;         ///< Does not exist where the file holds models only.
  std::string only_moving;  ///< "name::" of the outermost model that is not static, where there is only one.

  /// A path as users read it: without `only_moving`.
  std::string shown(const std::string& path) const {
    return !only_moving.empty() && path.starts_with(only_moving) ? path.substr(only_moving.size()) : path;
  }
};

/// Walks the file from its root. Messages: F202 and F302 about names, F604 to F606 about included files and structure.
/// `ignore_static`: no model is static.
SdfTree read_sdf_tree(const SdfFile& file, SdfLibrary& library, bool ignore_static);

}  // namespace ferrers
