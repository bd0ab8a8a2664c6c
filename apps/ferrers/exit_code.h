#pragma once

/// What a finished command tells its caller; the same for every verb.
enum ExitCode : int {
  kExitDone = 0,
  kExitCheckFailed = 1,   ///< It ran, but a comparison that was asked for failed.
  kExitCommandLine = 2,   ///< The command line is wrong, or a file named on it cannot be written.
  kExitModel = 3,         ///< The model has errors, or is not fit for what was asked.
  kExitNotAssembled = 4,  ///< The mechanism cannot be assembled, or its initial values contradict each other.
  kExitSolve = 5,         ///< The integration or a solve failed; what was computed is kept.
  kExitVariants = 6,      ///< A sweep went to its end, but some variants failed; their rows tell why.
  kExitOurBug = 70,
  kExitInterrupted = 130,  ///< What was finished is kept.
};
