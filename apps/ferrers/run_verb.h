#pragma once

#include <CLI/App.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ferrers/simulate/simulation.h"
#include "model_input.h"

/// The part that simulate, inverse and kinematics share: the folder, the interruption, the summary, the exit code.

struct RunOptions {
  ModelOptions model;
  std::string folder;  ///< Empty: out/MODELNAME-VERB.
  ferrers::OutputGrid grid;
  ferrers::ReactionAxes axes = ferrers::ReactionAxes::kWorld;
  ferrers::DistributionOptions distribution;
};

/// The model's options, -o, --end, --every; where the verb computes reactions their axes and distribution.
void add_run_options(CLI::App& verb, RunOptions& options, bool with_reactions);

/// `--reactions` and `--distribute`, wherever reactions are told.
void add_reaction_options(CLI::App& verb, ferrers::ReactionAxes& axes, ferrers::DistributionOptions& distribution);

/// A finite number above zero, or from zero on.
CLI::Validator positive_number();
CLI::Validator number_from_zero();
/// One of some names; says which one was meant.
CLI::Validator one_of(std::vector<std::string> names);

struct RunTask {
  std::string verb;
  bool needs_masses = true;
  bool with_reactions = true;
  std::function<ferrers::RunSummary(std::shared_ptr<const ferrers::DynamicsModel>, const ferrers::RunControl&)> run;
};

/// Reads the model, runs the task into its folder, tells the result. Returns the exit code.
int execute(const RunTask& task, const RunOptions& options);
