#pragma once

#include "recording/sample_source.h"
#include "simulation/navigation_simulator.h"

namespace fathom {

/// The samples of a vehicle's sensors along a trajectory, made as they are asked for: the same samples as
/// simulateNavigation() gives. Memory: the trajectory.
class SimulatedSource : public SampleSource {
 public:
  /// Throws Error as NavigationSimulator. `header` is what header() says; it is no sample.
  SimulatedSource(SimulationOptions options, Trajectory trajectory, RecordingHeader header = {});

  const RecordingHeader& header() const override { return header_; }
  std::optional<Sample> next() override;
  std::filesystem::path imageFolder() const override { return {}; }
  double fraction() const override { return fraction_; }

 private:
  SimulationOptions options_;
  Trajectory trajectory_;
  RecordingHeader header_;
  NavigationSimulator simulator_;  // refers to the two above
  double fraction_ = 0.0;
};

/// A motion as recorded, and the stamp of its first pose.
struct RecordedMotion {
  Trajectory trajectory;
  Time start;
};
/// From a rawlog's TRUTH or TUM text. Throws Error.
RecordedMotion readRecordedMotion(const std::filesystem::path& file);

/// Lets a simulation along a recorded motion begin and end with [first, last], as far as the motion reaches,
/// so that its samples carry the recording's absolute times. Returns false where it does not reach into it.
bool alignTo(SimulationOptions& options, const RecordedMotion& motion, Time first, Time last);

}  // namespace fathom
