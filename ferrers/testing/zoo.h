#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ferrers/model/spec.h"

/// The mechanism zoo: named mechanisms whose rank, mobility and redundancy are known without this project.
///
/// Every mechanism is drawn: points and axes in world coordinates, loops closed by construction. Masses and inertias
/// are physical, so that each one also moves. Figures come from closed forms (planar and spherical loops: three rows of
/// a loop's six repeat) or from the literature on overconstrained linkages, as the maker's comment says; `zoo_test.cc`
/// checks all of them against singular values in absolute coordinates.
namespace ferrers::witness {

/// One mechanism and the verdict expected at its drawn pose.
struct ZooEntry {
  std::string name;
  ModelSpec spec;
  int bodies = 0;                       ///< Without ground.
  int rows = 0;                         ///< All joints' constraint rows.
  int rank = 0;                         ///< Of their Jacobian on 6·bodies velocities.
  int mobility = 0;                     ///< 6·bodies − rank.
  int redundant = 0;                    ///< rows − rank.
  std::optional<int> unique;            ///< Reaction components, in the joints' frames, that no self-stress touches.
  std::optional<int> unique_dimension;  ///< Sum over joints of the dimension of the unique part of the wrench.
};

/// All of the mechanisms below with their figures, at the poses that the figures belong to.
std::vector<ZooEntry> zoo();

/// The entry of that name; throws `std::invalid_argument` when there is none.
ZooEntry zoo_entry(const std::string& name);

// --- One body on several joints (zoo_basic.cc) ---

/// A01: point mass of 1 kg on a massless 1 m link about z, drawn along +x, gravity in −y.
ModelSpec make_pendulum();

/// Door of 20 kg, mass centre 0.45 m from the vertical hinge line, `hinges` coaxial revolutes over 1.7 m. Every
/// hinge beyond the first repeats five rows.
ModelSpec make_door(int hinges);

/// Shaft in a spherical bearing and a sphere in a cylinder: statically determinate.
ModelSpec make_shaft_determinate();

/// Shaft in one revolute and two cylindrical bearings: only the axial force is determinate.
ModelSpec make_shaft_overconstrained();

// --- Planar linkages of spatial joints (zoo_planar.cc) ---

enum class FourBarJoints { kRevolute, kSphericalCylindrical, kTwoSpherical };

/// Four-bar (0,0), (0.3,0.9), (2,1.5), (1.8,0) in the xy plane: R-R-R-R, R-S-C-R or R-S-S-R in the order round the
/// loop.
ModelSpec make_four_bar(FourBarJoints joints);

/// Crank 1 m 1 kg, coupler 2 m 2 kg, rocker √13 m 4 kg on (0,0) and (4,0), gravity in −y, crank drawn along +x; the
/// crank's drive follows 1.2 (1 − cos 2t).
ModelSpec make_driven_four_bar();

/// Three parallel cranks of 1 m on x = 0, 1.3, 2.6, drawn at `crank_angle_rad` from +x, and one platform.
ModelSpec make_parallel_cranks(double crank_angle_rad = 0.7);

/// A02: `loops` four-bars in a row, thin rods of 1 m and 1 kg, cranks drawn at `crank_angle_rad` from upright
/// (clockwise: tips at (sin, cos)), turning clockwise with `crank_speed`. Mobility is 1 but `loops` + 1 where the
/// cranks lie along the couplers (±π/2).
ModelSpec make_n_four_bar(int loops, double crank_angle_rad, double crank_speed = 0);

enum class SliderCrankJoints { kRevolutePrismatic, kSphericalCylindrical };

/// Crank 0.2 m 2 kg, rod 0.5 m 3 kg, slider 4 kg on the x axis, gravity in −y, drawn at `crank_angle_rad`; the crank's
/// drive turns at 30 rad/s. R-R-R-P or R-S-R-C.
ModelSpec make_slider_crank(SliderCrankJoints joints, double crank_angle_rad = 0.7853981633974483);

/// Sun (radius 1) and carrier on one axis, fixed ring, `planets` of radius 0.7 on revolutes; involute meshes at 20
/// degrees. Every planet beyond the first repeats one row.
ModelSpec make_planetary(int planets);

/// One side of a scissor lift: `stages` pairs of 2 m bars at 0.5 rad, rollers as revolute and prismatic, a platform.
ModelSpec make_scissor_lift(int stages);

/// Boom, arm and bucket with three revolute-prismatic-revolute cylinders, bucket rocker and link; pins along y.
ModelSpec make_excavator();

/// A03: Andrews' squeezing mechanism, seven bodies and ten pins, here spatial revolutes; spring and constant torque.
ModelSpec make_andrews();

// --- Spatial linkages (zoo_spatial.cc) ---

enum class BricardRods { kBricks, kThin };

/// A04: rectangular Bricard loop of six revolutes and five 1 m rods: mobile although the Grübler count is zero.
ModelSpec make_bricard(BricardRods rods);

/// Sarrus: two chains of three parallel revolutes in planes at right angles carry a platform straight up; chain bars
/// at `angle_rad` from the horizontal, fully extended at π/2.
ModelSpec make_sarrus(double angle_rad);

/// Bennett's skew four-bar, twists 50 and 110 degrees: four revolutes, no two axes parallel or meeting, yet mobile.
ModelSpec make_bennett();

/// A05: flyball governor, stiff springs between rods and slider; shaft drawn at s = 0.5 m with 2π rad/s. Nothing
/// redundant.
ModelSpec make_flyball();

// --- Singular poses and what only seems to move (zoo_singular.cc); not part of zoo() ---

/// Planar platform on three parallel legs of lengths 1, `second` and 1.1 m on x = 0, 1, 2.2: rank leaves mobility 1,
/// but the platform's pins fall by u²/2l_i, which no rigid motion follows unless 1/l_i is linear in x_i.
ModelSpec make_unequal_legs(double second = 1.3);

/// Two bars and three parallel hinges, both ends grounded, the middle one `off` from the line of the others.
ModelSpec make_two_bars(double off = 0);

enum class LegEnds { kRods, kSphericalSpherical, kSphericalUniversal };

/// Platform on six parallel legs of 1.5 m between congruent regular hexagons of radius 1. It translates along a circle
/// in two directions, or screws about the middle: two branches, on both of which the legs' lines have rank 3 only
/// (parallel lines; one family of a hyperboloid's lines).
ModelSpec make_six_legs(LegEnds ends);

/// Watt's linkage whose middle point goes up along x ~ t³, its point tied by a level bar to a vertical slider: the
/// relative height δ follows δ² ~ t³, a cusp, so that it moves one way only.
ModelSpec make_cusp();

/// Roberts' linkage whose coupler point stays on a straight line to fourth order, tied by a bar across that line to a
/// slider along it. With δ the difference of their ways t along the line, δ² + c t⁴ = 0: the bar `upwards` it moves, on
/// two branches that touch; downwards it is rigid, which second order does not tell.
ModelSpec make_touching(bool upwards);

}  // namespace ferrers::witness
