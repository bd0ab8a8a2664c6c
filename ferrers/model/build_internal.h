#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "ferrers/model/joints/joint_type.h"
#include "ferrers/model/model.h"

namespace ferrers {

/// What a message is about: a key of a named thing, and where that thing stands.
struct Field {
  std::string_view key;
  const NameRef& owner;
};

/// Two different bodies that a joint or force element connects, with the names that its places may use.
struct BodyPair {
  const NameRef& owner;
  std::array<BodyId, 2> bodies;
  const std::array<NameRef, 2>& names;
};

/// A point or unit direction as the first and as the second body see it, in the world as drawn.
using OnBoth = std::array<Vector3d, 2>;

/// A formula of time and state: parameters are numbers, `names[i]` is what it calls `inputs[i]`.
struct StateFormula {
  Expression expression;
  Expression symbolic;  ///< The same with parameters by their names.
  std::vector<std::string> names;
  std::vector<LawInput> inputs;
};

/// A weld that makes its bodies one: X_12 is the second body's frame in the first's.
struct GroupWeld {
  const JointSpec* spec = nullptr;
  std::array<int, 2> bodies = {0, 0};
  Pose X_12;
};

/// Where a body of the file went: the first of its rigid group, and its frame in that one's.
struct GroupPlace {
  int first = 0;
  Pose X_BP;
};

/// Positions of the names of one kind in their list.
using NameIndex = std::unordered_map<std::string, int>;

/// Makes a `Model` of a specification, in one pass per section, collecting diagnostics.
///
/// Errors do not stop the pass: a number that cannot be had is NaN and everything that follows from it stays silent,
/// so every message is about a cause. Bodies and joints keep the positions that they have in the specification, less
/// the welds that are merged; bodies become rigid groups at the end.
class ModelAssembler {
 public:
  ModelAssembler(std::shared_ptr<const ModelSpec> spec, std::map<std::string, double> overrides);
  ModelBuildResult build();

 private:
  // build_parameters.cc
  void build_parameters();
  void check_overrides();
  std::vector<int> parameter_order(const std::vector<std::vector<int>>& uses);
  std::vector<std::vector<int>> parameter_uses();
  void report_cycle(const std::vector<std::vector<int>>& uses, const std::vector<bool>& done);
  void evaluate_parameter(int index);
  void check_parameter_bounds(int index);
  double number(const Number& n, std::optional<Dimension> wanted, Field field);
  double any_number(const Number& n, std::optional<Dimension> wanted, Field field);
  double number_at_least_zero(const Number& n, std::optional<Dimension> wanted, Field field);
  double evaluate(const Expression& expression, Field field);
  void check_dimension(const Expression& expression, std::optional<Dimension> wanted, Field field);
  void report_unknown_name(const ExpressionName& name, Field field);
  std::optional<Dimension> parameter_dimension(std::string_view name) const;
  Vector3d vector(const Number3& n, std::optional<Dimension> wanted, Field field);

  // build_names.cc
  void index_names();
  void check_name(const NameRef& name, std::string_view kind);
  bool add_name(NameIndex& index, const NameRef& name, int position, std::string_view kind);
  std::optional<int> find(const NameIndex& index, const NameRef& name, std::string_view kind, Field field,
                          std::string_view code);
  std::optional<BodyId> find_body(const NameRef& name, Field field);
  std::optional<JointId> find_joint(const NameRef& name, Field field);
  std::optional<JointCoordinate> find_coordinate(const CoordinateRef& ref, Field field);
  std::optional<BodyPair> find_pair(const std::array<NameRef, 2>& names, const NameRef& owner);

  // build_bodies.cc
  void build_bodies();
  void build_body(const BodySpec& spec, Body& body);
  void build_mass(const BodySpec& spec, Body& body);
  void place_mass_centre(const BodySpec& spec, Body& body);
  Matrix3d shape_inertia(const BodySpec& spec, double mass_kg);
  Matrix3d spanned_inertia(const BodySpec& spec, double mass_kg);
  void check_physical(const BodySpec& spec, const Body& body);
  Pose pose(const PoseSpec& spec, const NameRef& owner);
  Matrix3d rotation(const RotationSpec& spec, const NameRef& owner);
  void check_bodies_have_joints();

  // build_groups.cc
  void merge_welded_parts();
  std::vector<GroupWeld> place_merged_welds();
  void follow_welds(const std::vector<GroupWeld>& welds);
  std::vector<GroupWeld> welds_outside_loops(const std::vector<GroupWeld>& welds);
  void leave_out(const std::vector<GroupWeld>& welds);
  void put_groups_together();
  Body group_of(const std::vector<int>& members);

  // build_places.cc
  std::optional<Vector3d> direction(const Number3& n, Field field);
  std::array<const Number3*, 2> on_bodies(const PlaceSpec& place, Field field, const BodyPair& pair,
                                          std::array<bool, 2> needed);
  std::optional<OnBoth> points_on_both(const PlaceSpec& place, Field field, const BodyPair& pair);
  std::optional<OnBoth> directions_on_both(const PlaceSpec& place, Field field, const BodyPair& pair);
  std::optional<Vector3d> direction_on(int which, const PlaceSpec& place, Field field, const BodyPair& pair);
  std::optional<Matrix3d> frame_on_first(const Vector3d& z, const std::optional<Number3>& x, const NameRef& owner);

  // build_joints.cc
  void build_joints();
  void build_joint(const JointSpec& spec, Joint& joint);
  void place_joint(const JointSpec& spec, const BodyPair& pair, Joint& joint);
  void place_by_frames(const JointSpec& spec, Joint& joint);
  void read_lead(const JointSpec& spec, Joint& joint);
  void place_at_point(const JointSpec& spec, const BodyPair& pair, Joint& joint);
  void place_on_axis(const JointSpec& spec, const BodyPair& pair, std::string_view key, Joint& joint);
  void place_on_two_axes(const JointSpec& spec, const BodyPair& pair, Joint& joint);
  void place_between_points(const JointSpec& spec, const BodyPair& pair, Joint& joint);
  void place_free(const JointSpec& spec, const BodyPair& pair, Joint& joint);
  void set_frames(Joint& joint, const Pose& X_WF, const Pose& X_WM) const;
  void build_joint_extras(const JointSpec& spec, Joint& joint);
  Vector6d stiffness(const StiffnessSpec& spec, const NameRef& owner);
  void build_limits(const JointSpec& spec, Joint& joint);
  Friction friction(const FrictionSpec& spec, const Joint& joint, const NameRef& owner);

  // build_meshes.cc
  struct Line {
    Vector3d point, direction;  ///< In the world; a unit direction.
    BodyId other;               ///< The body on the other side of the joint that gave the line.
  };
  struct Mesh {
    Vector3d pitch_point, line_of_action;
    std::optional<Vector3d> axis;
    std::array<std::optional<Vector3d>, 2> centers;
  };
  void build_meshes();
  void build_mesh(const JointSpec& spec, Joint& joint);
  void find_welded_bodies();
  std::vector<Line> lines_of(BodyId body) const;
  std::vector<Line> candidate_lines(BodyId body, BodyId partner, const Mesh& mesh) const;
  void derive_mesh(const Joint& joint, Mesh& mesh) const;
  bool mesh_is_regular(const JointSpec& spec, const Mesh& mesh);
  void set_mesh(const Mesh& mesh, Joint& joint) const;
  void set_mesh_as_drawn(const Mesh& mesh, Joint& joint) const;

  // build_laws.cc
  enum class LawScope { kOfTime, kOfState };
  std::optional<Law> law(const LawSpec& spec, LawScope scope, std::optional<Dimension> wanted, Field field);
  std::optional<Law> formula(const Expression& expression, LawScope scope, std::optional<Dimension> wanted,
                             Field field);
  std::optional<Law> sampled(const LawSpec& spec, Field field);
  std::optional<LawInput> law_input(const ExpressionName& name, LawScope scope, Field field);
  std::optional<LawInput> dotted_input(const ExpressionName& name, std::size_t dot, Field field);

  // build_formulas.cc
  void build_coordinates();
  std::optional<StateFormula> state_formula(const Expression& expression, LawScope scope,
                                            std::optional<Dimension> wanted, Field field);
  void build_constraints();
  std::optional<Expression> energy_of_mass_matrix();
  void build_function_system();
  void build_lagrangian();
  bool place_drive_by_formula(const DriveSpec& spec, Drive& drive);
  void build_motions();

  // build_forces.cc
  void build_couplings();
  void build_forces();
  void build_element(const ForceSpec& force, const SpringSpec& spec);
  void build_element(const ForceSpec& force, const TorsionSpringSpec& spec);
  void build_element(const ForceSpec& force, const JointDampingSpec& spec);
  void build_element(const ForceSpec& force, const BushingSpec& spec);
  void build_element(const ForceSpec& force, const LoadSpec& spec);
  Dimension effort_dimension(JointCoordinate coordinate) const;
  Dimension position_dimension(JointCoordinate coordinate) const;
  const CoordinateInfo& coordinate_info(JointCoordinate coordinate) const;

  // build_drives.cc
  void build_drives();
  void build_drive(const DriveSpec& spec);
  bool place_drive(const DriveSpec& spec, Drive& drive);
  bool place_drive_between_points(const DriveSpec& spec, Drive& drive);
  std::vector<Law> drive_laws(const std::vector<LawSpec>& specs, LawScope scope, std::optional<Dimension> wanted,
                              const Drive& drive, Field field);
  void build_initial();
  void build_initial_value(const InitialSpec& spec);
  std::vector<double> initial_numbers(const std::vector<Number>& numbers, std::size_t wanted, Field field);
  void build_records();
  void build_recorded_formulas();
  void build_events();

  const Body& body(BodyId id) const { return model_.bodies_[static_cast<std::size_t>(id.index())]; }
  const Joint& joint(JointId id) const { return model_.joints_[static_cast<std::size_t>(id.index())]; }

  std::shared_ptr<const ModelSpec> whole_spec_;  ///< As given.
  std::shared_ptr<const ModelSpec> spec_;        ///< Without the welds that were merged.
  std::map<std::string, double> overrides_;
  Diagnostics diagnostics_;
  Model model_;
  NameIndex parameter_index_, body_index_, joint_index_, record_index_, drive_index_;
  std::vector<bool> has_mass_centre_;  ///< Per body.
  std::vector<bool> joint_is_placed_;  ///< Per joint: its bodies and frames are known.
  std::vector<InitialValue> coordinate_guesses_;
  std::vector<GroupPlace> groups_;                        ///< Per body of the file; empty where nothing is merged.
  std::map<int, std::vector<std::string>> merged_welds_;  ///< By the first body of their group.
  std::vector<int> welded_to_;  ///< Per body: representative of the bodies it is welded to (0: ground).
};

/// The place to report: the number's own, else its owner's.
SourceRange place_of(const Number& n, Field field);
SourceRange place_or(SourceRange at, const NameRef& owner);

}  // namespace ferrers
