#include "ferrers/dynamics/forward_program.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <utility>

#include "ferrers/math/rank_pivot.h"

namespace ferrers {
namespace {

using Entries = std::unordered_map<long, Traced>;

Entries by_place(const std::vector<TracedEquations::Entry>& entries, long columns, bool symmetric) {
  Entries out;
  out.reserve(2 * entries.size());
  for (const TracedEquations::Entry& entry : entries) {
    out[entry.row * columns + entry.column] = entry.value;
    if (symmetric) out[entry.column * columns + entry.row] = entry.value;
  }
  return out;
}

Traced at(const Entries& entries, long place) {
  const auto found = entries.find(place);
  return found == entries.end() ? Traced() : found->second;
}

}  // namespace

bool ForwardProgram::knows(const DynamicsModel& model) {
  const System& system = *model.system;
  return system.couplings.empty() && system.formulas.empty() && system.topology->general_coordinates == 0 &&
         model.lagrangian.scalars.empty();
}

// By measurement: planar mechanisms gain four times up to here and beyond, tangles of balls nothing from a third of it
// on.
bool ForwardProgram::pays(const SparseKkt& kkt) {
  constexpr long kShort = 30'000, kPerPair = 250;
  return kkt.operations() <= std::max(kShort, kPerPair * static_cast<long>(kkt.pair_rows().size()));
}

bool ForwardProgram::reaches(const State& state) {
  return !(state.q.size() > 0 && state.q.cwiseAbs().maxCoeff() > kFarthestAngle);
}

ForwardProgram::ForwardProgram(const DynamicsModel& model, const SparseKkt& kkt, Extent extent, int states)
    : states_(states), wants_applied_(has_untraced_forces(model) || model.nu() > 0) {
  const System& system = *model.system;
  Trace trace;
  const TracedEquations equations = trace_equations(model, trace);
  const long n = system.nv;
  const std::vector<int> of_coordinate = tags_of_coordinates(system), of_row = tags_of_rows(system);
  KernelTags tags{equations.input_tags, {}};
  const std::vector<Traced> no_force(static_cast<std::size_t>(n)), no_row(static_cast<std::size_t>(system.m));
  std::vector<Traced> force = no_force, gamma = no_row;
  if (wants_applied_) {
    for (std::size_t k = 0; k < force.size(); ++k) {
      force[k] = trace.input(static_cast<int>(tags.inputs.size()));
      tags.inputs.push_back(of_coordinate[k]);
    }
  }
  for (const TracedEquations::Number& one : equations.h) force[static_cast<std::size_t>(one.index)] -= one.value;
  for (const TracedEquations::Number& one : equations.gamma) gamma[static_cast<std::size_t>(one.index)] = one.value;
  const Entries M = by_place(equations.M, n, true), G = by_place(equations.G, n, false);
  const SparseKkt::TracedFactors factors =
      kkt.trace([&](int i, int j) { return at(M, i * n + j); }, [&](int row, int k) { return at(G, row * n + k); });

  // Until the kernel has places, outputs go by their number.
  std::vector<int> outputs;
  const auto add = [&](const Traced& value, int tag) {
    outputs.push_back(trace.value_of(value));
    tags.outputs.push_back(tag);
    return static_cast<int>(outputs.size()) - 1;
  };
  const auto add_motion = [&](const std::vector<Traced>& values, std::vector<int>& to) {
    for (std::size_t k = 0; k < values.size(); ++k) to.push_back(add(values[k], of_coordinate[k]));
  };
  const SparseKkt::TracedSolution solution = kkt.trace(factors, force, gamma);
  Layout& l = layout_;
  l.rows = kkt.pair_rows();
  add_motion(solution.vdot, l.vdot);
  for (std::size_t k = 0; k < l.rows.size(); ++k) {
    l.lambda.push_back(add(solution.lambda[k], of_row[l.rows[k]]));
    l.pivots.push_back(add(factors.pivots[k], of_row[l.rows[k]]));
  }
  for (std::size_t k = 0; k < factors.masses.size(); ++k) {
    l.masses.push_back(add(factors.masses[k], system.nv));
    l.began.push_back(add(factors.began[k], system.nv));
  }
  l.power = add(equations.power, system.nv);
  if (extent == Extent::kClosure) {
    const auto add_way = [&](const std::vector<TracedEquations::Number>& numbers, std::vector<int>& rows,
                             std::vector<int>& places, std::vector<int>& way) {
      std::vector<Traced> back = no_row;
      for (const TracedEquations::Number& one : numbers) {
        rows.push_back(one.index);
        places.push_back(add(one.value, of_row[one.index]));
        back[static_cast<std::size_t>(one.index)] = -one.value;
      }
      add_motion(kkt.trace(factors, no_force, back).vdot, way);
    };
    const auto add_squares = [&](const std::vector<Traced>& squares, std::vector<int>& places) {
      for (const Traced& square : squares) {
        if (!square.is_zero()) places.push_back(add(square, system.nodes[1 + (&square - squares.data())].v));
      }
    };
    add_squares(equations.places, l.places);
    add_squares(equations.speeds, l.speeds);
    add_squares(equations.turns, l.turns);
    add_way(equations.phi, l.phi_rows, l.phi, l.dq);
    add_way(equations.rate, l.rate_rows, l.rate, l.dv);
  }
  kernel_ = states == 1 ? Kernel(trace.graph(), outputs, tags) : Kernel::in_lanes(trace.graph(), outputs, states);
  if (!kernel_.is_native()) return;
  l.power = kernel_.outputs()[l.power];
  for (std::vector<int>* places : {&l.vdot, &l.lambda, &l.pivots, &l.masses, &l.began, &l.phi, &l.rate, &l.dq, &l.dv,
                                   &l.places, &l.speeds, &l.turns}) {
    for (int& place : *places) place = kernel_.outputs()[place];
  }
  int input = 0;
  const int sizes[] = {system.nq, system.nv, system.winding_count, wants_applied_ ? system.nv : 0};
  for (std::size_t part = 0; part < l.inputs.size(); ++part) {
    for (int k = 0; k < sizes[part]; ++k, ++input) {
      const auto index = static_cast<std::size_t>(input);
      const int place = index < kernel_.inputs().size() ? kernel_.inputs()[index] : -1;
      if (place >= 0) l.inputs[part].push_back({place, k});
    }
  }
}

ForwardStatus ForwardProgram::evaluate(const State& state, const VectorXd& applied, Kernel::Board& board,
                                       ForwardResult& out, Watched& watched, Closure* closure) const {
  double* const numbers = board.data();
  const double* const sources[] = {state.q.data(), state.v.data(), state.winding.data(), applied.data()};
  for (std::size_t part = 0; part < layout_.inputs.size(); ++part) {
    for (const Input& input : layout_.inputs[part]) numbers[input.place] = sources[part][input.index];
  }
  kernel_.run(board);

  const auto copy = [numbers](const std::vector<int>& places, VectorXd& to) {
    double* at = to.data();
    for (const int place : places) *at++ = numbers[place];
  };
  const auto scatter = [numbers](const std::vector<int>& places, const std::vector<int>& rows, VectorXd& to) {
    for (std::size_t k = 0; k < places.size(); ++k) to[rows[k]] = numbers[places[k]];
  };
  copy(layout_.vdot, out.vdot);
  scatter(layout_.lambda, layout_.rows, out.lambda);
  watched.power = numbers[layout_.power];
  double smallest = layout_.pivots.empty() ? 1 : INFINITY;
  for (const int place : layout_.pivots) {
    const double pivot = std::abs(numbers[place]);
    smallest = pivot < smallest ? pivot : smallest;
  }
  watched.smallest_pivot = smallest;
  if (closure != nullptr) {
    scatter(layout_.phi, layout_.phi_rows, closure->phi);
    scatter(layout_.rate, layout_.rate_rows, closure->rate);
    copy(layout_.dq, closure->dq);
    copy(layout_.dv, closure->dv);
    const auto largest = [numbers](const std::vector<int>& places) {
      double most = 0;
      for (const int place : places) most = std::max(most, numbers[place]);
      return most;
    };
    closure->place = largest(layout_.places);
    closure->speed = largest(layout_.speeds);
    closure->turn = largest(layout_.turns);
  }
  for (std::size_t k = 0; k < layout_.masses.size(); ++k) {
    if (is_lost_pivot(numbers[layout_.masses[k]], numbers[layout_.began[k]])) {
      return out.status = ForwardStatus::kSingularMass;
    }
  }
  const bool finite = out.vdot.allFinite() && out.lambda.allFinite() && std::isfinite(watched.power);
  return out.status = finite ? ForwardStatus::kSolved : ForwardStatus::kWornSelection;
}

void compute_untraced_forces(const DynamicsModel& model, const State& state, Equations& eq, VectorXd& applied) {
  if (other_forces_read_poses(model)) {
    compute_positions(*model.system, state.q, eq.pos);
    compute_velocities(*model.system, eq.pos, state.q, state.v, eq.vel);
  }
  compute_applied_forces(model, state, eq, ForceElements::kUntraced);
  sum_applied_forces(model, eq, applied);
}

std::shared_ptr<const ForwardProgram> ForwardPrograms::find_or_make(const DynamicsModel& model, const SparseKkt& kkt,
                                                                    ForwardProgram::Extent extent, int states) {
  constexpr std::size_t kMost = 8;
  const std::vector<int> signature = kkt.signature();
  const std::scoped_lock lock(mutex_);
  for (const Known& known : known_) {
    if (known.extent == extent && known.program->states() == states && known.signature == signature)
      return known.program;
  }
  if (known_.size() == kMost) known_.erase(known_.begin());
  known_.push_back({signature, extent, std::make_shared<const ForwardProgram>(model, kkt, extent, states)});
  return known_.back().program;
}

FoundPrograms::FoundPrograms() : programs_(std::make_shared<ForwardPrograms>()) {}
FoundPrograms::FoundPrograms(const FoundPrograms&) : FoundPrograms() {}
FoundPrograms& FoundPrograms::operator=(const FoundPrograms& other) {
  if (this != &other) programs_ = std::make_shared<ForwardPrograms>();
  return *this;
}

}  // namespace ferrers
