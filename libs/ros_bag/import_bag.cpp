#include "ros_bag/import_bag.h"

#include <console_bridge/console.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <cstdio>
#include <functional>
#include <map>
#include <new>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "ros_bag/bag_check.h"
#include "ros_bag/bag_image.h"
#include "ros_bag/bag_message.h"
#include "ros_bag/bag_pose.h"
#include "ros_bag/bag_vehicle.h"
#include "ros_bag/mounting_checks.h"
#include "ros_bag/reorder_buffer.h"
#include "ros_bag/transform_tree.h"

namespace fathom {
namespace {

void writeBytes(const std::filesystem::path& file, const std::vector<unsigned char>& bytes) {
  writeTextFile(file, std::string(bytes.begin(), bytes.end()));
}

/// ROS prints what it throws; here the Error says it.
struct SilentRos {
  SilentRos() { console_bridge::noOutputHandler(); }
  ~SilentRos() { console_bridge::restorePreviousOutputHandler(); }
  SilentRos(const SilentRos&) = delete;
  SilentRos& operator=(const SilentRos&) = delete;
};

/// Whether a driver says by a velocity, or by its variance, that it has none: it has no other way in a twist.
bool isWithoutLock(const Vector3d& velocity, double first_variance) {
  constexpr double kUnknownVariance = 1e4;      // (100 m/s)²
  constexpr double kBadVelocity_mm_s = -32768;  // PD0
  const auto isBad = [&](double v) {
    return v == kBadVelocity_mm_s || std::abs(v - kBadVelocity_mm_s / 1000) < 1e-6;
  };
  return !velocity.allFinite() || first_variance < 0 || !(first_variance < kUnknownVariance) ||
         isBad(velocity.x()) || isBad(velocity.y()) || isBad(velocity.z());
}

constexpr const char* kStaticTransforms = "/tf_static";  // by REP 105's convention, beside /tf

bool isTransforms(const BagMessage& message) {
  return message.is("tf2_msgs/TFMessage") || message.is("tf/tfMessage");
}

class BagImporter {
 public:
  BagImporter(const std::filesystem::path& bag, const TopicMap& map, SampleSink sink,
              const BagOptions& options)
      : bag_(bag.string()),
        map_(map),
        options_(options),
        order_(options.reorder_window_s, std::move(sink)),
        checks_(map.gravity_m_s2) {
    for (const BagTopic& topic : map.topics)
      if (topic.as == TopicRole::dvl_beams) beams_.push_back(&topic);
  }

  ImportedRecording run();

 private:
  void checkTopics(const rosbag::Bag& bag) const;
  void take(const BagTopic& topic, const BagMessage& message);
  void takeOrLeaveOut(const std::string& topic, const std::function<void()>& take);
  void refuseUnusableTopics() const;
  std::vector<std::string> remarks() const;
  void takeIns(const BagTopic& topic, const BagMessage& message);
  void takeDvl(const BagTopic& topic, const BagMessage& message);
  void takeBeam(const BagTopic& topic, const BagMessage& message);
  void takeDepth(const BagTopic& topic, const BagMessage& message);
  void takeDepthOfPose(const BagTopic& topic, const BagMessage& message);
  void takeUsbl(const BagTopic& topic, const BagMessage& message);
  void takeImage(const BagTopic& topic, const BagMessage& message);
  void takeReference(const BagTopic& topic, const BagMessage& message);
  void push(const BagTopic& topic, Time time, Reading reading, const BagMessage& message) {
    paces_[topic.as].add(time);
    order_.push({time, roleName(topic.as), std::move(reading)}, message);
  }
  void takeTransform(const ros1::TransformStamped& transform, const BagMessage& message, bool for_good);
  void takeTransforms(const BagMessage& message, bool for_good);
  void finishReference();

  std::string bag_;
  const TopicMap& map_;
  BagOptions options_;
  ReorderBuffer order_;
  MountingChecks checks_;
  std::vector<const BagTopic*> beams_;
  std::map<TopicRole, MessagePace> paces_;
  MessageSigmas sigmas_;
  std::vector<StampedPose> reference_;
  TransformTree transforms_;
  std::map<std::string, std::size_t> without_lock_;       ///< by topic
  std::map<std::string, std::vector<BadMessage>> bad_;    ///< by topic, the first ones
  std::map<std::string, std::size_t> bad_count_, count_;  ///< by topic
};

void BagImporter::checkTopics(const rosbag::Bag& bag) const {
  rosbag::View view(bag);
  std::map<std::string, std::string> types;
  for (const auto* connection : view.getConnections()) types[connection->topic] = connection->datatype;
  std::ostringstream present;
  for (const auto& [topic, type] : types)
    present << (present.tellp() > 0 ? ", " : "") << topic << " (" << type << ')';
  if (types.empty()) present << "nothing";
  for (const BagTopic& topic : map_.topics) {
    const auto found = types.find(topic.topic);
    if (found == types.end())
      throw Error(bag_, topic.topic,
                  "no such topic (" + map_.file + " asks for it); the bag has " + present.str());
    const auto& suitable = messageTypesOf(topic.as);
    if (std::find(suitable.begin(), suitable.end(), found->second) != suitable.end()) continue;
    std::string wanted;
    for (const std::string& type : suitable) wanted += (wanted.empty() ? "" : " or ") + type;
    throw Error(bag_, topic.topic,
                std::string("is a ") + found->second + "; " + roleName(topic.as) + " is made of " + wanted);
  }
}

void BagImporter::take(const BagTopic& topic, const BagMessage& message) {
  switch (topic.as) {
    case TopicRole::ins:
      return takeIns(topic, message);
    case TopicRole::dvl:
      return takeDvl(topic, message);
    case TopicRole::dvl_beams:
      return takeBeam(topic, message);
    case TopicRole::depth:
      return takeDepth(topic, message);
    case TopicRole::usbl:
      return takeUsbl(topic, message);
    case TopicRole::camera:
      return takeImage(topic, message);
    case TopicRole::reference:
      return takeReference(topic, message);
  }
}

/// One bad message does not refuse a bag.
void BagImporter::takeOrLeaveOut(const std::string& topic, const std::function<void()>& take) {
  constexpr std::size_t kQuoted = 3;
  try {
    take();
  } catch (const BadMessage& bad) {
    if (options_.strict) throw;
    ++bad_count_[topic];
    if (bad_[topic].size() < kQuoted) bad_[topic].push_back(bad);
  }
}

/// Of which no message at all can be used.
void BagImporter::refuseUnusableTopics() const {
  for (const auto& [topic, count] : bad_count_)
    if (count >= count_.at(topic)) throw Error(bad_.at(topic).front());
}

std::vector<std::string> BagImporter::remarks() const {
  std::vector<std::string> lines;
  for (const auto& [topic, count] : without_lock_)
    lines.push_back(topic +
                    print(": %zu of %zu messages say that there is no bottom lock", count, count_.at(topic)));
  for (const auto& [topic, count] : bad_count_) {
    std::string line = topic + print(": %zu of %zu messages are left out", count, count_.at(topic));
    const char* between = ": ";
    for (const BadMessage& bad : bad_.at(topic)) {
      line.append(between).append(bad.where).append(": ").append(bad.why);
      between = "; ";
    }
    lines.push_back(line);
  }
  return lines;
}

void BagImporter::takeIns(const BagTopic& topic, const BagMessage& message) {
  const auto imu = message.as<ros1::Imu>();
  std::optional<Matrix3d> orientation;
  InsSample sample{topic.T_robot_sensor, {}, {}, {}};
  if (topic.use_orientation && imu->orientation_covariance[0] >= 0)
    orientation = message.rotation(imu->orientation);
  if (topic.use_rate && imu->angular_velocity_covariance[0] >= 0)
    sample.angular_velocity_ins = message.finite(toVector(imu->angular_velocity), "angular_velocity");
  if (topic.use_acceleration && imu->linear_acceleration_covariance[0] >= 0)
    sample.specific_force_ins = message.finite(toVector(imu->linear_acceleration), "linear_acceleration");
  if (orientation)
    sample.R_odom_ins =
        topic.orientation_is_robot ? Matrix3d(*orientation * topic.T_robot_sensor.rotation) : *orientation;
  if (sample.angular_velocity_ins) sigmas_.gyro.add(sigmaFrom(imu->angular_velocity_covariance, 0, 3));
  if (sample.specific_force_ins)
    sigmas_.accelerometer.add(sigmaFrom(imu->linear_acceleration_covariance, 0, 3));
  if (orientation) sigmas_.attitude.add(sigmaFrom(imu->orientation_covariance, 0, 3));
  checks_.addIns(topic, orientation, sample.specific_force_ins);
  push(topic, toTime(imu->header.stamp), std::move(sample), message);
}

void BagImporter::takeDvl(const BagTopic& topic, const BagMessage& message) {
  ros1::TwistWithCovariance twist;
  Time time;
  if (message.is("nav_msgs/Odometry")) {
    const auto odometry = message.as<ros1::Odometry>();
    twist = odometry->twist;
    time = toTime(odometry->header.stamp);
  } else if (message.is("geometry_msgs/TwistStamped")) {
    const auto stamped = message.as<ros1::TwistStamped>();
    twist.twist = stamped->twist;
    time = toTime(stamped->header.stamp);
  } else {
    const auto stamped = message.as<ros1::TwistWithCovarianceStamped>();
    twist = stamped->twist;
    time = toTime(stamped->header.stamp);
  }
  const Vector3d velocity_dvl = toVector(twist.twist.linear);
  if (isWithoutLock(velocity_dvl, twist.covariance[0])) {
    ++without_lock_[topic.topic];
    return push(topic, time, DvlSample{topic.T_robot_sensor, {}}, message);
  }
  if (message.is("nav_msgs/Odometry")) {
    const Matrix3d& R_robot_dvl = topic.T_robot_sensor.rotation;
    checks_.addOdometry(time, R_robot_dvl * velocity_dvl, R_robot_dvl * toVector(twist.twist.angular));
  }
  sigmas_.velocity_xy.add(sigmaFrom(twist.covariance, 0, 2));
  sigmas_.velocity_z.add(sigmaFrom(twist.covariance, 2, 1));
  push(topic, time, DvlSample{topic.T_robot_sensor, velocity_dvl}, message);
}

void BagImporter::takeBeam(const BagTopic& topic, const BagMessage& message) {
  const auto range = message.as<ros1::Range>();
  if (std::isnan(range->range)) throw message.error("range is not a number");
  std::optional<double> range_m;  // REP 117: infinite or outside the limits is no echo
  if (std::isfinite(range->range) && range->range >= range->min_range && range->range <= range->max_range)
    range_m = range->range;

  const Time time = toTime(range->header.stamp);
  const auto place = std::find(beams_.begin(), beams_.end(), &topic) - beams_.begin();
  if (DvlBeamsSample* waiting = order_.beamsAt(time)) {
    waiting->beams[static_cast<std::size_t>(place)].range_m = range_m;
    return;
  }
  DvlBeamsSample sample;
  for (const BagTopic* beam : beams_) sample.beams.push_back({beam->T_robot_sensor, {}});
  sample.beams[static_cast<std::size_t>(place)].range_m = range_m;
  push(topic, time, std::move(sample), message);
}

void BagImporter::takeDepth(const BagTopic& topic, const BagMessage& message) {
  if (!message.is("sensor_msgs/FluidPressure")) return takeDepthOfPose(topic, message);
  const auto pressure = message.as<ros1::FluidPressure>();
  const double pressure_pa = message.finite(pressure->fluid_pressure, "fluid_pressure");
  sigmas_.pressure.add(pressure->variance > 0.0 ? std::sqrt(pressure->variance) : 0.0);
  push(topic, toTime(pressure->header.stamp), DepthSample{topic.T_robot_sensor, pressure_pa, {}}, message);
}

/// A depth that somebody has computed, as the pressure that generic water and air make of it.
void BagImporter::takeDepthOfPose(const BagTopic& topic, const BagMessage& message) {
  const auto pressureAt = [&](double z_m) {
    Inputs<double> in;
    in.state.R_odom_robot.setIdentity();
    in.state.position_odom = {0, 0, z_m};
    in.world.gravity_odom = {0, 0, -map_.gravity_m_s2};
    return Depth::pressure(in, DepthSheet{}, Pose{});
  };
  const BagPose pose = poseOf(message);
  const double z_m = message.finite(pose.position.z(), "position.z"), pressure_pa = pressureAt(z_m);
  if (pose.covariance)
    sigmas_.pressure.add(std::sqrt(std::max(0.0, (*pose.covariance)(2, 2))) *
                         (pressureAt(z_m - 1) - pressure_pa));
  push(topic, pose.time, DepthSample{topic.T_robot_sensor, pressure_pa, {}}, message);
}

void BagImporter::takeUsbl(const BagTopic& topic, const BagMessage& message) {
  const BagPose fix = poseOf(message);
  constexpr double kUnknownAngle = 1e6;  // rad²: a USBL measures no orientation
  constexpr double kGenericSigma_m = 0.5;
  PoseSample sample;
  sample.T_odom_robot.mean = Pose{Matrix3d::Identity(), message.finite(fix.position, "position")};
  sample.T_odom_robot.covariance.setZero();
  sample.T_odom_robot.covariance.bottomRightCorner<3, 3>().diagonal().setConstant(kUnknownAngle);
  auto position = sample.T_odom_robot.covariance.topLeftCorner<3, 3>();
  if (fix.covariance) {
    for (int i = 0; i < 9; ++i)
      position(i / 3, i % 3) = message.finite((*fix.covariance)(i / 3, i % 3), "covariance");
    sigmas_.position.add(std::sqrt(std::max(0.0, position.diagonal().maxCoeff())));
  } else {
    position.diagonal().setConstant(kGenericSigma_m * kGenericSigma_m);
  }
  push(topic, fix.time, std::move(sample), message);
}

void BagImporter::takeImage(const BagTopic& topic, const BagMessage& message) {
  std::vector<unsigned char> bytes;
  std::string extension = ".png";
  ros::Time stamp;
  if (message.is("sensor_msgs/Image")) {
    const auto image = message.as<ros1::Image>();
    const CameraModel& expected = topic.intrinsics->model;
    if (image->width != static_cast<std::uint32_t>(expected.width_px) ||
        image->height != static_cast<std::uint32_t>(expected.height_px))
      throw message.error("image is " + std::to_string(image->width) + " x " + std::to_string(image->height) +
                          " px, the map's intrinsics are for another size");
    bytes = encodePng(*image, message);
    sigmas_.image_bits = bitsOf(image->encoding);
    stamp = image->header.stamp;
  } else {
    const auto image = message.as<ros1::CompressedImage>();
    bytes.assign(image->data.begin(), image->data.end());
    extension = compressedExtension(bytes, message);
    stamp = image->header.stamp;
  }
  char name[64];
  std::snprintf(name, sizeof name, "%s_%010u.%09u", roleName(topic.as), stamp.sec, stamp.nsec);
  writeBytes(options_.image_folder / (name + extension), bytes);
  push(topic, toTime(stamp), ImageSample{topic.T_robot_sensor, *topic.intrinsics, name + extension}, message);
}

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
  if (isTransforms(message)) return takeTransforms(message, false);
  const BagPose pose = poseOf(message);
  const Pose T_odom_sensor{message.rotation(pose.orientation), message.finite(pose.position, "position")};
  reference_.push_back({pose.time, T_odom_sensor * topic.T_robot_sensor.inverse()});
}

void BagImporter::finishReference() {
  for (const BagTopic& topic : map_.topics)
    if (topic.as == TopicRole::reference && !transforms_.empty())
      for (const StampedPose& at : transforms_.path(topic.frame, topic.child_frame, bag_, topic.topic))
        reference_.push_back({at.time, at.T_odom_robot * topic.T_robot_sensor.inverse()});
  stableSort(reference_, [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  const auto repeated =
      std::unique(reference_.begin(), reference_.end(),
                  [](const StampedPose& a, const StampedPose& b) { return a.time == b.time; });
  reference_.erase(repeated, reference_.end());
}

ImportedRecording BagImporter::run() {
  const bool has_camera = std::any_of(map_.topics.begin(), map_.topics.end(),
                                      [](const BagTopic& t) { return t.as == TopicRole::camera; });
  if (has_camera && options_.image_folder.empty())
    throw Error(map_.file, "CAMERA", "no folder is given for the images");

  rosbag::Bag bag;
  bag.open(bag_, rosbag::bagmode::Read);  // not in the constructor: that leaks when it throws
  checkTopics(bag);
  std::vector<std::string> topics;
  for (const BagTopic& topic : map_.topics) topics.push_back(topic.topic);
  const bool compares = std::any_of(map_.topics.begin(), map_.topics.end(),
                                    [](const BagTopic& t) { return t.as == TopicRole::reference; });
  if (compares) topics.emplace_back(kStaticTransforms);
  rosbag::View view(bag, rosbag::TopicQuery(topics));
  for (const rosbag::MessageInstance& instance : view) {
    const std::size_t number = ++count_[instance.getTopic()];
    for (const BagTopic& topic : map_.topics)
      if (topic.topic == instance.getTopic())
        takeOrLeaveOut(topic.topic, [&] { take(topic, {instance, bag_, number, topic.stamps}); });
    if (const BagMessage message(instance, bag_, number, TopicStamps::header);
        instance.getTopic() == kStaticTransforms && isTransforms(message))
      takeOrLeaveOut(kStaticTransforms, [&] { takeTransforms(message, true); });
  }
  order_.flush();
  refuseUnusableTopics();
  if (!order_.first()) throw Error(bag_, "", "has no message of a sensor in " + map_.file);

  finishReference();
  ImportedRecording recording;
  recording.header.description = map_.description.empty()
                                     ? "ROS bag " + std::filesystem::path(bag_).filename().string()
                                     : map_.description;
  recording.start = *order_.first();
  recording.reference = std::move(reference_);
  recording.vehicle_yaml = vehicleYaml(map_, paces_, sigmas_);
  for (const BagTopic& topic : map_.topics)
    if (topic.as == TopicRole::ins) recording.conclusions = checks_.conclusions(topic);
  recording.remarks = remarks();
  return recording;
}

}  // namespace

ImportedRecording streamBag(const std::filesystem::path& bag, const TopicMap& map, const SampleSink& sink,
                            const BagOptions& options) {
  const auto unreadable = [&](const std::string& why) {
    return Error(bag.string(), "", "not a ROS 1 bag, or truncated or damaged: " + why);
  };
  if (!isFile(bag)) throw Error(bag.string(), "", "cannot be read");
  checkBag(bag);
  const SilentRos silent;
  try {
    return BagImporter(bag, map, sink, options).run();
  } catch (const ros::Exception& problem) {
    throw unreadable(problem.what());
  } catch (const std::bad_alloc&) {
    throw unreadable("a length in it is absurd");
  } catch (const std::length_error&) {
    throw unreadable("a length in it is absurd");
  }
}

ImportedRecording importBag(const std::filesystem::path& bag, const TopicMap& map,
                            const BagOptions& options) {
  std::vector<Sample> samples;
  ImportedRecording recording = streamBag(
      bag, map, [&](Sample&& sample) { samples.push_back(std::move(sample)); }, options);
  recording.samples = std::move(samples);
  return recording;
}

}  // namespace fathom
