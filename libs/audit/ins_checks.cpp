#include <algorithm>
#include <cmath>

#include "audit/attitude_evidence.h"
#include "audit/checks.h"
#include "audit/regression.h"
#include "audit/sensor_units.h"
#include "core/median.h"
#include "core/text.h"

namespace fathom {
namespace {
using enum Finding::Certainty;

/// Means over a second each: vibration and noise are gone, and the length is gravity's, however it is turned.
std::vector<Vector3d> meanForces(const InsStream& stream) {
  std::vector<Vector3d> means;
  Vector3d sum = Vector3d::Zero();
  double count = 0, from_s = 0;
  for (const InsWindow& w : stream.windows) {
    if (w.forces == 0) continue;
    if (count > 0 && w.t_s - from_s >= 1) {
      means.emplace_back(sum / count);
      sum.setZero(), count = 0;
    }
    if (count == 0) from_s = w.t_s;
    sum += w.force, ++count;
  }
  return means;
}

class InsCheck {
 public:
  InsCheck(const Instance& instance, const InsStream& stream, const Vehicle& vehicle,
           std::vector<Finding>& findings)
      : instance_(instance), stream_(stream), vehicle_(vehicle), findings_(findings) {}

  void check() {
    forces_ = meanForces(stream_);
    if (forces_.size() >= kFewestSeconds) checkLength();
    checkConstantOrDead();
  }

 private:
  Finding& add(const std::string& name, Finding::Certainty certainty, std::string what) {
    return findings_.emplace_back(finding(name, Ins::label, instance_, certainty, std::move(what)));
  }

  void checkLength() {
    std::vector<double> lengths;
    for (const Vector3d& f : forces_) lengths.push_back(f.norm());
    const double length = upperMedian(lengths), gravity = vehicle_.gravity_m_s2;
    if (gravity <= 0) return;
    const std::string what = print("the specific force is %.4g m/s² long, %.4g of gravity's %.5g", length,
                                   length / gravity, gravity);
    const SensorUnit* unit = nullptr;
    for (const SensorUnit& u : kForceUnits)
      if (isNear(length * u.si, gravity, 0.05) &&
          (unit == nullptr || std::abs(length * u.si - gravity) < std::abs(length * unit->si - gravity)))
        unit = &u;
    const bool no_direction = length < 0.3 * gravity && pointsAnywhere();
    if (unit != nullptr && !no_direction) {
      Finding& found = add(unit->name, sure, what + "; " + unit->says);
      found = correctable(found, print("%.4g m/s²", length * unit->si));
    } else if (no_direction || length < 0.1 * gravity) {
      checkMissingGravity(what, length);
    } else if (!isNear(length, gravity, 0.05)) {
      add("gravity-length", isNear(length, gravity, 0.2) ? likely : sure,
          what + "; no unit that is usual explains it");
    }
  }

  /// Whether what is left has no direction of its own, as accelerations to and fro.
  bool pointsAnywhere() const {
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& f : forces_) mean += f.normalized() / static_cast<double>(forces_.size());
    return mean.norm() < 0.6;
  }

  void checkMissingGravity(const std::string& what, double length) {
    if (length < 1e-6) {
      add("accelerometer-zero", sure, what + "; it reads nothing but zero");
      return;
    }
    Finding& found =
        add("accelerometer-without-gravity", sure, what + "; the driver has taken gravity out of it");
    const bool oriented = std::any_of(stream_.windows.begin(), stream_.windows.end(),
                                      [](const InsWindow& w) { return w.attitude.has_value(); });
    if (oriented) found = correctable(found, "gravity put back by the attitude in the same entries");
  }

  /// Whether the attitude never changes, or an axis of the gyro never reads anything, while the other turns.
  void checkConstantOrDead() {
    const std::array<Regression, 3> axes = turningByAxis(stream_);
    const auto total = [&](auto&& rms) {
      return std::sqrt(rms(0) * rms(0) + rms(1) * rms(1) + rms(2) * rms(2));
    };
    const double gyro = total([&](int i) { return axes[static_cast<std::size_t>(i)].rmsX(); });
    const double attitude = total([&](int i) { return axes[static_cast<std::size_t>(i)].rmsY(); });
    if (attitude < 1e-9 && gyro > radians(0.5)) {
      Finding& found =
          add("attitude-constant", sure,
              print("the attitude never changes, the gyro turns by %.3g deg/s (root mean square)",
                    degrees(gyro)));
      found = correctable(found, "none, as if the INS gave no attitude");
      found.correction = instance_.label("attitude-none");
      return;
    }
    for (int i = 0; i < 3; ++i) {
      const Regression& axis = axes[static_cast<std::size_t>(i)];
      if (axis.rmsX() > 1e-12 || axis.rmsY() < radians(1)) continue;
      add("gyro-dead", sure,
          print("the gyro's %c never reads anything, the attitude turns about it by %.3g deg/s (root mean "
                "square)",
                "xyz"[i], degrees(axis.rmsY())));
      return;
    }
  }

  const Instance instance_;
  const InsStream& stream_;
  const Vehicle& vehicle_;
  std::vector<Finding>& findings_;
  std::vector<Vector3d> forces_;
};

}  // namespace

void checkIns(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings) {
  for (const auto& [instance, stream] : streams.ins) InsCheck(instance, stream, vehicle, findings).check();
}

}  // namespace fathom
