#pragma once

#include <Eigen/Core>
#include <optional>

#include "core/geometry.h"
#include "core/time.h"
#include "ros_bag/bag_message.h"

namespace fathom {

/// A pose as whichever message has it.
struct BagPose {
  Time time;
  ros1::Quaternion orientation;
  Vector3d position;
  std::optional<Eigen::Matrix<double, 6, 6>> covariance;
};

/// Of nav_msgs/Odometry, geometry_msgs/PoseWithCovarianceStamped or PoseStamped, unchecked.
/// Throws BadMessage as BagMessage::as().
BagPose poseOf(const BagMessage& message);

}  // namespace fathom
