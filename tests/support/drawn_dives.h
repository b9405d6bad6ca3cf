#pragma once

#include <cstdint>
#include <vector>

#include "localization/regime.h"
#include "recording/samples.h"
#include "simulation/navigation_simulator.h"

namespace fathom::test {

/// Motion drawn from the filter's own model, one state each `interval_s`: angular velocity and acceleration
/// are driven by white noise of these densities. Pulled back, so slowly that the filter does not see it, to
/// rest at (0, 0, -20).
std::vector<KinematicState<double>> drawnMotion(const DrivingNoise& drive, double interval_s,
                                                double duration_s, std::uint64_t seed);

/// What the vehicle's instruments read of such a motion, whose interval divides those of all of them. Of the
/// options: vehicle, effects, sea floor, seed, start, beams.
std::vector<Sample> readingsOf(const std::vector<KinematicState<double>>& motion, double interval_s,
                               const SimulationOptions& options);

}  // namespace fathom::test
