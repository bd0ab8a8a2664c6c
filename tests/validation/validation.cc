// Runs every benchmark of the validation page, compares each figure with its reference, measures work against
// precision, and writes the page with its plots. Exit code 1 when a figure is off by more than it may be.
//
//   ferrers_validation FOLDER [--quick]      FOLDER gets validation.md and img/validation-*.svg; --quick: figures only

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "benchmarks.h"
#include "plot.h"

using namespace ferrers;              // NOLINT(google-build-using-namespace): a program, not a header
using namespace ferrers::witness;     // NOLINT(google-build-using-namespace)
using namespace ferrers::validation;  // NOLINT(google-build-using-namespace)

namespace {

constexpr double kInvariant = 1e-10;  // of the energy scale
constexpr double kMostSeconds = 5;    // for all figures together

struct Measured {
  ProbedRun run;
  double seconds = 0;
};

Measured measure(const Benchmark& b, const SimulationOptions& options) {
  const EngineProbe engine(b.spec);
  Measured out;
  const RunControl control = keep_rows(*engine.dynamics, out.run);
  const auto begin = std::chrono::steady_clock::now();
  out.run.summary = simulate(engine.dynamics, options, control);
  out.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return out;
}

double value(const ProbedRun& run, const Figure& f) { return f.offset + f.factor * run.at(f.t, f.column); }

// --- Figures ---

struct Verdict {
  bool good = true;
  double seconds = 0;
};

std::string figures_section(const Benchmark& b, Verdict& verdict) {
  const Measured m = measure(b, plain_run(b.t_end, b.every));
  const RunSummary& s = m.run.summary;
  verdict.seconds += m.seconds;
  std::string text = fmt::format("## {}: {}\n\n{} Source: {}.\n\n", b.id, b.title, b.definition, b.source);
  if (s.status != RunStatus::kFinished) {
    verdict.good = false;
    return text + fmt::format("**Not finished**: {}\n\n", s.message);
  }
  text += "| figure | t in s | ours | reference | deviation, of the largest magnitude | |\n|---|---|---|---|---|---|\n";
  for (const Figure& f : b.figures) {
    const double ours = value(m.run, f), off = std::abs(ours - f.reference) / f.scale;
    const bool good = off <= f.allowed;
    verdict.good = verdict.good && good;
    text += fmt::format("| {} | {} | {:.13g} | {:.13g} | {:.1e} | {} |\n", f.name, f.t, ours, f.reference, off,
                        good ? "met" : "**missed**");
  }
  const double balance = std::abs(s.balance_error);
  const bool kept = balance <= kInvariant * b.energy_scale;
  verdict.good = verdict.good && kept;
  text += fmt::format(
      "\n{}; {} steps, {} evaluations, {:.1f} ms; energy less work is off by {:.1e} J ({}); {} singular poses "
      "crossed.\n\n",
      s.method, s.steps, s.evaluations, 1e3 * m.seconds, balance, kept ? "kept" : "**not kept**",
      s.singular_poses.size());
  return text;
}

// --- Work and precision ---

double error_of(const Benchmark& b, const ProbedRun& run) {
  double error = 0;
  for (const Figure& f : b.figures) {
    if (f.t > run.summary.t_reached + 1e-9 || f.column.ends_with("velocity") || f.column.ends_with("acceleration"))
      continue;
    error = std::max(error, std::abs(value(run, f) - f.reference) / f.scale);
  }
  return error;
}

std::string work_section(const Benchmark& b, double time_scale, Plot& plot) {
  std::string text = fmt::format(
      "### {}: {}\n\n| integrator | steps | evaluations | time in ms | error | order |\n"
      "|---|---|---|---|---|---|\n",
      b.id, b.title);
  const auto row = [&](Integrator integrator, std::optional<double> tolerance, std::optional<double> step,
                       double before) {
    SimulationOptions options = plain_run(b.t_end, b.every);
    options.integrator = integrator;
    options.tolerance = tolerance;
    options.step = step;
    options.find_singular_poses = false;
    const Measured m = measure(b, options);
    const RunSummary& s = m.run.summary;
    const std::string name = fmt::format("{}, {}", to_string(integrator),
                                         tolerance ? fmt::format("tolerance {:g}", *tolerance) : "fixed steps");
    if (s.status != RunStatus::kFinished) {
      text += fmt::format("| {} | | | | says that it cannot: {} | |\n", name, s.message);
      return std::nan("");
    }
    const double error = error_of(b, m.run);
    text += fmt::format("| {} | {} | {} | {:.2f} | {:.1e} | {} |\n", name, s.steps, s.evaluations, 1e3 * m.seconds,
                        error, step && before > 0 ? fmt::format("{:.2f}", std::log2(before / error)) : "");
    plot.add(fmt::format("{}{}", to_string(integrator), step ? ", fixed" : ""), static_cast<double>(s.evaluations),
             std::max(error, 1e-16));
    return error;
  };
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9, 1e-11}) row(Integrator::kDormandPrince8, tolerance, {}, 0);
  for (const double tolerance : {1e-3, 1e-5, 1e-7, 1e-9}) row(Integrator::kDormandPrince5, tolerance, {}, 0);
  for (const double tolerance : {1e-3, 1e-5, 1e-7}) row(Integrator::kRungeKutta4, tolerance, {}, 0);
  for (const double tolerance : {1e-3, 1e-5}) row(Integrator::kGeneralizedAlpha, tolerance, {}, 0);
  const auto steps = [&](Integrator integrator, double first, int count) {
    double before = 0, step = first * time_scale;
    for (int i = 0; i < count; ++i, step /= 2) before = row(integrator, {}, step, before);
  };
  if (b.id.rfind("A02", 0) != 0) {  // fixed steps do not look for singular poses
    steps(Integrator::kDormandPrince8, 0.5, 3);
    steps(Integrator::kDormandPrince5, 0.05, 4);
    steps(Integrator::kRungeKutta4, 0.05, 4);
    steps(Integrator::kGeneralizedAlpha, 0.02, 3);
    steps(Integrator::kConstantAcceleration, 0.005, 3);
  }
  return text + "\n";
}

void write(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file) << text;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("usage: ferrers_validation FOLDER [--quick]\n", stderr);
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const bool quick = argc > 2 && std::string(argv[2]) == "--quick";
  const std::vector<Benchmark> benchmarks = iftomm_benchmarks();
  Verdict verdict;
  std::string page =
      "# Validation\n\nWritten by `./run validate`; the tests run the same and fail where a figure is missed. Every "
      "figure is computed with the\nsettings that `ferrers simulate` chooses by itself. A figure is met when it is off "
      "by no "
      "more than 5e-10 of the largest magnitude of\nits vector over the run (velocities of A03: 1e-9).\n\n";
  for (const Benchmark& b : benchmarks) {
    page += figures_section(b, verdict);
    std::printf("%-9s %s\n", b.id.c_str(), verdict.good ? "met" : "missed, or one before it");
  }
  page += fmt::format("All of this took {:.2f} s of wall time.\n\n", verdict.seconds);
  if (verdict.seconds > kMostSeconds) verdict.good = false;
  if (!quick) {
    page +=
        "# Work and precision\n\nThe error is the largest deviation of the positions above from their references. "
        "`order`: "
        "log₂ of the ratio of errors when the step is halved.\n\n";
    for (const Benchmark& b : benchmarks) {
      if (b.id != "A02 N=2" && b.id != "A03" && b.id != "A04") continue;
      Plot plot(b.id + ": error against evaluations", "evaluations", "error");
      page += work_section(b, b.id == "A03" ? 1e-3 : 1, plot);
      const std::string name = fmt::format("validation-{}.svg", b.id.substr(0, 3));
      write(folder / "img" / name, plot.svg());
      page += fmt::format("![{}: error against evaluations](img/{})\n\n", b.id, name);
      std::printf("%-9s work and precision\n", b.id.c_str());
    }
  }
  write(folder / "validation.md", page);
  std::printf("%s, %.2f s for the figures; %s\n", verdict.good ? "every figure is met" : "MISSED", verdict.seconds,
              (folder / "validation.md").c_str());
  return verdict.good ? 0 : 1;
}
