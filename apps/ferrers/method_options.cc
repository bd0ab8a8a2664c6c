#include "method_options.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <vector>

#include "run_verb.h"

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

std::vector<std::string> formulation_names() {
  std::vector<std::string> names;
  for (const Formulation one : kFormulations) names.emplace_back(to_string(one));
  return names;
}

}  // namespace

void add_method_options(CLI::App& verb, SimulationOptions& options) {
  verb.add_option_function<std::string>(
          "--integrator",
          [&options](const std::string& name) {
            if (const auto found = find_integrator(name)) options.integrator = *found;
          },
          fmt::format("{} [the first]", fmt::join(integrator_names(), ", ")))
      ->type_name("NAME")
      ->check(one_of(integrator_names()));
  verb.add_option_function<double>(
          "--step", [&options](const double& value) { options.step = value; }, "fixed step, s")
      ->type_name("DT")
      ->check(positive_number());
  verb.add_option_function<double>(
          "--tolerance", [&options](const double& value) { options.tolerance = value; },
          "what positions may be off by, rad or characteristic lengths, with steps that adapt [1e-9]; not with --step")
      ->type_name("TOL")
      ->check(positive_number());
  verb.add_option_function<std::string>(
          "--formulation", [&options](const std::string& name) { options.formulation = find_formulation(name); },
          fmt::format("{} [{}]", fmt::join(formulation_names(), ", "), to_string(recommended_formulation())))
      ->type_name("NAME")
      ->check(one_of(formulation_names()));
  verb.add_flag("--driven", options.driven, "drives with a motion law follow it, the others act by their effort");
}

std::string find_fault(const SimulationOptions& options) {
  if (options.step && options.tolerance) return "--step fixes the step, --tolerance adapts it: take one of them";
  return "";
}
