#include <algorithm>

#include "core/stable_sort.h"
#include "core/text.h"
#include "ros_bag/bag_importer.h"
#include "ros_bag/bag_pose.h"

namespace fathom {

void BagImporter::takeTransform(const ros1::TransformStamped& transform, const BagMessage& message,
                                bool for_good) {
  const ros::Time stamp = message.stampOf(transform.header);
  if (!for_good && stamp.isZero()) throw message.error(kNoStamp);
  const Pose T_parent_child{rotationIn(message, transform.transform.rotation),
                            message.finite(toVector(transform.transform.translation), "translation")};
  if (!for_good)
    reference_clocks_.check(message, toTime(stamp),
                            transform.header.frame_id + " to " + transform.child_frame_id);
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
  const Pose T_odom_sensor{rotationIn(message, pose.orientation), message.finite(pose.position, "position")};
  reference_clocks_.check(message, pose.time);
  reference_.push_back({pose.time, T_odom_sensor * topic.T_robot_sensor.inverse()});
}

void BagImporter::finishReference() {
  const auto topic = std::find_if(map_.topics.begin(), map_.topics.end(),
                                  [](const BagTopic& t) { return t.as == TopicRole::reference; });
  if (topic == map_.topics.end()) return;
  if (of_transforms_) {
    const bool has_static = static_transforms_ != topic->topic && count_.contains(static_transforms_);
    auto path = transforms_.path(topic->frame, topic->child_frame, bag_,
                                 topic->topic + (has_static ? " and " + static_transforms_ : ""));
    for (const StampedPose& at : path.poses)
      reference_.push_back({at.time, at.T_odom_robot * topic->T_robot_sensor.inverse()});
    for (const std::string& remark : path.remarks) reference_remarks_.push_back(topic->topic + ": " + remark);
  }
  stableSort(reference_, [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  const auto repeated =
      std::unique(reference_.begin(), reference_.end(),
                  [](const StampedPose& a, const StampedPose& b) { return a.time == b.time; });
  reference_.erase(repeated, reference_.end());
  if (!reference_.empty()) compareWithSensors(*topic);
}

/// One on another clock than theirs is none.
void BagImporter::compareWithSensors(const BagTopic& topic) {
  const Time first = *order_.first(), last = *order_.last();
  const double before_s = secondsBetween(reference_.back().time, first),
               after_s = secondsBetween(last, reference_.front().time);
  if (before_s > 0 || after_s > 0)
    throw Error(bag_, topic.topic,
                print("its stamps have no time in common with the sensors': they are %.3f s %s",
                      std::max(before_s, after_s), before_s > 0 ? "before them" : "after them") +
                    kTakeArrival);
  const double ahead_s = reference_clocks_.aheadOf(clocks_);
  if (std::abs(ahead_s) > options_.reorder_window_s)
    reference_remarks_.push_back(topic.topic +
                                 print(": its stamps are %.3f s %s the sensors', as they arrived",
                                       std::abs(ahead_s), ahead_s > 0 ? "ahead of" : "behind") +
                                 kTakeArrival);
}

}  // namespace fathom
