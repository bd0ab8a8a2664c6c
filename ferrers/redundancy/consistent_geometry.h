#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ferrers/math/rank.h"
#include "ferrers/model/model.h"

/// Problem: numbers from CAD, or angles typed with five digits, line up to a micrometre only. Taken at their word they
/// describe a mechanism that jams: a loop that does not quite close, axes that are not quite parallel, and no
/// redundancy.
///
/// Given: a model and how far its numbers may be off (relative to its size; rad). Wanted: the nearest geometry that
/// does exactly what this one does nearly: its loops close, and it moves. Method: with the rank decided under that
/// tolerance the mechanism is led through several poses, each the nearest to closing. At each, a self-stress z meets
/// the misclosure zᵀ phi, and feels every displacement of a joint's seats:
///   zᵀ phi + Σ_joints w_j · (ε_M − ε_F) = 0,
/// w_j being its wrench on joint j, ε_F and ε_M small displacements of the joint's frames on their bodies. The least
/// displacements that do this at all poses at once are made, poses and self-stresses are found anew, and so on
/// (Gauss-Newton). A geometry that closes at that many poses closes along the motion; further poses prove it. So axes
/// become parallel, cranks of equal length, or a Bennett loop a true one, without a list of special geometries. Joints
/// between two points and meshes of teeth keep their numbers; masses and bodies are not touched.
/// Cost: some hundred singular value decompositions of G, dense; up to `kMostRowsMadeConsistent` closure rows.
namespace ferrers {

constexpr int kMostRowsMadeConsistent = 300, kMostCoordinatesMadeConsistent = 600;

enum class GeometryVerdict {
  kExact,     ///< Nothing to do: the numbers as written say clearly what is redundant, or nothing nearly is.
  kFound,     ///< `spec` holds the consistent geometry.
  kOpen,      ///< The loops stay open by more than the tolerance.
  kNotFound,  ///< No geometry within the tolerance was found that moves as this one nearly does.
  kTooLarge,  ///< More closure rows or coordinates than that.
};
std::string_view to_string(GeometryVerdict verdict);

/// How far a joint's seats were moved on its bodies.
struct SeatMove {
  std::string joint;
  double distance_m = 0, angle_rad = 0;
};

/// Joints whose axes are parallel in the consistent geometry.
struct ParallelAxes {
  std::vector<std::string> joints;
  double angle_rad = 0;  ///< Largest angle between two of them as written.
};

struct ConsistentGeometry {
  GeometryVerdict verdict = GeometryVerdict::kExact;
  double tolerance = 0;
  std::optional<ModelSpec> spec;       ///< kFound: joints given by frames where they had to move.
  std::shared_ptr<const Model> model;  ///< kFound: built of it, with the parameter values of the given one.
  double misclosure_m = 0;             ///< As written, at the best pose: largest residual of a row, angles times L.
  RankDecision as_written;             ///< Of the closure rows, with numbers taken at their word.
  RankDecision treated;                ///< With the tolerance.
  int mobility_as_written = 0, redundant_as_written = 0;
  int mobility = 0, redundant = 0;  ///< With the tolerance.
  std::vector<SeatMove> moves;      ///< Largest first; those that moved at all.
  std::vector<ParallelAxes> parallel;
  int poses = 0;     ///< At which it was made to close.
  std::string text;  ///< For the designer; empty where the numbers are exact.
};

/// `tolerance`: relative to the characteristic length, and rad; 0 asks for nothing and gets `kExact`.
ConsistentGeometry find_consistent_geometry(const Model& model, double tolerance);

}  // namespace ferrers
