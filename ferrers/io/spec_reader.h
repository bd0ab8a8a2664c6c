#pragma once

#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "ferrers/io/document.h"
#include "ferrers/io/object_reader.h"
#include "ferrers/io/value_reader.h"
#include "ferrers/model/spec.h"

namespace ferrers {

/// A named thing of the file in which the reader found errors: what model building says about it may be mere
/// consequence.
struct FaultyEntry {
  SourceRange name_at;
  int end_line = 0, end_column = 0;  ///< Of its last value.
  bool contains(SourceRange at) const;
};

/// What the reader could not find out; messages that would only follow from it are not worth giving.
struct ReaderFaults {
  std::vector<FaultyEntry> entries;
  std::set<std::string> joints_without_type;
  bool joint_without_bodies = false;
  bool section_without_entries = false;  ///< A whole section could not be read.
};

/// Fills a `ModelSpec` from a document, section by section, by the table of fields. Everything named in the file is in
/// the specification, also where it is faulty, so that references to it are right.
class SpecReader {
 public:
  explicit SpecReader(ValueReader& values) : values_(values) {}
  ModelSpec read(const DocumentNode& root, const std::string& default_name);
  const ReaderFaults& faults() const { return faults_; }

 private:
  using EntryReader = void (SpecReader::*)(const DocumentNode& node, const NameRef& name);
  void read_section(ObjectReader& model, std::string_view key, EntryReader read_entry);
  void mark_faulty(const DocumentEntry& entry);

  // spec_reader.cc
  void read_parameter(const DocumentNode& node, const NameRef& name);
  void read_body(const DocumentNode& node, const NameRef& name);
  InertiaSpec read_inertia(const DocumentNode& node);
  PoseSpec read_pose(const DocumentNode& node);
  std::optional<std::array<PoseSpec, 2>> read_frames(const DocumentNode& node);
  std::optional<RotationSpec> read_rotation(const DocumentNode& node);

  // spec_reader_joints.cc
  void read_joint(const DocumentNode& node, const NameRef& name);
  void read_joint_without_type(const DocumentNode& node, JointSpec& joint);
  void read_placement(ObjectReader& object, JointSpec& joint);
  void read_joint_extras(ObjectReader& object, JointSpec& joint);
  void read_coupling(const DocumentNode& node, const NameRef& name);
  CoordinateDimensions dimensions_of(const JointSpec& joint) const;
  CoordinateDimensions dimensions_of(const CoordinateRef& ref) const;

  // spec_reader_formulas.cc
  void read_lagrangian(const DocumentNode& node);
  void read_general_coordinate(const DocumentNode& node, const NameRef& name);
  void read_constraint(const DocumentNode& node, const NameRef& name);

  // spec_reader_actions.cc
  void read_force(const DocumentNode& node, const NameRef& name);
  bool read_spring(ObjectReader& object, ForceSpec& force);
  bool read_torsion_spring(ObjectReader& object, ForceSpec& force);
  bool read_joint_damping(ObjectReader& object, ForceSpec& force);
  bool read_bushing(ObjectReader& object, ForceSpec& force);
  bool read_load(ObjectReader& object, ForceSpec& force, std::string_view law_key);
  std::optional<CoordinateRef> read_coordinate(ObjectReader& object);
  void read_drive(const DocumentNode& node, const NameRef& name);
  void read_initial(const DocumentNode& node, const NameRef& name);
  void read_initial_value(const DocumentNode& node, const NameRef& name);
  void read_record(const DocumentNode& node, const NameRef& name);
  void read_event(const DocumentNode& node, const NameRef& name);

  ValueReader& values_;
  ModelSpec spec_;
  ReaderFaults faults_;
  std::unordered_map<std::string, std::size_t> joint_index_;
};

}  // namespace ferrers
