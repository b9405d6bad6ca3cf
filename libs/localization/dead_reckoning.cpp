#include "localization/dead_reckoning.h"

#include "recording/tum.h"

namespace fathom {
namespace {

/// Sums velocities in odom up, trapezoidally.
class Sum {
 public:
  explicit Sum(const Vector3d& start) : position_(start) {}
  void add(const Time& time, const Matrix3d& R_odom_robot, const Vector3d& velocity_robot) {
    const Vector3d velocity = R_odom_robot * velocity_robot;
    if (!path_.empty())
      position_ += 0.5 * secondsBetween(path_.back().time, time) * (velocity + last_velocity_);
    last_velocity_ = velocity;
    path_.push_back({time, {R_odom_robot, position_}});
  }
  std::vector<StampedPose> path() && { return std::move(path_); }

 private:
  Vector3d position_, last_velocity_ = Vector3d::Zero();
  std::vector<StampedPose> path_;
};

}  // namespace

void DeadReckoning::add(const Sample& sample) {
  if (const auto* ins = std::get_if<InsSample>(&sample.reading)) turn(*ins, sample.time);
  const auto* dvl = std::get_if<DvlSample>(&sample.reading);
  if (dvl == nullptr || !dvl->velocity_dvl || !dvl->velocity_dvl->allFinite()) return;
  if (!readings_.empty() && sample.time <= readings_.back().time) return;
  readings_.push_back({sample.time, dvl->T_robot_dvl.rotation * *dvl->velocity_dvl, R_odom_robot_});
}

void DeadReckoning::turn(const InsSample& ins, const Time& time) {
  if (!ins.angular_velocity_ins || !ins.angular_velocity_ins->allFinite()) return;
  const double dt = last_gyro_ ? secondsBetween(*last_gyro_, time) : 0.0;
  if (dt < 0.0) return;
  last_gyro_ = time;
  R_odom_robot_ = R_odom_robot_ * expSO3<double>(ins.T_robot_ins.rotation * *ins.angular_velocity_ins * dt);
}

std::vector<StampedPose> DeadReckoning::plain() const {
  Sum sum(start_.position);
  for (const Reading& reading : readings_)
    sum.add(reading.time, reading.R_odom_robot, reading.velocity_robot);
  return std::move(sum).path();
}

std::vector<StampedPose> DeadReckoning::byAttitudeOf(const std::vector<StampedPose>& reference) const {
  Sum sum(start_.position);
  for (const Reading& reading : readings_)
    if (const auto truth = poseAt(reference, reading.time))
      sum.add(reading.time, truth->rotation, reading.velocity_robot);
  return std::move(sum).path();
}

}  // namespace fathom
