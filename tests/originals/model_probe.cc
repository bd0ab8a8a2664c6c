// What Ferrers makes of a model file, in numbers, for comparison with the program whose file it is
// (compare_*.py beside this file).
//
//   model_probe FILE [--base fixed|free] [--ignore armature,springs,damping] [--closures FILE]
//     [--revolute-rows merge|keep] < states.json
//
// Reads {"states": [{"positions": {"joint": [...]}, "velocities": {"joint": [...]}}]}; joints that are left out stay as
// drawn. Prints per body its mass properties, and per state the poses of the bodies, M, h (with tau: what joints'
// springs, dampers and friction contribute on the right side), G, gamma and phi. Joints of a loop that are cut have no
// coordinates and cannot be given. Exit codes: 0; 3 the file has errors, printed to stderr; 64 wrong use.

#include <fmt/format.h>

#include <cstdio>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

#include "ferrers/dynamics/equations.h"
#include "ferrers/formats/formats.h"

namespace {

using namespace ferrers;  // NOLINT(google-build-using-namespace): a program, not a header
using Json = nlohmann::ordered_json;

template <class Derived>
Json json_of(const Eigen::MatrixBase<Derived>& matrix) {
  Json rows = Json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    Json row = Json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(matrix.cols() == 1 ? row[0] : row);
  }
  return rows;
}

std::vector<int> all(Eigen::Index count) {
  std::vector<int> list(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < list.size(); ++i) list[i] = static_cast<int>(i);
  return list;
}

/// Puts the numbers of each joint into its place of q or v.
void take(const System& system, const Json& joints, bool velocities, VectorXd& out) {
  for (const auto& [name, numbers] : joints.items()) {
    const std::optional<JointId> id = system.model->find_joint(name);
    if (!id) throw std::invalid_argument("no joint '" + name + "'");
    const int index = system.topology->node_of_joint.at(static_cast<std::size_t>(id->index()));
    if (index < 0) throw std::invalid_argument("joint '" + name + "' is cut");
    const Node& node = system.nodes.at(static_cast<std::size_t>(index));
    const int first = velocities ? node.v : node.q, count = velocities ? node.nv : node.nq;
    if (static_cast<int>(numbers.size()) != count) throw std::invalid_argument("wrong count for '" + name + "'");
    for (int i = 0; i < count; ++i) out[first + i] = numbers[i].get<double>();
  }
}

Json bodies_of(const Model& model) {
  Json bodies = Json::object();
  for (const Body& body : model.bodies()) {
    bodies[body.name] = {{"has_mass", body.has_mass},
                         {"mass", body.mass_kg},
                         {"com", json_of(body.com_m)},
                         {"inertia", json_of(body.inertia_kgm2)}};
  }
  return bodies;
}

Json poses_of(const System& system, const PositionKinematics& pos) {
  Json poses = Json::object();
  for (int i = 0; i < system.body_nodes; ++i) {
    const Node& node = system.nodes[static_cast<std::size_t>(i)];
    const auto& place = pos.nodes[static_cast<std::size_t>(i)];
    const Pose X_WB = Pose(place.R, place.p) * node.X_BN.inverse();
    poses[system.model->body(node.body).name] = {{"position", json_of(X_WB.p)}, {"rotation", json_of(X_WB.R)}};
  }
  return poses;
}

Json evaluate(const DynamicsModel& dynamics, const System& system, const Json& given) {
  State state = make_drawn_state(system);
  if (given.contains("positions")) take(system, given["positions"], false, state.q);
  if (given.contains("velocities")) take(system, given["velocities"], true, state.v);
  Equations eq = make_equations(dynamics);
  compute_equations(dynamics, state, eq);
  return {{"bodies", poses_of(system, eq.pos)},
          {"M", json_of(eq.M.dense_rows(all(system.nv)))},
          {"h", json_of(eq.h)},
          {"tau", json_of(eq.tau)},
          {"G", json_of(eq.constraints.G.dense_rows(all(system.m)))},
          {"gamma", json_of(eq.constraints.gamma)},
          {"phi", json_of(eq.constraints.phi)}};
}

bool read_options(int argc, char** argv, ImportOptions& import) {
  for (int i = 2; i + 1 < argc; i += 2) {
    const std::string option = argv[i], value = argv[i + 1];
    if (option == "--base") {
      import.base = value == "free" ? ImportBase::kFree : ImportBase::kFixed;
    } else if (option == "--ignore") {
      import.ignore_armature = value.find("armature") != std::string::npos;
      import.ignore_springs = value.find("springs") != std::string::npos;
      import.ignore_damping = value.find("damping") != std::string::npos;
    } else if (option == "--revolute-rows") {
      import.merge_revolute_rows = value == "merge";
    } else if (option == "--closures") {
      import.closures = value;
    } else {
      return false;
    }
  }
  return argc >= 2 && argc % 2 == 0;
}

}  // namespace

int main(int argc, char** argv) {
  ImportOptions import;
  import.keep_welds = true;  // the other program has all parts
  if (!read_options(argc, argv, import)) {
    std::cerr << "usage: model_probe FILE [--base fixed|free] [--ignore LIST] [--closures FILE] < states.json\n";
    return 64;
  }
  try {
    const ModelFile file = read_any_model_file(argv[1], {}, import);
    for (const Diagnostic& one : file.read.diagnostics.items()) {
      if (one.severity == Severity::kError) std::cerr << format_diagnostic(one, argv[1], file.read.source) << "\n";
    }
    if (!file.read.model) return 3;
    const auto system = make_system(*file.read.model);
    const auto dynamics = make_dynamics_model(system);
    const Json asked = Json::parse(std::string(std::istreambuf_iterator<char>(std::cin), {}));
    Json states = Json::array();
    for (const Json& state : asked.at("states")) states.push_back(evaluate(*dynamics, *system, state));
    const Json out = {{"bodies", bodies_of(*system->model)},
                      {"velocities", system->coordinate_names},
                      {"rows", system->row_names},
                      {"states", std::move(states)}};
    std::cout << out.dump() << "\n";
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "model_probe: " << error.what() << "\n";
    return 64;
  }
}
