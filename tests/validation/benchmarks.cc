#include "benchmarks.h"

#include "ferrers/testing/closed_forms.h"
#include "ferrers/testing/zoo.h"

namespace ferrers::validation {
namespace {

using witness::BricardRods;

void add_point(Benchmark& b, const std::string& point, double t, std::vector<double> xyz, double scale) {
  const char* const axes[] = {"x", "y", "z"};
  for (std::size_t i = 0; i < xyz.size(); ++i) {
    b.figures.push_back({point + " " + axes[i], t, point + "." + axes[i], 1, 0, xyz[i], scale, 5e-10});
  }
}

Benchmark pendulum() {
  Benchmark b{"A01",
              "Simple pendulum",
              "Point mass of 1 kg on a massless link of 1 m, from the horizontal at rest; one revolute joint.",
              "closed form: sin(φ/2) = √½ cd(√g t | ½)",
              witness::make_pendulum(),
              10,
              0.5,
              {},
              9.81,
              "P"};
  add_point(b, "P", 1, {-0.9862917511318753, -0.1650108531255412}, 1);
  add_point(b, "P", 5, {0.9423054350437573, -0.3347543384140006}, 1);
  add_point(b, "P", 10, {0.2750874625761169, -0.9614192050991251}, 1);
  return b;
}

Benchmark four_bars(int n) {
  Benchmark b{
      "A02 N=" + std::to_string(n),
      std::to_string(n) + " four-bars in a row",
      "Uniform rods of 1 m and 1 kg; all joints revolute in space. From upright with a tip speed of 1 m/s. At the "
      "horizontal pose the mobility is " +
          std::to_string(n + 1) + " instead of 1.",
      "closed form on the parallelogram branch, integrated in extended precision",
      witness::make_n_four_bar(n, 0, 1),
      20,
      1,
      {},
      ((n + 1) / 2.0 + n) * 9.81,
      "B0"};
  if (n == 2) {
    add_point(b, "B0", 1, {-0.1950203019494351, -0.9807992056621738}, 1);
    add_point(b, "B0", 5, {-0.8113104610051074, -0.5846155453489755}, 1);
    add_point(b, "B0", 10, {0.3284581115408154, 0.9445185381786010}, 1);
  } else if (n == 40) {
    add_point(b, "B0", 1, {-0.1153568806321099, -0.9933241113004502}, 1);
    add_point(b, "B0", 10, {0.1805122266867284, 0.9835727405823116}, 1);
  } else {
    const Vector3d tip = witness::parallelogram_tip(n, 10);
    add_point(b, "B0", 10, {tip.x(), tip.y()}, 1);
  }
  const Vector3d tip = witness::parallelogram_tip(n, 20);
  add_point(b, "B0", 20, {tip.x(), tip.y()}, 1);
  return b;
}

Benchmark squeezer() {
  Benchmark b{
      "A03",
      "Andrews' squeezer",
      "Seven bodies, ten revolute joints in space (50 rows, 9 of them redundant), a spring, a torque of 0.033 N·m.",
      "converged integration, good to 1e-12; starts as in the IVP test set [hairer1996]",
      witness::make_andrews(),
      0.03,
      0.01,
      {},
      0.5,
      "angles"};
  const char* const joints[] = {"O", "F", "B", "G", "A5", "H", "A7"};
  const char* const names[] = {"β", "Θ", "γ", "Φ", "δ", "Ω", "ε"};
  const double start[] = {-0.0617138900142764496, 0,
                          0.455279819163070380,   0.222668390165885885,
                          0.487364979543842550,   -0.222668390165885885,
                          1.23054744454982120};
  const double sign[] = {1, 1, 1, -1, 1, -1, 1};
  const double early[] = {2.160113131531,  -1.883364231107, 0.1585167580012, -0.3286410751747,
                          0.5251547747977, 0.3286410751747, 1.0684272046324};
  const double late[] = {15.810771195154, -15.756371058412, 0.0408222401196, -0.5347301163421,
                         0.5244099658800, 0.5347301163421,  1.0480807410419};
  const double rates[] = {1139.9203022591, -1424.3792951776, 11.0329119106, 19.2933741051,
                          0.5735699148,    -19.2933741051,   0.3231791492};
  for (int i = 0; i < 7; ++i) {
    const std::string angle = std::string(joints[i]) + ".angle";
    b.figures.push_back({names[i], 0.01, angle, sign[i], start[i], early[i], 15.810771195154, 5e-10});
    b.figures.push_back({names[i], 0.03, angle, sign[i], start[i], late[i], 15.810771195154, 5e-10});
    b.figures.push_back(
        {std::string(names[i]) + "'", 0.03, angle + ".velocity", sign[i], 0, rates[i], 1424.3792951776, 1e-9});
  }
  b.figures.push_back({"β''", 0, "O.angle.acceleration", 1, 0, 14222.4439199541, 14222.4439199541, 5e-10});
  b.figures.push_back({"Θ''", 0, "F.angle.acceleration", 1, 0, -10666.8329399655, 14222.4439199541, 5e-10});
  return b;
}

Benchmark bricard(BricardRods rods) {
  const bool bricks = rods == BricardRods::kBricks;
  Benchmark b{
      bricks ? "A04" : "A04 thin",
      bricks ? "Bricard's loop of bricks" : "Bricard's loop of thin rods",
      "Six revolute joints, five rods of 1 m and 1 kg; mobility 1 where Grübler counts 0; from rest under gravity.",
      "converged integration of the loop's exact equation, 11 to 12 digits",
      witness::make_bricard(rods),
      10,
      bricks ? 0.5 : 0.1,
      {},
      9.81,
      "P3"};
  if (bricks) {
    add_point(b, "P3", 0.5, {0.774717808039, -0.979815047656, -0.199906158953}, 1);
    add_point(b, "P3", 1, {0.274481319265, -0.886707938735, -0.462330002687}, 1);
    add_point(b, "P3", 1.5, {-0.279017575416, -0.887361378832, -0.461074596305}, 1);
    add_point(b, "P3", 2, {-0.778135373033, -0.980352683443, -0.197252670617}, 1);
    add_point(b, "P3", 5, {0.999932742303, -0.999999997738, -0.000067255435}, 1);
    add_point(b, "P3", 10, {0.999730987305, -0.999999963826, -0.000268976511}, 1);
  } else {
    add_point(b, "P3", 0.2, {0.96127326395, -0.99927861901, -0.03797685600}, 1);
    add_point(b, "P3", 1, {0.273333915810, -0.886544000792, -0.462644285234}, 1);
    add_point(b, "P3", 5, {0.99981611871, -0.99999998310, -0.00018386439}, 1);
    add_point(b, "P3", 10, {0.99926461009, -0.99999972980, -0.00073511951}, 1);
  }
  return b;
}

Benchmark governor() {
  Benchmark b{"A05",
              "Stiff flyball governor",
              "A shaft that spins freely, two rods, a slider on stiff spring-dampers (8e5 N/m, 4e4 N·s/m).",
              "converged integration, 10 digits",
              witness::make_flyball(),
              10,
              0.1,
              {},
              169,
              "S"};
  for (const auto& [t, s] :
       {std::pair{0.1, 0.5238364756}, {0.5, 0.7432494248}, {1.0, 0.5014209224}, {5.0, 0.5355631037}}) {
    b.figures.push_back({"s", t, "S.z", 1, 0, s, 0.7432494248, 5e-10});
  }
  return b;
}

}  // namespace

std::vector<Benchmark> iftomm_benchmarks() {
  std::vector<Benchmark> all = {pendulum()};
  for (const int n : {1, 2, 5, 10, 40}) all.push_back(four_bars(n));
  all.push_back(squeezer());
  all.push_back(bricard(BricardRods::kBricks));
  all.push_back(bricard(BricardRods::kThin));
  all.push_back(governor());
  return all;
}

}  // namespace ferrers::validation
