#include "ferrers/dynamics/law_notices.h"

#include <fmt/format.h>

namespace ferrers {

std::vector<std::string> describe_sampled_laws(const Model& model, LawUse use, double t_begin, double t_end) {
  static constexpr const char* kAxes[] = {".x", ".y", ".z"};
  std::vector<std::string> notices;
  for (const DriveSpec& drive : model.spec().drives) {
    const std::vector<LawSpec>& laws = use == LawUse::kMotion ? drive.motion : drive.effort;
    for (std::size_t i = 0; i < laws.size(); ++i) {
      if (!laws[i].samples) continue;
      const std::vector<double>& times = laws[i].samples->first;
      const std::string name = drive.name.name + (laws.size() > 1 ? kAxes[i] : "");
      const char* what = use == LawUse::kMotion ? "motion" : "effort";
      std::string text = fmt::format(
          "the {} of drive '{}' is the natural cubic spline through {} samples{}: twice continuously differentiable, "
          "its second derivative zero at both ends",
          what, name, times.size(), laws[i].file.empty() ? "" : " of " + laws[i].file);
      notices.push_back(std::move(text));
      const double rounding = 1e-9 * (times.back() - times.front());
      const bool before = t_begin<times.front() - rounding, after = t_end> times.back() + rounding;
      if (!before && !after) continue;
      notices.push_back(fmt::format(
          "the run leaves the times of that table, {:.9g} to {:.9g} s: {} it the law goes on along its end tangent, "
          "without acceleration",
          times.front(), times.back(),
          before && after ? "before and after"
          : before        ? "before"
                          : "after"));
    }
  }
  return notices;
}

}  // namespace ferrers
