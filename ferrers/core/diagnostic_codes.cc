#include "ferrers/core/diagnostics.h"

namespace ferrers {

const std::vector<DiagnosticCode>& diagnostic_codes() {
  // One line per code, sorted by code (tested). The first digit tells what is wrong: F1 the text of a file, F2 a value,
  // F3 the mechanism, F4 a formula.
  static const std::vector<DiagnosticCode> codes = {
      {"F204", "wrong dimension"},
      {"F401", "formula cannot be read"},
      {"F402", "unknown function in a formula"},
      {"F403", "unknown name in a formula"},
      {"F404", "wrong number of arguments"},
      {"F405", "formula too long or too deep"},
      {"F406", "number out of range in a formula"},
      {"F407", "unknown unit in a formula"},
      {"F408", "formula has no finite value"},
  };
  return codes;
}

}  // namespace ferrers
