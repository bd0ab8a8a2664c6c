// Uses the installed library as a stranger would: public headers only. Exit code 0 when the answer is right.

#include <cmath>
#include <cstdio>

#include "ferrers/core/units.h"

int main() {
  const auto unit = ferrers::parse_unit("N*mm");
  if (!unit || unit->dimension != ferrers::kTorque || std::abs(unit->si - 1e-3) > 1e-18) {
    std::puts("parse_unit(\"N*mm\") is not a torque of 1e-3 N*m");
    return 1;
  }
  std::puts("one N*mm is 0.001 N*m");
  return 0;
}
