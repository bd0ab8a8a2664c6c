#pragma once

#include <gtest/gtest.h>

#include "ferrers/math/machine_memory.h"

/// Skips a test, by name, where the processor runs no code of ours.
#define NEEDS_MACHINE_CODE() \
  if (!ferrers::has_machine_code()) GTEST_SKIP() << "no machine code on this processor"
