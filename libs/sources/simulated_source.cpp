#include "sources/simulated_source.h"

#include <algorithm>

#include "simulation/read_trajectory.h"

namespace fathom {

SimulatedSource::SimulatedSource(SimulationOptions options, Trajectory trajectory, RecordingHeader header)
    : options_(std::move(options)),
      trajectory_(std::move(trajectory)),
      header_(std::move(header)),
      simulator_(options_, trajectory_) {}

std::optional<Sample> SimulatedSource::next() {
  auto sample = simulator_.next();
  fraction_ = 1.0;
  if (sample && simulator_.duration_s() > 0)
    fraction_ = std::min(1.0, secondsBetween(options_.start, sample->time) / simulator_.duration_s());
  return sample;
}

RecordedMotion readRecordedMotion(const std::filesystem::path& file) {
  const auto poses = readRecordedPoses(file);
  return {Trajectory::fromTum(poses, file.string()), poses.front().time};
}

bool alignTo(SimulationOptions& options, const RecordedMotion& motion, Time first, Time last) {
  const double begin_s = std::max(0.0, secondsBetween(motion.start, first));
  const double end_s = std::min(motion.trajectory.end_s(), secondsBetween(motion.start, last));
  if (!(end_s > begin_s)) return false;
  options.start = std::max(motion.start, first);
  options.begin_s = begin_s;
  options.duration_s = end_s - begin_s;
  return true;
}

}  // namespace fathom
