// Uses the installed library as a stranger would: public headers only. Builds a planar four-bar linkage out of spatial
// revolute joints, whose 20 rows hold 3 redundant ones, and asks how it moves. Exit code 0 when the answer is right.

#include <array>
#include <cstdio>
#include <string>
#include <utility>

#include "ferrers/kinematics/assembly.h"
#include "ferrers/kinematics/system.h"
#include "ferrers/model/model.h"
#include "ferrers/model/spec.h"
#include "ferrers/redundancy/analysis.h"

namespace {

ferrers::BodySpec bar(const char* name, ferrers::Number3 from, ferrers::Number3 to) {
  ferrers::BodySpec body;
  body.name = name;
  body.mass = 1.0;
  body.inertia.kind = ferrers::InertiaSpec::Kind::kRod;
  body.inertia.from = std::move(from);
  body.inertia.to = std::move(to);
  return body;
}

ferrers::JointSpec pin(const char* name, const char* first, const char* second, ferrers::Number3 at) {
  ferrers::JointSpec joint;
  joint.name = name;
  joint.type = ferrers::JointType::kRevolute;
  joint.bodies = {ferrers::NameRef(first), ferrers::NameRef(second)};
  joint.place.drawn = std::move(at);
  joint.axis.drawn = ferrers::number3(0, 0, 1);
  return joint;
}

ferrers::ModelSpec four_bar() {
  const auto a = ferrers::number3(0, 0, 0), b = ferrers::number3(0.3, 0.9, 0);
  const auto c = ferrers::number3(2, 1.5, 0), d = ferrers::number3(1.8, 0, 0);
  ferrers::ModelSpec spec;
  spec.name = "four-bar";
  spec.bodies = {bar("crank", a, b), bar("coupler", b, c), bar("rocker", c, d)};
  spec.joints = {pin("A", "ground", "crank", a), pin("B", "crank", "coupler", b), pin("C", "coupler", "rocker", c),
                 pin("D", "rocker", "ground", d)};
  return spec;
}

}  // namespace

int main() {
  ferrers::ModelBuildResult built = ferrers::build_model(four_bar());
  for (const ferrers::Diagnostic& diagnostic : built.diagnostics.items()) std::puts(diagnostic.message.c_str());
  if (!built.model) return 1;
  const auto system = ferrers::make_system(std::move(*built.model));
  const ferrers::AssemblyResult assembly = ferrers::assemble(*system);
  if (assembly.status != ferrers::AssemblyStatus::kAssembled) return 1;
  const ferrers::RedundancyReport report = ferrers::analyze_redundancy(*system, assembly.state);
  std::printf("%d rows, rank %d, mobility %d, redundant %d\n", report.constraint_rows, report.rank, report.mobility,
              report.redundant);
  return report.constraint_rows == 20 && report.rank == 17 && report.mobility == 1 && report.redundant == 3 ? 0 : 1;
}
