#include "simulation/read_trajectory.h"

#include "simulation/waypoints.h"

namespace fathom {

Trajectory readTrajectory(const std::filesystem::path& file) {
  if (file.extension() == ".yaml") return readWaypoints(file);
  return Trajectory::fromTum(readTum(file), file.string());
}

}  // namespace fathom
