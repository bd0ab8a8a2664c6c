#include "ferrers/redundancy/rank_notice.h"

namespace ferrers {

std::string doubtful_rank_notice(double t, const RankDecision& decision) {
  if (decision.confident) return "";
  return "the rank at t = " + std::to_string(t) + " s is in doubt: " + std::to_string(decision.rank) + " or " +
         std::to_string(decision.other_rank);
}

}  // namespace ferrers
