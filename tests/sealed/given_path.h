#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "motion.h"

namespace fathom::sealed {

/// A path through given poses: position and quaternion each by a natural cubic spline, so that rates and
/// accelerations are exact and continuous. Before the first pose and after the last the robot rests there.
class GivenPath {
 public:
  /// TUM text: poses of the robot in odom against seconds of the recording. Throws Error (file, line or time,
  /// reason) where it is no TUM text, does not reach from 0 to `duration_s`, or has poses more than 0.1 s or
  /// half a radian apart.
  GivenPath(const std::filesystem::path& file, double duration_s);

  Motion at(double t_s) const;

 private:
  using Coordinates = Eigen::Matrix<double, 7, 1>;  // x y z, quaternion x y z w, of one sign throughout

  std::vector<double> times_s_;
  std::vector<Coordinates> values_, curvatures_;  // the second: second derivatives by time
};

}  // namespace fathom::sealed
