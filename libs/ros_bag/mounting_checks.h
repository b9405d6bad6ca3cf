#pragma once

#include <optional>
#include <vector>

#include "recording/axes.h"
#include "recording/imported.h"
#include "ros_bag/topic_map.h"

namespace fathom {

/// Sums that tell what the INS's orientation means and whether its mounting agrees with gravity and with the
/// odometry. Memory: 48 bytes for each second.
class MountingChecks {
 public:
  explicit MountingChecks(double gravity_m_s2) : gravity_(gravity_m_s2) {}

  /// orientation: as the message has it, whoever's it is. force_ins: specific force, INS axes, m/s²; without
  /// it nothing is added.
  void addIns(const BagTopic& topic, const std::optional<Matrix3d>& orientation,
              const std::optional<Vector3d>& force_ins);

  /// Odometry, robot axes, m/s and rad/s. Compared over windows of a second: shorter ones drown in vibration.
  void addOdometry(Time time, const Vector3d& velocity, const Vector3d& rate);

  /// What can be said; nothing is corrected.
  std::vector<Conclusion> conclusions(const BagTopic& ins) const;

 private:
  Vector3d up() const { return {0, 0, gravity_}; }
  Conclusion gravityConclusion() const;
  Conclusion orientationConclusion(const BagTopic& ins) const;
  Conclusion axesConclusion() const;

  double gravity_;
  double as_sensor_ = 0.0, as_robot_ = 0.0;
  Vector3d total_force_robot_ = Vector3d::Zero();
  std::size_t oriented_ = 0, total_forces_ = 0;
  // the current window
  Time start_{};
  Vector3d start_velocity_ = Vector3d::Zero(), turning_ = Vector3d::Zero(), force_robot_ = Vector3d::Zero();
  std::size_t forces_ = 0, readings_ = 0;
  /// Means over a second, robot axes: acceleration by the odometry, specific force.
  struct Window {
    Vector3d acceleration, force;
  };
  std::vector<Window> windows_;
};

}  // namespace fathom
