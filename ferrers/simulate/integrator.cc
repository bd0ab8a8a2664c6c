#include <array>
#include <utility>

#include "ferrers/simulate/simulation.h"
#include "ferrers/simulate/stepper.h"

namespace ferrers {
namespace {

constexpr std::array<std::pair<Integrator, std::string_view>, 5> kIntegrators = {
    {{Integrator::kDormandPrince8, "dormand-prince-8"},
     {Integrator::kDormandPrince5, "dormand-prince-5"},
     {Integrator::kRungeKutta4, "runge-kutta-4"},
     {Integrator::kGeneralizedAlpha, "generalized-alpha"},
     {Integrator::kConstantAcceleration, "constant-acceleration"}}};

}  // namespace

std::string_view to_string(Integrator integrator) {
  for (const auto& [value, name] : kIntegrators) {
    if (value == integrator) return name;
  }
  return "";
}

std::optional<Integrator> find_integrator(std::string_view name) {
  for (const auto& [value, text] : kIntegrators) {
    if (text == name) return value;
  }
  return std::nullopt;
}

std::vector<std::string> integrator_names() {
  std::vector<std::string> names;
  for (const auto& [value, text] : kIntegrators) names.emplace_back(text);
  return names;
}

Integrator integrator_of(const SimulationOptions& options) {
  return options.integrator.value_or(kIntegrators.front().first);
}

std::unique_ptr<Stepper> make_stepper(Integrator integrator, const Evaluator& evaluator, bool fixed) {
  switch (integrator) {
    case Integrator::kDormandPrince8:
      return make_explicit_stepper(evaluator, dormand_prince_8());
    case Integrator::kDormandPrince5:
      return make_explicit_stepper(evaluator, dormand_prince_5());
    case Integrator::kRungeKutta4:
      return make_runge_kutta_4(evaluator, !fixed);
    case Integrator::kGeneralizedAlpha:
      return make_generalized_alpha(evaluator, !fixed);
    case Integrator::kConstantAcceleration:
      break;
  }
  return make_constant_acceleration(evaluator);
}

}  // namespace ferrers
