#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ferrers/testing/run_probe.h"

/// The benchmarks of the validation page: what is run, what is read off, and what it is compared with.
namespace ferrers::validation {

/// One figure: a column of a run at a time, plus a constant (a benchmark's angle from a joint's, say).
struct Figure {
  std::string name;
  double t = 0;
  std::string column;
  double factor = 1, offset = 0;
  double reference = 0;
  double scale = 1;        ///< Largest magnitude of its vector over the run; 0: taken from the run.
  double allowed = 5e-10;  ///< Of the scale.
};

struct Benchmark {
  std::string id, title, definition, source;
  ModelSpec spec;
  double t_end = 10, every = 0.5;
  std::vector<Figure> figures;
  double energy_scale = 1;   ///< J: what the error of the energy balance is compared with.
  std::string error_column;  ///< Figures of the work-precision table: those of this name.
};

/// A01 to A05 of the IFToMM benchmark library [gonzalez2006] in their variants.
std::vector<Benchmark> iftomm_benchmarks();

}  // namespace ferrers::validation
