#pragma once

#include <rosbag/bag.h>

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "recording/imported.h"
#include "recording/reorder_buffer.h"
#include "ros_bag/bag_message.h"
#include "ros_bag/bag_options.h"
#include "ros_bag/bag_vehicle.h"
#include "ros_bag/mounting_checks.h"
#include "ros_bag/topic_clocks.h"
#include "ros_bag/transform_tree.h"

/// What imports a bag, one role of the topic map after another. Used within this room only: bag_importer.cpp
/// has the bag as a whole, bag_sensors.cpp each sensor's messages, bag_reference.cpp those of a reference.
namespace fathom {

/// Of messages with many transforms.
inline bool isTransforms(const std::string& type) {
  return type == "tf2_msgs/TFMessage" || type == "tf/tfMessage";
}

class BagImporter {
 public:
  BagImporter(const std::filesystem::path& bag, const TopicMap& map, SampleSink sink,
              const BagOptions& options)
      : bag_(bag.string()),
        map_(map),
        options_(options),
        clocks_(options.reorder_window_s),
        reference_clocks_(options.reorder_window_s),
        order_(options.reorder_window_s, std::move(sink)),
        checks_(map.gravity_m_s2) {
    for (const BagTopic& topic : map.topics)
      if (topic.as == TopicRole::dvl_beams) beams_.push_back(&topic);
  }

  ImportedRecording run();

 private:
  void checkTopics(const rosbag::Bag& bag);
  void take(const BagTopic& topic, const BagMessage& message);
  void takeOrLeaveOut(const std::string& topic, const std::function<void()>& take);
  void refuseUnusableTopics() const;
  Matrix3d rotationIn(const BagMessage& message, const ros1::Quaternion& q);
  std::vector<std::string> remarks() const;
  std::optional<Matrix3d> attitudeIn(const ros1::Imu& imu, const BagTopic& topic, const BagMessage& message);
  void takeIns(const BagTopic& topic, const BagMessage& message);
  void takeDvl(const BagTopic& topic, const BagMessage& message);
  void takeBeam(const BagTopic& topic, const BagMessage& message);
  void takeDepth(const BagTopic& topic, const BagMessage& message);
  void takeDepthOfPose(const BagTopic& topic, const BagMessage& message);
  void takeUsbl(const BagTopic& topic, const BagMessage& message);
  void takeImage(const BagTopic& topic, const BagMessage& message);
  void takeReference(const BagTopic& topic, const BagMessage& message);
  void push(const BagTopic& topic, Time time, Reading reading, const BagMessage& message);
  void takeTransform(const ros1::TransformStamped& transform, const BagMessage& message, bool for_good);
  void takeTransforms(const BagMessage& message, bool for_good);
  void finishReference();
  void compareWithSensors(const BagTopic& topic);

  std::string bag_;
  const TopicMap& map_;
  BagOptions options_;
  TopicClocks clocks_, reference_clocks_;
  ReorderBuffer order_;
  MountingChecks checks_;
  std::vector<const BagTopic*> beams_;
  std::map<TopicRole, MessagePace> paces_;
  MessageSigmas sigmas_;
  std::vector<StampedPose> reference_;
  TransformTree transforms_;
  bool of_transforms_ = false;     ///< the reference is
  std::string static_transforms_;  ///< the topic beside it
  std::vector<std::string> reference_remarks_;
  std::map<std::string, double> worst_norm_;                            ///< of quaternions, by topic
  std::map<std::string, std::size_t> without_lock_, without_attitude_;  ///< by topic
  std::map<std::string, std::vector<BadMessage>> bad_;                  ///< by topic, the first ones
  std::map<std::string, std::size_t> bad_count_, count_;                ///< by topic
  std::map<std::string, std::string> last_bad_;  ///< where, by topic: one of two roles counts once
};

}  // namespace fathom
