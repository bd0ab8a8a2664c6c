#pragma once

#include <CLI/App.hpp>
#include <functional>

/// One function per verb: it adds the verb with its options to the command and, when the verb is called, sets `job` to
/// what has to be done. The job returns the exit code.
using Job = std::function<int()>;

void add_analyze(CLI::App& command, Job& job);
void add_inverse(CLI::App& command, Job& job);
void add_simulate(CLI::App& command, Job& job);
void add_sweep(CLI::App& command, Job& job);
void add_kinematics(CLI::App& command, Job& job);
void add_equilibrium(CLI::App& command, Job& job);
void add_linearize(CLI::App& command, Job& job);
void add_equations(CLI::App& command, Job& job);
void add_schema(CLI::App& command, Job& job);
void add_convert(CLI::App& command, Job& job);
void add_new(CLI::App& command, Job& job);
void add_doctor(CLI::App& command, Job& job);
