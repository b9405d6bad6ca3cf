#pragma once

#include "support/diagnosis_runs.h"

/// Recordings that hide something outside the catalogue, or cannot be recordings.
namespace fathom::test {

/// A crease along the panel's y axis, and all beyond it turned about it.
PanelMap folded(PanelMap panel, double angle_rad);

// Outside the catalogue.

/// A panel of two halves, the right one slipped upward along the seam.
PanelMap slipped(PanelMap panel, double along_m);

/// DVL that reads v (1 + k |v|).
void makeDvlQuadratic(std::vector<Sample>& samples, double k_s_m);

/// Gyro that reads rate + G f.
void makeGyroSensitive(std::vector<Sample>& samples, const Matrix3d& G);

/// Four kinds in turn, each in three sizes.
DiagnosisRun outsideCatalogue(const BatchRun& nominal, std::size_t number, std::uint64_t seed);

/// The same of light, four kinds in turn: a dark blotch on the port, a response curve of another exponent
/// for each colour, bubbles that pass before a few patches of every other image, a lens out of focus.
DiagnosisRun outsideLight(const BatchRun& nominal, std::size_t number, std::uint64_t seed);

// What nothing can be learnt from.

/// No excitation, two samples, constant sensors, files that contradict each other.
std::vector<DiagnosisRun> wrongInputs(const BatchRun& nominal);

}  // namespace fathom::test
