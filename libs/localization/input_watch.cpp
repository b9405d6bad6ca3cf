#include "localization/input_watch.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"

namespace fathom {
namespace {

bool isFinite(const Sample& sample) {
  struct Visitor {
    bool operator()(const InsSample& s) const {
      return (!s.angular_velocity_ins || s.angular_velocity_ins->allFinite()) &&
             (!s.specific_force_ins || s.specific_force_ins->allFinite()) &&
             (!s.R_odom_ins || s.R_odom_ins->allFinite());
    }
    bool operator()(const DvlSample& s) const { return !s.velocity_dvl || s.velocity_dvl->allFinite(); }
    bool operator()(const DvlBeamsSample& s) const {
      return std::all_of(s.beams.begin(), s.beams.end(),
                         [](const DvlBeam& beam) { return !beam.range_m || std::isfinite(*beam.range_m); });
    }
    bool operator()(const DepthSample& s) const { return std::isfinite(s.pressure_pa); }
    bool operator()(const PoseSample& s) const {
      return s.T_odom_robot.mean.position.allFinite() && s.T_odom_robot.covariance.allFinite();
    }
    bool operator()(const ImageSample&) const { return true; }
    bool operator()(const StereoSample&) const { return true; }
    bool operator()(const PanelSample& s) const {
      return std::all_of(s.panels.begin(), s.panels.end(), [](const SeenPanel& seen) {
        const auto& [pose, covariance] = seen.T_camera_panel;
        return pose.position.allFinite() && pose.rotation.allFinite() && covariance.allFinite();
      });
    }
    bool operator()(const MarkersSample&) const { return true; }
    bool operator()(const RecordingHeader&) const { return true; }
    bool operator()(const UnknownSample&) const { return true; }
  };
  return std::visit(Visitor{}, sample.reading);
}

/// What no underwater vehicle does, and no sea allows: such a value is garbage, and no gate need weigh it.
struct Limits {
  static constexpr double kAngularVelocity_rad_s = 50.0;
  static constexpr double kSpecificForce_m_s2 = 500.0;
  static constexpr double kVelocity_m_s = 50.0;
  static constexpr double kRange_m = 12'000.0;   // the deepest sea
  static constexpr double kPressure_pa = 1.3e8;  // at its bottom
};

bool isPossible(const Sample& sample) {
  const auto within = [](const std::optional<Vector3d>& v, double limit) {
    return !v || v->cwiseAbs().maxCoeff() <= limit;
  };
  if (const auto* ins = std::get_if<InsSample>(&sample.reading))
    return within(ins->angular_velocity_ins, Limits::kAngularVelocity_rad_s) &&
           within(ins->specific_force_ins, Limits::kSpecificForce_m_s2);
  if (const auto* dvl = std::get_if<DvlSample>(&sample.reading))
    return within(dvl->velocity_dvl, Limits::kVelocity_m_s);
  if (const auto* beams = std::get_if<DvlBeamsSample>(&sample.reading))
    return std::all_of(beams->beams.begin(), beams->beams.end(), [](const DvlBeam& beam) {
      return !beam.range_m || (*beam.range_m >= 0.0 && *beam.range_m <= Limits::kRange_m);
    });
  if (const auto* depth = std::get_if<DepthSample>(&sample.reading))
    return depth->pressure_pa >= 0.0 && depth->pressure_pa <= Limits::kPressure_pa;
  return true;
}

}  // namespace

bool InputWatch::accept(const Sample& sample, double t_s) {
  if (!isFinite(sample)) {
    report_(t_s, "not-a-number", sample.label + " has a value that is not finite; the entry is left out");
    return false;
  }
  if (!isPossible(sample)) {
    report_(t_s, "impossible", sample.label + " has a value beyond all bounds; the entry is left out");
    return false;
  }
  const auto [it, first] = sensors_.try_emplace(sample.label, Sensor{t_s});
  Sensor& sensor = it->second;
  const double interval_s = t_s - sensor.last_s;
  if (!first && interval_s == 0.0) {
    report_(t_s, "duplicate", sample.label + " repeats its time stamp; the second entry is left out");
    return false;
  }
  if (interval_s > options_.gap_s && isLongFor(sensor, interval_s))
    report_(t_s, "silent", sample.label + print(" was silent for %.3f s", interval_s));
  if (interval_s > 0.0) {
    sensor.last_s = t_s;
    sensor.sum_s += interval_s;
    sensor.count += 1.0;
  }
  if (any_ && t_s - newest_s_ > options_.gap_s)
    report_(t_s, "gap", print("no sensor for %.3f s; bridged by the motion model", t_s - newest_s_));
  if (any_ && newest_s_ - t_s > options_.history_s)
    report_(t_s, "time-jump", print("time jumps back by %.3f s", newest_s_ - t_s));
  newest_s_ = any_ ? std::max(newest_s_, t_s) : t_s;
  any_ = true;
  return true;
}

/// A sensor that is slow anyway is not silent: judged against its own mean interval so far.
bool InputWatch::isLongFor(const Sensor& sensor, double interval_s) const {
  return sensor.count == 0.0 || interval_s > 5.0 * sensor.sum_s / sensor.count;
}

}  // namespace fathom
