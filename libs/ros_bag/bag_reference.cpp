#include <algorithm>

#include "core/stable_sort.h"
#include "ros_bag/bag_importer.h"
#include "ros_bag/bag_pose.h"

namespace fathom {

void BagImporter::takeTransform(const ros1::TransformStamped& transform, const BagMessage& message,
                                bool for_good) {
  const ros::Time stamp = message.stampOf(transform.header);
  if (!for_good && stamp.isZero()) throw message.error(kNoStamp);
  const Pose T_parent_child{message.rotation(transform.transform.rotation),
                            message.finite(toVector(transform.transform.translation), "translation")};
  transforms_.add(transform.header.frame_id, transform.child_frame_id, {toTime(stamp), T_parent_child},
                  for_good);
}

void BagImporter::takeTransforms(const BagMessage& message, bool for_good) {
  const auto all = message.asUnstamped<ros1::TFMessage>();
  for (const auto& transform : all->transforms) takeTransform(transform, message, for_good);
}

void BagImporter::takeReference(const BagTopic& topic, const BagMessage& message) {
  if (message.is("geometry_msgs/TransformStamped"))
    return takeTransform(*message.as<ros1::TransformStamped>(), message, false);
  if (of_transforms_) return takeTransforms(message, false);
  const BagPose pose = poseOf(message);
  const Pose T_odom_sensor{message.rotation(pose.orientation), message.finite(pose.position, "position")};
  reference_.push_back({pose.time, T_odom_sensor * topic.T_robot_sensor.inverse()});
}

void BagImporter::finishReference() {
  for (const BagTopic& topic : map_.topics)
    if (topic.as == TopicRole::reference && of_transforms_)
      for (const StampedPose& at : transforms_.path(topic.frame, topic.child_frame, bag_, topic.topic))
        reference_.push_back({at.time, at.T_odom_robot * topic.T_robot_sensor.inverse()});
  stableSort(reference_, [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  const auto repeated =
      std::unique(reference_.begin(), reference_.end(),
                  [](const StampedPose& a, const StampedPose& b) { return a.time == b.time; });
  reference_.erase(repeated, reference_.end());
}

}  // namespace fathom
