#include "ferrers/testing/zoo.h"

#include <numbers>
#include <stdexcept>

namespace ferrers::witness {
namespace {

constexpr std::nullopt_t kUnknown = std::nullopt;
constexpr double kRightAngle = std::numbers::pi / 2;

ModelSpec named(ModelSpec spec, const std::string& name) {
  spec.name = name;
  return spec;
}

// Closed forms. A hinge beside a coaxial one repeats all its five rows. Planar loops of spatial joints repeat three
// rows each (out-of-plane force, two out-of-plane moments) and leave two unique in-plane components a joint.
void add_basic_and_planar(std::vector<ZooEntry>& zoo) {
  zoo.push_back({"pendulum", make_pendulum(), 1, 5, 5, 1, 0, 5, 5});
  zoo.push_back({"door2", make_door(2), 1, 10, 5, 1, 5, 0, 0});
  zoo.push_back({"door3", make_door(3), 1, 15, 5, 1, 10, 0, 0});
  zoo.push_back({"shaft_determinate", make_shaft_determinate(), 1, 5, 5, 1, 0, 5, 5});
  zoo.push_back({"shaft_overconstrained", make_shaft_overconstrained(), 1, 13, 5, 1, 8, 1, 1});
  zoo.push_back({"four_bar_rrrr", make_four_bar(FourBarJoints::kRevolute), 3, 20, 17, 1, 3, 8, 8});
  zoo.push_back({"four_bar_rscr", make_four_bar(FourBarJoints::kSphericalCylindrical), 3, 17, 17, 1, 0, 17, 17});
  zoo.push_back({"four_bar_rssr", make_four_bar(FourBarJoints::kTwoSpherical), 3, 16, 16, 2, 0, 16, 16});
  zoo.push_back({"driven_four_bar", make_driven_four_bar(), 3, 20, 17, 1, 3, 8, 8});
  zoo.push_back({"parallel_cranks", make_parallel_cranks(), 4, 30, 23, 1, 7, 0, 6});
  zoo.push_back({"n_four_bar1", make_n_four_bar(1, 0.4), 3, 20, 17, 1, 3, 8, 8});
  zoo.push_back({"n_four_bar2", make_n_four_bar(2, 0.4), 5, 35, 29, 1, 6, 14, 14});
  zoo.push_back(
      {"n_four_bar2_upright", named(make_n_four_bar(2, 0, 1), "n_four_bar2_upright"), 5, 35, 29, 1, 6, 14, 14});
  zoo.push_back({"n_four_bar2_horizontal", named(make_n_four_bar(2, kRightAngle), "n_four_bar2_horizontal"), 5, 35, 27,
                 3, 8, 7, 7});
  zoo.push_back({"slider_crank_rrrp", make_slider_crank(SliderCrankJoints::kRevolutePrismatic), 3, 20, 17, 1, 3, 8, 8});
  zoo.push_back(
      {"slider_crank_rsrc", make_slider_crank(SliderCrankJoints::kSphericalCylindrical), 3, 17, 17, 1, 0, 17, 17});
  zoo.push_back({"planetary1", make_planetary(1), 3, 17, 17, 1, 0, 17, 17});
  zoo.push_back({"planetary2", make_planetary(2), 4, 24, 23, 1, 1, kUnknown, 16});
  zoo.push_back({"planetary3", make_planetary(3), 5, 31, 29, 1, 2, 15, 18});
  zoo.push_back({"scissor_lift1", make_scissor_lift(1), 5, 35, 29, 1, 6, 14, 14});
  zoo.push_back({"scissor_lift2", make_scissor_lift(2), 7, 50, 41, 1, 9, 20, 20});
  zoo.push_back({"excavator", make_excavator(), 11, 75, 63, 3, 12, 30, 30});
  zoo.push_back({"andrews", make_andrews(), 7, 50, 41, 1, 9, 20, 20});
}

// Published overconstrained linkages (Bricard, Sarrus, Bennett): one redundant row more than the Grübler count admits.
void add_spatial(std::vector<ZooEntry>& zoo) {
  zoo.push_back({"bricard", make_bricard(BricardRods::kBricks), 5, 30, 29, 1, 1, 0, 24});
  zoo.push_back({"bricard_thin", make_bricard(BricardRods::kThin), 5, 30, 29, 1, 1, 0, 24});
  zoo.push_back({"sarrus", make_sarrus(0.7), 5, 30, 29, 1, 1, 24, 24});
  zoo.push_back(
      {"sarrus_extended", named(make_sarrus(kRightAngle), "sarrus_extended"), 5, 30, 28, 2, 2, kUnknown, kUnknown});
  zoo.push_back({"bennett", make_bennett(), 3, 20, 17, 1, 3, 0, 8});
  zoo.push_back({"flyball", make_flyball(), 4, 20, 20, 4, 0, 20, 20});
}

}  // namespace

std::vector<ZooEntry> zoo() {
  std::vector<ZooEntry> entries;
  add_basic_and_planar(entries);
  add_spatial(entries);
  return entries;
}

ZooEntry zoo_entry(const std::string& name) {
  for (ZooEntry& entry : zoo()) {
    if (entry.name == name) return std::move(entry);
  }
  throw std::invalid_argument("zoo_entry: no mechanism '" + name + "'");
}

}  // namespace ferrers::witness
