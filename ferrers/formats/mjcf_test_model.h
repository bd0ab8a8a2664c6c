#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "ferrers/formats/formats.h"
#include "ferrers/formats/mjcf.h"
#include "ferrers/kinematics/motion.h"

/// What the tests of the MJCF reader share.
namespace ferrers::mjcf_testing {

struct ReadText {
  ImportedModel model;
  Diagnostics diagnostics;
};

using Files = std::map<std::string, std::string>;

inline FileLoader loader_of(Files files) {
  return [files = std::move(files)](const std::string& path) -> std::optional<std::string> {
    const auto found = files.find(path);
    return found == files.end() ? std::nullopt : std::optional(found->second);
  };
}

inline ReadText read_text(const std::string& text, const ImportOptions& options = {}, Files files = {}) {
  ReadText out;
  const FileLoader load = loader_of(std::move(files));
  out.model = read_mjcf(text, {options, load, out.diagnostics});
  return out;
}

/// `code:line:column` of every diagnostic.
inline std::vector<std::string> places(const Diagnostics& diagnostics) {
  std::vector<std::string> all;
  for (const Diagnostic& one : diagnostics.items()) {
    all.push_back(one.code + ":" + std::to_string(one.at.line) + ":" + std::to_string(one.at.column));
  }
  return all;
}

inline std::string messages(const Diagnostics& diagnostics) {
  std::string all;
  for (const Diagnostic& one : diagnostics.items()) all += one.code + " " + one.message + "\n";
  return all;
}

/// The mechanism of a text that must be good.
inline Model build(const std::string& text, const ImportOptions& options = {}, Files files = {}) {
  ModelFile file = read_any_model_text(text, "model.xml", ModelFormat::kMjcf, loader_of(std::move(files)), {}, options);
  if (!file.read.model) throw std::runtime_error(messages(file.read.diagnostics));
  return std::move(*file.read.model);
}

inline const BodySpec& body_of(const ModelSpec& spec, const std::string& name) {
  for (const BodySpec& body : spec.bodies) {
    if (body.name.name == name) return body;
  }
  throw std::out_of_range("no body " + name);
}

inline const JointSpec& joint_of(const ModelSpec& spec, const std::string& name) {
  for (const JointSpec& joint : spec.joints) {
    if (joint.name.name == name) return joint;
  }
  throw std::out_of_range("no joint " + name);
}

inline std::array<double, 3> values(const Number3& numbers) {
  return {numbers[0].value, numbers[1].value, numbers[2].value};
}

/// Pose of a body at coordinates by joint; the other joints stay as drawn.
inline Pose pose_at(const Model& model, const std::map<std::string, std::vector<double>>& positions,
                    const std::string& body) {
  const auto system = make_system(model);
  State state = make_drawn_state(*system);
  for (const auto& [name, numbers] : positions) {
    const int at = system->topology->node_of_joint[system->model->find_joint(name)->index()];
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      state.q[system->nodes[static_cast<std::size_t>(at)].q + static_cast<int>(i)] = numbers[i];
    }
  }
  PositionKinematics pos = make_position_kinematics(*system);
  compute_positions(*system, state.q, pos);
  return body_pose(*system, pos, *system->model->find_body(body));
}

inline ::testing::AssertionResult same(const Pose& a, const Pose& b) {
  const double difference = std::max((a.R - b.R).cwiseAbs().maxCoeff(), (a.p - b.p).cwiseAbs().maxCoeff());
  if (difference < 1e-12) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "off by " << difference << "\n" << a.R << "\n" << a.p.transpose();
}

}  // namespace ferrers::mjcf_testing
