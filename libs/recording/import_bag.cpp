#include "recording/import_bag.h"

#include <console_bridge/console.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <new>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "recording/axes.h"
#include "recording/bag_check.h"
#include "recording/ros_messages.h"

namespace fathom {
namespace {

// ---- ROS types to ours ----

Vector3d toVector(const ros1::Vector3& v) { return {v.x, v.y, v.z}; }
Vector3d toVector(const ros1::Point& p) { return {p.x, p.y, p.z}; }

Time toTime(const ros::Time& stamp) {
  return fromUnixSeconds(stamp.sec) + mrpt::Clock::duration((stamp.nsec + 50) / 100);
}

const std::vector<std::string>& typesOf(TopicRole role) {
  static const std::map<TopicRole, std::vector<std::string>> kTypes{
      {TopicRole::ins, {"sensor_msgs/Imu"}},
      {TopicRole::dvl, {"nav_msgs/Odometry", "geometry_msgs/TwistWithCovarianceStamped"}},
      {TopicRole::dvl_beams, {"sensor_msgs/Range"}},
      {TopicRole::depth, {"sensor_msgs/FluidPressure"}},
      {TopicRole::usbl, {"geometry_msgs/PoseWithCovarianceStamped"}},
      {TopicRole::camera, {"sensor_msgs/Image", "sensor_msgs/CompressedImage"}},
      {TopicRole::reference, {"nav_msgs/Odometry", "geometry_msgs/PoseWithCovarianceStamped"}}};
  return kTypes.at(role);
}

/// One message, where it stands for error messages, and the checks that every field goes through.
class Message {
 public:
  Message(const rosbag::MessageInstance& instance, const std::string& bag, std::size_t number)
      : instance_(instance), bag_(bag), number_(number) {}

  template <class M>
  boost::shared_ptr<M> as() const {
    auto message = instance_.instantiate<M>();
    if (!message) throw error("its definition is not that of " + instance_.getDataType());
    if (message->header.stamp.isZero()) throw error("has no time stamp");
    return message;
  }
  bool is(const std::string& type) const { return instance_.getDataType() == type; }

  Vector3d finite(const Vector3d& v, const std::string& field) const {
    if (!v.allFinite()) throw error(field + " is not finite");
    return v;
  }
  double finite(double value, const std::string& field) const {
    if (!std::isfinite(value)) throw error(field + " is not finite");
    return value;
  }
  Matrix3d rotation(const ros1::Quaternion& q) const {
    const Eigen::Quaterniond quaternion(q.w, q.x, q.y, q.z);
    if (!quaternion.coeffs().allFinite() || std::abs(quaternion.norm() - 1.0) > 1e-2)
      throw error("orientation is not a unit quaternion");
    return quaternion.normalized().toRotationMatrix();
  }
  Error error(const std::string& why) const {
    return {bag_, instance_.getTopic() + ", message " + std::to_string(number_), why};
  }

 private:
  const rosbag::MessageInstance& instance_;
  const std::string& bag_;
  std::size_t number_;
};

/// Sigma from the largest variance on a part of a covariance's diagonal; nothing where it is not given.
template <std::size_t N>
std::optional<double> sigmaFrom(const boost::array<double, N>& covariance, int first, int count) {
  constexpr int kSize = N == 36 ? 6 : 3;
  static_assert(N == 36 || N == 9);
  const Eigen::Map<const Eigen::Matrix<double, kSize, kSize, Eigen::RowMajor>> c(covariance.data());
  const double largest = c.diagonal().segment(first, count).maxCoeff();
  return largest > 0.0 && std::isfinite(largest) ? std::optional(std::sqrt(largest)) : std::nullopt;
}

// ---- images ----

/// OpenCV names a Bayer pattern by its second row, ROS by its first.
cv::Mat toBgr(const cv::Mat& raw, const std::string& encoding) {
  static const std::map<std::string, int> kConversions{{"rgb8", cv::COLOR_RGB2BGR},
                                                       {"bayer_rggb8", cv::COLOR_BayerBG2BGR},
                                                       {"bayer_bggr8", cv::COLOR_BayerRG2BGR},
                                                       {"bayer_gbrg8", cv::COLOR_BayerGR2BGR},
                                                       {"bayer_grbg8", cv::COLOR_BayerGB2BGR}};
  const auto conversion = kConversions.find(encoding);
  if (conversion == kConversions.end()) return raw;
  cv::Mat bgr;
  cv::cvtColor(raw, bgr, conversion->second);
  return bgr;
}

std::vector<unsigned char> encodePng(const ros1::Image& image, const Message& message) {
  const std::string& encoding = image.encoding;
  const bool colour = encoding == "bgr8" || encoding == "rgb8";
  const bool bayer = encoding == "bayer_rggb8" || encoding == "bayer_bggr8" || encoding == "bayer_gbrg8" ||
                     encoding == "bayer_grbg8";
  if (!colour && !bayer && encoding != "mono8")
    throw message.error("image encoding `" + encoding + "` is not known (mono8, bgr8, rgb8, bayer_*8 are)");
  const std::size_t row_bytes = static_cast<std::size_t>(image.width) * (colour ? 3 : 1);
  if (image.width == 0 || image.height == 0 || image.step < row_bytes ||
      image.data.size() < static_cast<std::size_t>(image.step) * image.height)
    throw message.error("image data does not fit its width, height and step");
  auto* pixels = const_cast<unsigned char*>(image.data.data());  // cv::Mat has no view of constant data
  const cv::Mat raw(static_cast<int>(image.height), static_cast<int>(image.width), colour ? CV_8UC3 : CV_8UC1,
                    pixels, image.step);
  std::vector<unsigned char> png;
  if (!cv::imencode(".png", toBgr(raw, encoding), png)) throw message.error("image cannot be encoded as PNG");
  return png;
}

std::string compressedExtension(const std::vector<unsigned char>& bytes, const Message& message) {
  const auto starts = [&](std::initializer_list<unsigned char> magic) {
    return bytes.size() > magic.size() && std::equal(magic.begin(), magic.end(), bytes.begin());
  };
  if (starts({0x89, 'P', 'N', 'G'})) return ".png";
  if (starts({0xFF, 0xD8, 0xFF})) return ".jpg";
  throw message.error("compressed image is neither PNG nor JPEG");
}

void writeBytes(const std::filesystem::path& file, const std::vector<unsigned char>& bytes) {
  writeTextFile(file, std::string(bytes.begin(), bytes.end()));
}

// ---- order ----

/// Puts samples in time order as they come, within a window.
class ReorderBuffer {
 public:
  ReorderBuffer(double window_s, SampleSink sink) : window_s_(window_s), sink_(std::move(sink)) {}

  void push(Sample sample, const Message& message) {
    if (last_ && sample.time < *last_)
      throw message.error("its stamp is older than its predecessors' by more than the reorder window of " +
                          std::to_string(window_s_) + " s");
    waiting_.emplace(sample.time, std::move(sample));
    while (secondsBetween(waiting_.begin()->first, waiting_.rbegin()->first) > window_s_) release();
  }
  /// The waiting beams of this time, if any.
  DvlBeamsSample* beamsAt(Time time) {
    const auto [first, end] = waiting_.equal_range(time);
    for (auto it = first; it != end; ++it)
      if (auto* beams = std::get_if<DvlBeamsSample>(&it->second.reading)) return beams;
    return nullptr;
  }
  void flush() {
    while (!waiting_.empty()) release();
  }
  std::optional<Time> first() const { return first_; }

 private:
  void release() {
    const auto oldest = waiting_.begin();
    last_ = oldest->first;
    if (!first_) first_ = last_;
    sink_(std::move(oldest->second));
    waiting_.erase(oldest);
  }

  double window_s_;
  SampleSink sink_;
  std::multimap<Time, Sample> waiting_;
  std::optional<Time> first_, last_;
};

// ---- what the vehicle file is made of ----

struct Pace {
  std::size_t count = 0;
  Time first{}, last{};

  void add(Time time) {
    if (count++ == 0) first = last = time;
    first = std::min(first, time);
    last = std::max(last, time);
  }
  double rate_hz() const {
    const double span = secondsBetween(first, last);
    return span > 0.0 ? static_cast<double>(count - 1) / span : 1.0;
  }
};

struct Sigmas {
  std::optional<double> gyro, accelerometer, attitude, velocity_xy, velocity_z, pressure, position, range;
};

// ---- consistency of the mounting ----

/// Sums that tell what the INS's orientation means and whether its mounting agrees with the odometry.
class MountingChecks {
 public:
  explicit MountingChecks(double gravity_m_s2) : gravity_(gravity_m_s2) {}

  void addIns(const BagTopic& topic, const std::optional<Matrix3d>& orientation,
              const std::optional<Vector3d>& force_ins) {
    if (!force_ins) return;
    const Vector3d force_robot = topic.T_robot_sensor.rotation * *force_ins;
    force_robot_ += force_robot, ++forces_;
    total_force_robot_ += force_robot, ++total_forces_;
    if (!orientation) return;
    ++oriented_;
    as_sensor_ += (*orientation * *force_ins - up()).squaredNorm();
    as_robot_ += (*orientation * force_robot - up()).squaredNorm();
  }

  /// Odometry, robot axes. Compared over windows of a second: shorter ones drown in vibration.
  void addOdometry(Time time, const Vector3d& velocity, const Vector3d& rate) {
    if (readings_ == 0) {
      start_ = time;
      start_velocity_ = velocity;
    }
    turning_ += rate.cross(velocity);
    ++readings_;
    const double span = secondsBetween(start_, time);
    if (span < 1.0) return;
    if (forces_ > 0 && span < 3.0)  // a longer one has a gap in it
      force_axes_.add((velocity - start_velocity_) / span + turning_ / static_cast<double>(readings_) + up(),
                      force_robot_ / static_cast<double>(forces_));
    force_robot_ = turning_ = Vector3d::Zero();
    forces_ = readings_ = 0;
    start_ = time;
    start_velocity_ = velocity;
  }

  std::vector<Conclusion> conclusions(const BagTopic& ins) const {
    std::vector<Conclusion> all;
    if (total_forces_ > 0) all.push_back(gravityConclusion());
    if (oriented_ > 0 && angleBetween(ins.T_robot_sensor.rotation, Matrix3d::Identity()) > 1e-6)
      all.push_back(orientationConclusion(ins));
    if (force_axes_.count() >= 10) all.push_back(axesConclusion());
    return all;
  }

 private:
  Vector3d up() const { return {0, 0, gravity_}; }

  Conclusion gravityConclusion() const {
    const Vector3d mean = total_force_robot_ / static_cast<double>(total_forces_);
    const double tilt_rad = std::acos(std::clamp(mean.z() / mean.norm(), -1.0, 1.0));
    const bool upright = tilt_rad < radians(20);
    return {"INS mounting against gravity",
            upright ? "the map's pose turns gravity upright" : "the map's pose does not turn gravity upright",
            "", 0.0,
            print("mean specific force in the robot's axes (%.3f, %.3f, %.3f) m/s2, %.2f deg off up",
                  mean.x(), mean.y(), mean.z(), degrees(tilt_rad))};
  }

  Conclusion orientationConclusion(const BagTopic& ins) const {
    const double count = static_cast<double>(oriented_);
    const double sensor = std::sqrt(as_sensor_ / count), robot = std::sqrt(as_robot_ / count);
    const bool is_robot = robot < sensor;
    std::string concluded = is_robot ? "the robot's attitude" : "the sensor's own attitude";
    concluded += is_robot == ins.orientation_is_robot ? ", as the map says" : ", but the map says otherwise";
    return {"orientation in the INS's messages", concluded,
            is_robot ? "the sensor's own attitude" : "the robot's attitude",
            std::max(sensor, robot) / std::max(std::min(sensor, robot), 1e-12),
            print("specific force turned into the world against gravity, RMS %.3g m/s2 against %.3g m/s2",
                  std::min(sensor, robot), std::max(sensor, robot))};
  }

  Conclusion axesConclusion() const {
    auto ranked = force_axes_.ranking();
    std::erase_if(ranked, [](const AxesScore& s) { return !s.axes.proper(); });  // a mounting is no mirror
    const AxesScore &best = ranked[0], &other = ranked[1];
    std::string evidence = print(
        "acceleration from odometry plus gravity against accelerometer, %zu windows of "
        "1 s, RMS (%.2f, %.2f, %.2f) m/s2 against (%.2f, %.2f, %.2f)",
        force_axes_.count(), best.residual_rms.x(), best.residual_rms.y(), best.residual_rms.z(),
        other.residual_rms.x(), other.residual_rms.y(), other.residual_rms.z());
    return {"INS mounting against odometry",
            best.axes == SignedAxes{}
                ? "the map's pose fits best of the 24 right-angled ones"
                : "axes " + best.axes.text() + " after the map's pose fit better (not corrected)",
            "axes " + other.axes.text() + " after the map's pose",
            std::exp((best.log_likelihood - other.log_likelihood) / static_cast<double>(force_axes_.count())),
            evidence};
  }

  double gravity_;
  double as_sensor_ = 0.0, as_robot_ = 0.0;
  Vector3d total_force_robot_ = Vector3d::Zero();
  std::size_t oriented_ = 0, total_forces_ = 0;
  // the current window
  Time start_{};
  Vector3d start_velocity_ = Vector3d::Zero(), turning_ = Vector3d::Zero(), force_robot_ = Vector3d::Zero();
  std::size_t forces_ = 0, readings_ = 0;
  AxesEvidence force_axes_;
};

// ---- the importer ----

/// ROS prints what it throws; here the Error says it.
struct SilentRos {
  SilentRos() { console_bridge::noOutputHandler(); }
  ~SilentRos() { console_bridge::restorePreviousOutputHandler(); }
  SilentRos(const SilentRos&) = delete;
  SilentRos& operator=(const SilentRos&) = delete;
};

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
  void take(const BagTopic& topic, const Message& message);
  void takeIns(const BagTopic& topic, const Message& message);
  void takeDvl(const BagTopic& topic, const Message& message);
  void takeBeam(const BagTopic& topic, const Message& message);
  void takeDepth(const BagTopic& topic, const Message& message);
  void takeUsbl(const BagTopic& topic, const Message& message);
  void takeImage(const BagTopic& topic, const Message& message);
  void takeReference(const BagTopic& topic, const Message& message);
  void push(const BagTopic& topic, Time time, Reading reading, const Message& message) {
    paces_[topic.as].add(time);
    order_.push({time, roleName(topic.as), std::move(reading)}, message);
  }
  void sortReference();
  std::string vehicleYaml() const;

  std::string bag_;
  const TopicMap& map_;
  BagOptions options_;
  ReorderBuffer order_;
  MountingChecks checks_;
  std::vector<const BagTopic*> beams_;
  std::map<TopicRole, Pace> paces_;
  Sigmas sigmas_;
  std::vector<StampedPose> reference_;
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
    const auto& suitable = typesOf(topic.as);
    if (std::find(suitable.begin(), suitable.end(), found->second) != suitable.end()) continue;
    std::string wanted;
    for (const std::string& type : suitable) wanted += (wanted.empty() ? "" : " or ") + type;
    throw Error(bag_, topic.topic,
                std::string("is a ") + found->second + "; " + roleName(topic.as) + " is made of " + wanted);
  }
}

void BagImporter::take(const BagTopic& topic, const Message& message) {
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

void BagImporter::takeIns(const BagTopic& topic, const Message& message) {
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
  if (paces_[topic.as].count == 0) {
    if (sample.angular_velocity_ins) sigmas_.gyro = sigmaFrom(imu->angular_velocity_covariance, 0, 3);
    if (sample.specific_force_ins)
      sigmas_.accelerometer = sigmaFrom(imu->linear_acceleration_covariance, 0, 3);
    if (orientation) sigmas_.attitude = sigmaFrom(imu->orientation_covariance, 0, 3);
  }
  checks_.addIns(topic, orientation, sample.specific_force_ins);
  push(topic, toTime(imu->header.stamp), std::move(sample), message);
}

void BagImporter::takeDvl(const BagTopic& topic, const Message& message) {
  ros1::TwistWithCovariance twist;
  Time time;
  if (message.is("nav_msgs/Odometry")) {
    const auto odometry = message.as<ros1::Odometry>();
    twist = odometry->twist;
    time = toTime(odometry->header.stamp);
    const Matrix3d& R_robot_dvl = topic.T_robot_sensor.rotation;
    checks_.addOdometry(time, R_robot_dvl * toVector(twist.twist.linear),
                        R_robot_dvl * toVector(twist.twist.angular));
  } else {
    const auto stamped = message.as<ros1::TwistWithCovarianceStamped>();
    twist = stamped->twist;
    time = toTime(stamped->header.stamp);
  }
  const Vector3d velocity_dvl = message.finite(toVector(twist.twist.linear), "twist.linear");
  if (paces_[topic.as].count == 0) {
    sigmas_.velocity_xy = sigmaFrom(twist.covariance, 0, 2);
    sigmas_.velocity_z = sigmaFrom(twist.covariance, 2, 1);
  }
  push(topic, time, DvlSample{topic.T_robot_sensor, velocity_dvl}, message);
}

void BagImporter::takeBeam(const BagTopic& topic, const Message& message) {
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

void BagImporter::takeDepth(const BagTopic& topic, const Message& message) {
  const auto pressure = message.as<ros1::FluidPressure>();
  const double pressure_pa = message.finite(pressure->fluid_pressure, "fluid_pressure");
  if (paces_[topic.as].count == 0 && pressure->variance > 0.0)
    sigmas_.pressure = std::sqrt(message.finite(pressure->variance, "variance"));
  push(topic, toTime(pressure->header.stamp), DepthSample{topic.T_robot_sensor, pressure_pa, {}}, message);
}

void BagImporter::takeUsbl(const BagTopic& topic, const Message& message) {
  const auto fix = message.as<ros1::PoseWithCovarianceStamped>();
  const Vector3d position = message.finite(toVector(fix->pose.pose.position), "position");
  constexpr double kUnknownAngle = 1e6;  // rad²: a USBL measures no orientation
  PoseSample sample;
  sample.T_odom_robot.mean = Pose{Matrix3d::Identity(), position}.toMrpt();
  sample.T_odom_robot.cov.setZero();
  const Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(
      fix->pose.covariance.data());
  for (int i = 0; i < 3; ++i) {
    sample.T_odom_robot.cov(i + 3, i + 3) = kUnknownAngle;
    for (int j = 0; j < 3; ++j)
      sample.T_odom_robot.cov(i, j) = message.finite(covariance(i, j), "covariance");
  }
  if (paces_[topic.as].count == 0) sigmas_.position = sigmaFrom(fix->pose.covariance, 0, 3);
  push(topic, toTime(fix->header.stamp), std::move(sample), message);
}

void BagImporter::takeImage(const BagTopic& topic, const Message& message) {
  std::vector<unsigned char> bytes;
  std::string extension = ".png";
  ros::Time stamp;
  if (message.is("sensor_msgs/Image")) {
    const auto image = message.as<ros1::Image>();
    if (image->width != topic.intrinsics->ncols || image->height != topic.intrinsics->nrows)
      throw message.error("image is " + std::to_string(image->width) + " x " + std::to_string(image->height) +
                          " px, the map's intrinsics are for another size");
    bytes = encodePng(*image, message);
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

void BagImporter::takeReference(const BagTopic& topic, const Message& message) {
  ros1::Pose pose;
  Time time;
  if (message.is("nav_msgs/Odometry")) {
    const auto odometry = message.as<ros1::Odometry>();
    pose = odometry->pose.pose;
    time = toTime(odometry->header.stamp);
  } else {
    const auto stamped = message.as<ros1::PoseWithCovarianceStamped>();
    pose = stamped->pose.pose;
    time = toTime(stamped->header.stamp);
  }
  const Pose T_odom_sensor{message.rotation(pose.orientation),
                           message.finite(toVector(pose.position), "position")};
  reference_.push_back({time, T_odom_sensor * topic.T_robot_sensor.inverse()});
}

void BagImporter::sortReference() {
  std::stable_sort(reference_.begin(), reference_.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  const auto repeated =
      std::unique(reference_.begin(), reference_.end(),
                  [](const StampedPose& a, const StampedPose& b) { return a.time == b.time; });
  reference_.erase(repeated, reference_.end());
}

// ---- vehicle file ----

/// "key: value  # from where": the bag's own covariance, else a generic value, and it says so.
std::string sigmaLine(const char* key, std::optional<double> from_bag, double generic) {
  char line[160];
  std::snprintf(line, sizeof line, "  %s: %.4g   # %s\n", key, from_bag.value_or(generic),
                from_bag ? "covariance of the first message" : "generic: the bag does not say");
  return line;
}

std::string poseLine(const Pose& pose) { return "  pose: " + yamlPose(pose) + "\n"; }

std::string rateLine(const Pace& pace) {
  char line[80];
  std::snprintf(line, sizeof line, "  rate_hz: %.4g   # mean over the bag\n", pace.rate_hz());
  return line;
}

std::string BagImporter::vehicleYaml() const {
  std::ostringstream yaml;
  yaml << "# From a ROS bag. Sigmas are the messages' own covariances where they are given.\n"
       << "gravity_m_s2: " << map_.gravity_m_s2 << '\n';
  bool has_beams = false;
  for (const BagTopic& topic : map_.topics) {
    const auto found = paces_.find(topic.as);
    if (found == paces_.end() || found->second.count == 0) continue;
    const Pace& pace = found->second;
    switch (topic.as) {
      case TopicRole::ins:
        yaml << "ins:\n"
             << rateLine(pace) << sigmaLine("gyro_sigma_rad_s", sigmas_.gyro, 0.001)
             << sigmaLine("accelerometer_sigma_m_s2", sigmas_.accelerometer, 0.01)
             << sigmaLine("gyro_bias_sigma_rad_s", {}, 0.001)
             << sigmaLine("accelerometer_bias_sigma_m_s2", {}, 0.05)
             << sigmaLine("bias_time_constant_s", {}, 300);
        if (sigmas_.attitude) yaml << sigmaLine("attitude_sigma_deg", degrees(*sigmas_.attitude), 1.0);
        yaml << poseLine(topic.T_robot_sensor);
        break;
      case TopicRole::dvl:
        yaml << "dvl:\n"
             << rateLine(pace) << "  assumed_sound_speed_m_s: 1500   # generic\n"
             << sigmaLine("beam_sigma_m_s", {}, 0.007)
             << sigmaLine("velocity_sigma_xy_m_s", sigmas_.velocity_xy, 0.01)
             << sigmaLine("velocity_sigma_z_m_s", sigmas_.velocity_z, 0.01)
             << sigmaLine("range_sigma_m", {}, 0.015) << "  beam_angle_deg: 30   # generic\n"
             << "  beam_azimuths_deg: [0, 90, 180, 270]   # generic; beams in the recording carry their own "
                "poses\n"
             << poseLine(topic.T_robot_sensor);
        break;
      case TopicRole::depth:
        yaml << "depth:\n"
             << rateLine(pace) << sigmaLine("pressure_sigma_pa", sigmas_.pressure, 100)
             << sigmaLine("pressure_offset_sigma_pa", {}, 100)
             << "  atmospheric_pressure_pa: 101325   # standard atmosphere\n"
             << sigmaLine("water_density_kg_m3", {}, 1025) << poseLine(topic.T_robot_sensor);
        break;
      case TopicRole::usbl:
        yaml << "usbl:\n"
             << rateLine(pace) << sigmaLine("position_sigma_m", sigmas_.position, 0.5)
             << poseLine(topic.T_robot_sensor);
        break;
      case TopicRole::camera:
        yaml << "camera:\n"
             << rateLine(pace) << cameraLines(*topic.intrinsics) << poseLine(topic.T_robot_sensor);
        break;
      case TopicRole::dvl_beams:
        has_beams = true;
        break;
      case TopicRole::reference:
        break;
    }
  }
  if (has_beams && !paces_.contains(TopicRole::dvl))
    yaml << "# The recording has DVL_BEAMS, but no DVL: section dvl is left to the engineer.\n";
  return yaml.str();
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
  std::map<std::string, std::size_t> numbers;
  rosbag::View view(bag, rosbag::TopicQuery(topics));
  for (const rosbag::MessageInstance& instance : view) {
    const Message message(instance, bag_, ++numbers[instance.getTopic()]);
    for (const BagTopic& topic : map_.topics)
      if (topic.topic == instance.getTopic()) take(topic, message);
  }
  order_.flush();
  if (!order_.first()) throw Error(bag_, "", "has no message of a sensor in " + map_.file);

  sortReference();
  ImportedRecording recording;
  recording.header.description = map_.description.empty()
                                     ? "ROS bag " + std::filesystem::path(bag_).filename().string()
                                     : map_.description;
  recording.start = *order_.first();
  recording.reference = std::move(reference_);
  recording.vehicle_yaml = vehicleYaml();
  for (const BagTopic& topic : map_.topics)
    if (topic.as == TopicRole::ins) recording.conclusions = checks_.conclusions(topic);
  return recording;
}

}  // namespace

ImportedRecording streamBag(const std::filesystem::path& bag, const TopicMap& map, const SampleSink& sink,
                            const BagOptions& options) {
  const auto unreadable = [&](const std::string& why) {
    return Error(bag.string(), "", "not a ROS 1 bag, or truncated or damaged: " + why);
  };
  if (!std::filesystem::is_regular_file(bag)) throw Error(bag.string(), "", "cannot be read");
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
