#include "ros_bag/mounting_checks.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace fathom {

void MountingChecks::addIns(const BagTopic& topic, const std::optional<Matrix3d>& orientation,
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

void MountingChecks::addOdometry(Time time, const Vector3d& velocity, const Vector3d& rate) {
  if (readings_ == 0) {
    start_ = time;
    start_velocity_ = velocity;
  }
  turning_ += rate.cross(velocity);
  ++readings_;
  const double span = secondsBetween(start_, time);
  if (span < 1.0) return;
  if (forces_ > 0 && span < 3.0)  // a longer one has a gap in it
    windows_.push_back({(velocity - start_velocity_) / span + turning_ / static_cast<double>(readings_),
                        force_robot_ / static_cast<double>(forces_)});
  force_robot_ = turning_ = Vector3d::Zero();
  forces_ = readings_ = 0;
  start_ = time;
  start_velocity_ = velocity;
}

std::vector<Conclusion> MountingChecks::conclusions(const BagTopic& ins) const {
  std::vector<Conclusion> all;
  if (total_forces_ > 0) all.push_back(gravityConclusion());
  if (oriented_ > 0 && angleBetween(ins.T_robot_sensor.rotation, Matrix3d::Identity()) > 1e-6)
    all.push_back(orientationConclusion(ins));
  if (windows_.size() >= 10) all.push_back(axesConclusion());
  return all;
}

Conclusion MountingChecks::gravityConclusion() const {
  const Vector3d mean = total_force_robot_ / static_cast<double>(total_forces_);
  const double tilt_rad = std::acos(std::clamp(mean.z() / mean.norm(), -1.0, 1.0));
  const bool upright = tilt_rad < radians(20);
  return {"INS mounting against gravity",
          upright ? "the map's pose turns gravity upright" : "the map's pose does not turn gravity upright",
          "", 0.0,
          print("mean specific force in the robot's axes (%.3f, %.3f, %.3f) m/s2, %.2f deg off up", mean.x(),
                mean.y(), mean.z(), degrees(tilt_rad))};
}

Conclusion MountingChecks::orientationConclusion(const BagTopic& ins) const {
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

/// Changes are compared: gravity is the same throughout, be it on a slope. Of the axes those come into
/// question that turn the mean specific force about up.
Conclusion MountingChecks::axesConclusion() const {
  const double kSteepestSlope = radians(35);
  Window mean{Vector3d::Zero(), Vector3d::Zero()};
  for (const Window& w : windows_) {
    mean.acceleration += w.acceleration / static_cast<double>(windows_.size());
    mean.force += w.force / static_cast<double>(windows_.size());
  }
  AxesEvidence evidence;
  for (const Window& w : windows_) evidence.add(w.acceleration - mean.acceleration, w.force - mean.force);
  auto ranked = evidence.ranking();
  std::erase_if(ranked, [&](const AxesScore& s) {
    const Vector3d up = s.axes.matrix() * mean.force;
    return !s.axes.proper() ||  // a mounting is no mirror
           up.z() < std::cos(kSteepestSlope) * up.norm();
  });
  if (ranked.size() < 2)
    return {"INS mounting against odometry", "none of the 24 right-angled ones turns gravity upright", "",
            0.0, ""};
  const AxesScore &best = ranked[0], &other = ranked[1];
  return {
      "INS mounting against odometry",
      best.axes == SignedAxes{}
          ? "the map's pose fits best of the 24 right-angled ones"
          : "axes " + best.axes.text() + " after the map's pose fit better (not corrected)",
      "axes " + other.axes.text() + " after the map's pose",
      std::exp((best.log_likelihood - other.log_likelihood) / static_cast<double>(windows_.size())),
      print(
          "changes of acceleration from odometry against the accelerometer's, %zu windows of 1 s, RMS (%.2f, "
          "%.2f, %.2f) m/s2 against (%.2f, %.2f, %.2f)",
          windows_.size(), best.residual_rms.x(), best.residual_rms.y(), best.residual_rms.z(),
          other.residual_rms.x(), other.residual_rms.y(), other.residual_rms.z())};
}

}  // namespace fathom
