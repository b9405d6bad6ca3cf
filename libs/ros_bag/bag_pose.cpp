#include "ros_bag/bag_pose.h"

namespace fathom {

BagPose poseOf(const BagMessage& message) {
  const auto of = [](const auto& stamped, const ros1::Pose& pose) {
    return BagPose{toTime(stamped.header.stamp), pose.orientation, toVector(pose.position), {}};
  };
  const auto withCovariance = [&](const auto& stamped) {
    BagPose pose = of(stamped, stamped.pose.pose);
    pose.covariance =
        Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(stamped.pose.covariance.data());
    return pose;
  };
  if (message.is("nav_msgs/Odometry")) return withCovariance(*message.as<ros1::Odometry>());
  if (message.is("geometry_msgs/PoseWithCovarianceStamped"))
    return withCovariance(*message.as<ros1::PoseWithCovarianceStamped>());
  const auto stamped = message.as<ros1::PoseStamped>();
  return of(*stamped, stamped->pose);
}

}  // namespace fathom
