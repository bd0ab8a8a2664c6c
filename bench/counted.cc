// What bench/counts.py counts the instructions of: so many evaluations of one mechanism, and nothing else that depends
// on their number.
//
//   ferrers_counted four_bar native 1000

#include <fmt/format.h>

#include <cstdio>
#include <functional>
#include <map>
#include <string>

#include "ferrers/dynamics/forward_dynamics.h"
#include "ferrers/testing/engine_probe.h"
#include "ferrers/testing/zoo.h"

namespace {

using namespace ferrers;           // NOLINT(google-build-using-namespace): a program, not a header
using namespace ferrers::witness;  // NOLINT(google-build-using-namespace)

const std::map<std::string, std::function<ModelSpec()>> kMechanisms = {
    {"four_bar", [] { return make_four_bar(FourBarJoints::kRevolute); }},
    {"bricard", [] { return make_bricard(BricardRods::kBricks); }},
    {"three_cranks", [] { return make_parallel_cranks(); }},
    {"andrews", [] { return make_andrews(); }},
    {"a02_n10", [] { return make_n_four_bar(10, 0.3); }},
    {"a02_n100", [] { return make_n_four_bar(100, 0.3); }},
};

int count_parts(EngineProbe& engine, const State& state, int evaluations) {
  engine.evaluate(state);
  const auto solver = make_forward_solver(Formulation::kSparse, *engine.system, engine.selection);
  ForwardResult result = make_forward_result(engine.eq);
  for (int i = 0; i < evaluations; ++i) {
    compute_equations(*engine.dynamics, state, engine.eq);
    solver->solve(engine.eq, result);
  }
  return result.status == ForwardStatus::kSolved ? 0 : 1;
}

int count_native(const EngineProbe& engine, const State& state, int evaluations) {
  ForwardDynamics dynamics(engine.dynamics, state);
  if (!dynamics.is_native()) return 2;
  for (int i = 0; i < evaluations; ++i) dynamics.evaluate(state);
  return dynamics.result().status == ForwardStatus::kSolved ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  const auto mechanism = argc == 4 ? kMechanisms.find(argv[1]) : kMechanisms.end();
  const std::string what = argc == 4 ? argv[2] : "";
  if (mechanism == kMechanisms.end() || (what != "native" && what != "parts")) {
    std::fputs("usage: ferrers_counted MECHANISM native|parts EVALUATIONS; mechanisms:", stderr);
    for (const auto& [name, make] : kMechanisms) std::fputs(fmt::format(" {}", name).c_str(), stderr);
    std::fputs("\n", stderr);
    return 64;
  }
  EngineProbe engine(mechanism->second());
  const State state = engine.start();
  const int evaluations = std::stoi(argv[3]);
  return what == "native" ? count_native(engine, state, evaluations) : count_parts(engine, state, evaluations);
}
