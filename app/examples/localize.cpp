// localize RECORDING.rawlog: where the robot was, by INS and DVL, and how far to trust that.
#include <cstdio>

#include "core/error.h"
#include "facade/fathom.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: localize RECORDING.rawlog\n");
    return 2;
  }
  try {
    fathom::LocalizationOptions options;
    options.smooth = true;
    const fathom::LocalizedPath path = fathom::localize(argv[1], options);
    if (!path.summary.started) {
      std::fprintf(stderr, "no path: %s\n", path.summary.failure.c_str());
      return 1;
    }
    const fathom::Estimate& last = path.smoothed.back();
    const fathom::Vector3d& position = last.state.motion.position_odom;
    std::printf("%zu poses; after %.1f s at %.2f %.2f %.2f m, sigma %.2f m\n", path.smoothed.size(), last.t_s,
                position.x(), position.y(), position.z(),
                std::sqrt(last.pose_covariance.topLeftCorner<3, 3>().trace()));
    for (const auto& [channel, readings] : path.summary.channels)
      std::printf("%s: %zu readings, mean NIS %.2f (expected: %d)\n", fathom::nameOf(channel).c_str(),
                  readings.fused, readings.nis_mean, readings.degrees_of_freedom);
  } catch (const fathom::Error& error) {
    std::fprintf(stderr, "localize: %s\n", error.what());
    return 2;
  }
}
