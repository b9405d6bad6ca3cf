#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "core/files.h"
#include "core/text.h"
#include "ros_bag/bag_image.h"
#include "ros_bag/bag_importer.h"
#include "ros_bag/bag_pose.h"

namespace fathom {
namespace {

void writeBytes(const std::filesystem::path& file, const std::vector<unsigned char>& bytes) {
  writeTextFile(file, std::string(bytes.begin(), bytes.end()));
}

constexpr double kUnknownVariance = 1e4;            // (100 m/s)²
constexpr double kUnknownAngleVariance_rad2 = 1e6;  // more than whole turns

/// The largest variance of the velocity, infinite where one of them says that it is not known. Wheels, whose
/// odometry is planar, say so of z and mean it.
double largestVariance(const ros1::TwistWithCovariance& twist, bool is_odometry) {
  double largest = 0;
  for (const std::size_t i : {0U, 7U, 14U}) {
    if (i == 14 && is_odometry) break;
    const double variance = twist.covariance[i];
    if (variance < 0 || !(variance < kUnknownVariance)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, variance);
  }
  return largest;
}

/// What drivers write for no number (PD0's -32768, -99999), in m, dm, cm or mm a second.
bool isNoNumber(double v) {
  for (const double none : {-32768.0, -99999.0})
    for (const double unit : {1.0, 0.1, 0.01, 0.001})
      if (std::abs(v - unit * none) < 1e-7 * std::abs(unit * none)) return true;
  return false;
}

/// Whether a driver says by a velocity, or by its variance, that it has none: it has no other way in a twist.
/// usual_sigma_m_s: of the messages before.
bool isWithoutLock(const Vector3d& velocity, double variance, const std::optional<double>& usual_sigma_m_s) {
  constexpr double kPoor = 10, kPoorSigma_m_s = 1;  // with which a velocity of exactly zero is none
  const double poor_m_s = usual_sigma_m_s ? kPoor * *usual_sigma_m_s : kPoorSigma_m_s;
  return !velocity.allFinite() || !std::isfinite(variance) ||
         (velocity == Vector3d::Zero() && std::sqrt(variance) > poor_m_s) ||
         std::any_of(velocity.begin(), velocity.end(), isNoNumber);
}

/// Whether a variance of the attitude says that there is none, as a negative first one does by REP 145.
bool isWithoutAttitude(const ros1::Imu& imu) {
  const auto isNone = [](double variance) {
    return variance < 0 || !(variance < kUnknownAngleVariance_rad2);
  };
  const auto& covariance = imu.orientation_covariance;
  return isNone(covariance[0]) || isNone(covariance[4]) || isNone(covariance[8]);
}

/// As drivers fill it in while a filter has not settled: zeros, or NaN.
bool isNoRotation(const ros1::Quaternion& q) {
  const Eigen::Vector4d v(q.x, q.y, q.z, q.w);
  return !v.allFinite() || v == Eigen::Vector4d::Zero();
}

}  // namespace

/// The other fields of a message without attitude are as good as ever.
std::optional<Matrix3d> BagImporter::attitudeIn(const ros1::Imu& imu, const BagTopic& topic,
                                                const BagMessage& message) {
  if (!topic.use_orientation || isWithoutAttitude(imu)) return {};
  if (!isNoRotation(imu.orientation)) return rotationIn(message, imu.orientation);
  ++without_attitude_[topic.topic];
  return {};
}

void BagImporter::takeIns(const BagTopic& topic, const BagMessage& message) {
  const auto imu = message.as<ros1::Imu>();
  const std::optional<Matrix3d> orientation = attitudeIn(*imu, topic, message);
  InsSample sample{topic.T_robot_sensor, {}, {}, {}};
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
  const double variance = largestVariance(twist, message.is("nav_msgs/Odometry"));
  if (isWithoutLock(velocity_dvl, variance, sigmas_.velocity_xy.typical())) {
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
  if (pressure_pa <= 0) throw message.error(print("fluid_pressure is %g Pa: no pressure", pressure_pa));
  if (pressure->variance < 0) throw message.error("its variance says that nothing was measured");
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
  push(topic, toTime(stamp), ImageSample{topic.T_robot_sensor, *topic.intrinsics, name + extension}, message);
  writeBytes(options_.image_folder / (name + extension), bytes);
}

}  // namespace fathom
