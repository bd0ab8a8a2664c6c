#include "sweep_text.h"

#include <fmt/format.h>

#include <algorithm>

using namespace ferrers;  // NOLINT(google-build-using-namespace)

namespace {

constexpr std::size_t kMostShown = 8;

std::string line(std::string_view label, std::string_view text) { return fmt::format("  {:<15}{}\n", label, text); }

std::string time_text(const SweepDocument& document) {
  const std::size_t computed = document.tally.count() - document.resumed;
  std::string text = fmt::format("{} s on {}", rough(document.wall_time_s), counted(document.threads, "thread"));
  if (computed > 0 && document.wall_time_s > 0) {
    text += fmt::format(", {} variants per second", rough(static_cast<double>(computed) / document.wall_time_s));
  }
  if (document.resumed > 0) text += fmt::format("; {} were there before", document.resumed);
  return text;
}

std::string and_more(std::size_t all, std::size_t shown, std::string_view file) {
  return all > shown ? line("", fmt::format("and {} more, in {}", all - shown, file)) : "";
}

std::string failures_text(const SweepTally& tally) {
  std::string text;
  const std::size_t shown = std::min(tally.failures().size(), kMostShown);
  for (std::size_t i = 0; i < shown; ++i) {
    const SweepTally::Failure& one = tally.failures()[i];
    text += wrapped_text(fmt::format("  {:<15}{}: ", i == 0 ? "failed" : "", one.index),
                         fmt::format("{}: {}", one.status, one.message), std::string(17, ' '));
  }
  return text + and_more(tally.failed(), shown, "sweep.csv");
}

std::string notices_text(const SweepTally& tally) {
  std::string text;
  const std::size_t shown = std::min(tally.notices().size(), kMostShown);
  for (std::size_t i = 0; i < shown; ++i) {
    const SweepTally::Notice& one = tally.notices()[i];
    const std::string who = one.variants == 1 ? fmt::format("variant {}", one.first)
                                              : fmt::format("{} variants, the first {}", one.variants, one.first);
    text += wrapped_text(fmt::format("  {:<15}", "note"), fmt::format("{} ({})", one.text, who), std::string(17, ' '));
  }
  return text + and_more(tally.notices().size(), shown, "sweep.json");
}

}  // namespace

std::string sweep_text(const SweepDocument& document, const std::string& files, const Style& style) {
  const SweepTally& tally = document.tally;
  const bool whole = document.status == SweepStatus::kFinished;
  std::string text = fmt::format(
      "{}: {} of {}{}\n\n", style.bold(document.model), counted(static_cast<long>(document.table->rows()), "variant"),
      fmt::join(document.table->names, ", "), whole ? "" : fmt::format(" (interrupted after {})", tally.count()));
  for (const auto& [status, count] : tally.statuses()) text += line(status, fmt::format("{}", count));
  text += line("computing", time_text(document));
  text += failures_text(tally) + notices_text(tally);
  if (document.folder) {
    text += fmt::format("\n  {} in {}\n    {}\n", counted(static_cast<long>(tally.count()), "row"),
                        style.bold(*document.folder), files);
  }
  return text;
}
