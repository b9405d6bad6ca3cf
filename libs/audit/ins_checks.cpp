#include <algorithm>
#include <cmath>
#include <functional>

#include "audit/acceleration_evidence.h"
#include "audit/attitude_evidence.h"
#include "audit/checks.h"
#include "audit/correction.h"
#include "audit/regression.h"
#include "audit/sensor_units.h"
#include "audit/vertical_evidence.h"
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
  /// The way up by the pressure over that by the DVL, where the INS's axes are taken for these.
  using Rise = std::function<Regression(const SignedAxes& ins_axes)>;

  InsCheck(const Instance& instance, const InsStream& stream, const Vehicle& vehicle, const DvlStream* dvl,
           Rise rise, std::vector<Finding>& findings)
      : instance_(instance),
        stream_(stream),
        vehicle_(vehicle),
        dvl_(dvl),
        rise_(std::move(rise)),
        findings_(findings) {}

  void check() {
    forces_ = meanForces(stream_);
    if (forces_.size() >= kFewestSeconds) {
      checkLength();
      checkDirection();
    }
    checkTurning();
    checkAttitude();
    checkRates();
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
    force_scale_ = 0;
    const SensorUnit* unit = nullptr;
    for (const SensorUnit& u : kForceUnits)
      if (isNear(length * u.si, gravity, 0.05) &&
          (unit == nullptr || std::abs(length * u.si - gravity) < std::abs(length * unit->si - gravity)))
        unit = &u;
    const bool no_direction = length < 0.3 * gravity && pointsAnywhere();
    if (unit != nullptr && !no_direction) {
      Finding& found = add(unit->name, sure, what + "; " + unit->says);
      found = correctable(found, print("%.4g m/s²", length * unit->si));
      force_scale_ = unit->si;
    } else if (no_direction || length < 0.1 * gravity) {
      checkMissingGravity(what, length);
    } else if (!isNear(length, gravity, 0.05)) {
      add("gravity-length", isNear(length, gravity, 0.2) ? likely : sure,
          what + "; no unit that is usual explains it");
    } else {
      force_scale_ = 1;
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

  /// Up, in the robot's axes, as the mean specific force has it.
  void checkDirection() {
    if (force_scale_ == 0) return;
    Vector3d mean = Vector3d::Zero();
    for (const Vector3d& f : forces_) mean += f.normalized() / static_cast<double>(forces_.size());
    if (mean.norm() < 0.8) return;  // it loops: up is everywhere
    up_ = (stream_.T_robot_ins.rotation * mean).normalized();
    const double tilt = std::acos(std::clamp(up_.z(), -1.0, 1.0));
    if (tilt < radians(30)) return;
    // A vehicle may dive upside down or climb a hull: the DVL rises as the pressure falls then, whatever is
    // up.
    const auto riseWith = [&](const SignedAxes& axes) { return rise_(axes).correlation(); };
    const double rise = riseWith({});
    if (rise > 0.8) return;
    Finding& found =
        add("gravity-direction", likely,
            print("the specific force points along (%.2f, %.2f, %.2f) of the robot, %.0f deg off up", up_.x(),
                  up_.y(), up_.z(), degrees(tilt)));
    const auto axes = axesThatTurnUp();
    if (!axes) return;
    const double attitude_tilt = evidence_.medianTilt(attitudeReadings()[0], axes_);
    if ((rise < 0.5 && riseWith(*axes) > 0.9) || attitude_tilt > radians(60)) found.certainty = sure;
    // What turns all of the INS turns its attitude too, so that the two still fit.
    if (!axes->proper()) axes_ = *axes;
    found.what += axes->proper() ? "; the INS's axes are others than its mounting says"
                                 : "; the accelerometer's sign is the other one";
    found = correctable(found, axes->proper() ? "its axes as " + axes->text() : "its opposite", axes->text());
    found.correction =
        instance_.label(axes->proper() ? "ins-axes" : "accelerometer-axes") + ":" + plainText(*axes);
  }

  /// Forward-right-down for forward-left-up, or the other sign: which of them the DVL agrees with; that of
  /// axes, which is more usual, where it does not tell.
  std::optional<SignedAxes> axesThatTurnUp() const {
    const Vector3d up_ins = stream_.T_robot_ins.rotation.transpose() * up_;
    const Matrix3d R = stream_.T_robot_ins.rotation;
    const SignedAxes forward_right_down{{0, 1, 2}, {1, -1, -1}}, opposite{{0, 1, 2}, {-1, -1, -1}};
    const auto turnsUp = [&](const SignedAxes& axes) { return (R * axes.matrix() * up_ins).z() > 0.9; };
    const bool turned = turnsUp(forward_right_down), other_sign = turnsUp(opposite);
    if (turned && other_sign && isOppositeForce(forward_right_down, opposite)) return opposite;
    if (turned) return forward_right_down;
    if (other_sign) return opposite;
    return {};
  }

  /// The gyro against how the attitude turns; without an attitude, against how gravity does; where that
  /// hardly turns, against the DVL.
  void checkTurning() {
    Regression turning = evidence_.turning();
    const bool by_attitude = turning.count() >= 2 * kFewestSeconds;
    if (!by_attitude) turning = evidence_.turningOfGravity();
    // Enough turning, and told from noise.
    if (turning.count() < 2 * kFewestSeconds || turning.rmsX() < radians(0.2) ||
        std::abs(turning.correlation()) < 0.7) {
      if (!by_attitude) checkTurningByDvl();
      if (by_attitude) isConstantOrDead();
      return;
    }
    if (by_attitude && isConstantOrDead()) return;
    const double k = turning.slope();
    const std::string what = print("%s turns by %.4g of what the gyro says (%.3g deg/s, root mean square)",
                                   by_attitude ? "the attitude" : "gravity", k, degrees(turning.rmsX()));
    if (isNear(k, radians(1.0), 0.3)) {
      addGyroInDegrees(what);
    } else if (by_attitude && contradictsByAxis()) {
      // The gyro or the attitude: checkAttitude() tells.
    } else if (isNear(k, -1, 0.3)) {
      addGyroSign(what);
    } else if (!isNear(k, 1, by_attitude ? 0.3 : 0.6)) {  // accelerations turn what seems to be gravity too
      add("gyro-scale-far-off", isNear(k, 1, 0.6) ? likely : sure, what);
    }
  }

  /// Whether the attitude never changes, or an axis of the gyro never reads anything, while the other turns.
  bool isConstantOrDead() {
    const std::array<Regression, 3> axes = evidence_.turningByAxis();
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
      return true;
    }
    for (int i = 0; i < 3; ++i) {
      const Regression& axis = axes[static_cast<std::size_t>(i)];
      if (axis.rmsX() > 1e-12 || axis.rmsY() < radians(1)) continue;
      add("gyro-dead", sure,
          print("the gyro's %c never reads anything, the attitude turns about it by %.3g deg/s (root mean "
                "square)",
                "xyz"[i], degrees(axis.rmsY())));
      return true;
    }
    return false;
  }

  /// Whether the attitude clearly turns the other way round than the gyro about an axis.
  bool contradictsByAxis() const {
    const std::array<Regression, 3> axes = evidence_.turningByAxis();
    return std::any_of(axes.begin(), axes.end(), [](const Regression& axis) {
      return axis.rmsX() > radians(0.5) && axis.correlation() < -0.7;
    });
  }

  void checkTurningByDvl() {
    if (dvl_ == nullptr || force_scale_ != 1 || hasFinding(findings_, Ins::label, instance_)) return;
    const auto leftWith = [&](double scale) {
      AssumedAxes assumed;
      assumed.gyro_scale = scale;
      return accelerationEvidence(*dvl_, stream_, assumed).left();
    };
    const double as_it_is = leftWith(1), opposite = leftWith(-1), in_degrees = leftWith(radians(1.0));
    const double least = std::min(opposite, in_degrees);
    if (least > 0.15 || as_it_is < 4 * least) return;
    const std::string what =
        print("%.0f %% of how the DVL's velocity changes are not explained, %.0f %% if the gyro %s",
              100 * std::sqrt(as_it_is), 100 * std::sqrt(least),
              opposite < in_degrees ? "had the other sign" : "were in degrees a second");
    opposite < in_degrees ? addGyroSign(what) : addGyroInDegrees(what);
  }

  void addGyroInDegrees(const std::string& what) {
    Finding& found =
        add("gyro-in-degrees", sure, what + "; it is in degrees a second, of which pi/180 is one in radians");
    found = correctable(found, "radians a second");
  }

  void addGyroSign(const std::string& what) {
    const SignedAxes opposite{{0, 1, 2}, {-1, -1, -1}};
    Finding& found = add("gyro-sign", sure, what + ": its sign is the other one");
    found = correctable(found, "its opposite", plainText(opposite));
    found.correction = instance_.label("gyro-axes") + ":" + plainText(opposite);
  }

  /// Only where the DVL says so: axes that are forward, right, down are more usual, with a north-east-down
  /// attitude too.
  bool isOppositeForce(const SignedAxes& forward_right_down, const SignedAxes& opposite) const {
    const double tilt = evidence_.medianTilt(attitudeReadings()[0], axes_);
    if (dvl_ == nullptr || tilt < radians(90)) return false;
    const auto agreement = [&](const AssumedAxes& assumed) {
      return accelerationEvidence(*dvl_, stream_, assumed).all().correlation();
    };
    return agreement({{}, opposite, {}, 1}) >
           agreement({forward_right_down, forward_right_down, {}, 1}) + 0.1;
  }

  /// What may be wrong where the attitude contradicts gravity or the gyro.
  struct Suspicion {
    std::string name, says, correction;
    double contradiction;  ///< that is left with it
  };

  /// The attitude against gravity and against the gyro.
  void checkAttitude() {
    if (forces_.size() < kFewestSeconds || force_scale_ == 0) return;
    if (std::any_of(findings_.begin(), findings_.end(), [&](const Finding& f) {
          return f.name.starts_with("attitude-constant") || f.name.starts_with("gyro-");
        }))
      return;
    const AttitudeReading& as_it_is = attitudeReadings()[0];
    const double tilt = evidence_.medianTilt(as_it_is, axes_);
    if (std::isnan(tilt)) return;
    const Regression turn = evidence_.turning(as_it_is);
    const double turning = turn.correlation();
    const bool turns_alike = turning > 0.5 || turn.rmsX() < radians(0.5);  // or hardly at all
    if (tilt < radians(20) && turns_alike && !contradictsByAxis()) return;
    const std::string what = print(
        "the attitude turns the specific force %.0f deg off up, and as the gyro does by a correlation of "
        "%.2f",
        degrees(tilt), turning);
    std::vector<Suspicion> all = suspicions();
    std::stable_sort(all.begin(), all.end(), [](const Suspicion& a, const Suspicion& b) {
      return a.contradiction < b.contradiction;
    });
    if (all[0].contradiction > std::min(kContradiction, 0.7 * contradictionOf(as_it_is, Vector3d::Ones()))) {
      if (tilt > radians(20) && !hasFinding(findings_, Ins::label, instance_))
        add("attitude-against-gravity", tilt < radians(45) ? likely : sure, what);
    } else if (all[1].contradiction < all[0].contradiction + kClear) {
      std::string either;
      for (const Suspicion& one : all)
        if (one.contradiction < all[0].contradiction + kClear)
          either += (either.empty() ? "" : ", or ") + one.says + " (--correct " + one.correction + ")";
      add("attitude-against-gyro", sure, what + "; " + either);
    } else {
      Finding& found = add(all[0].name, sure, what + "; " + all[0].says);
      found = correctable(found, "agree with gravity and the gyro");
      found.correction = instance_.label(all[0].correction.substr(0, all[0].correction.find(':')));
      if (const auto colon = all[0].correction.find(':'); colon != std::string::npos)
        found.correction += all[0].correction.substr(colon);
    }
  }

  std::vector<Suspicion> suspicions() const {
    std::vector<Suspicion> all;
    for (std::size_t k = 1; k < attitudeReadings().size(); ++k) {
      const AttitudeReading& reading = attitudeReadings()[k];
      all.push_back({reading.name, reading.says, reading.name, contradictionOf(reading, Vector3d::Ones())});
    }
    for (int bits = 1; bits < 8; ++bits) {
      const SignedAxes axes{{0, 1, 2}, {bits & 1 ? -1 : 1, bits & 2 ? -1 : 1, bits & 4 ? -1 : 1}};
      all.push_back({bits == 7 ? "gyro-sign" : "gyro-axes",
                     bits == 7 ? "the gyro's sign is the other one" : "the gyro's axes are " + axes.text(),
                     "gyro-axes:" + plainText(axes),
                     contradictionOf(attitudeReadings()[0], axes.matrix().diagonal())});
    }
    return all;
  }

  /// Of an attitude, so read, with gravity (degrees, three of which are one) and with the gyro, of these
  /// signs: the worst of the axes about which it clearly turns counts.
  double contradictionOf(const AttitudeReading& reading, const Vector3d& gyro_signs) const {
    double worst = 1 - evidence_.turning(reading, 20, gyro_signs).correlation();
    const std::array<Regression, 3> axes = evidence_.turningByAxis(reading);
    for (int i = 0; i < 3; ++i) {
      const Regression& axis = axes[static_cast<std::size_t>(i)];
      if (axis.rmsX() > radians(0.2) && std::abs(axis.correlation()) > 0.8)
        worst = std::max(worst, 1 - gyro_signs[i] * axis.correlation());
    }
    return degrees(evidence_.medianTilt(reading, axes_)) / 3 + 5 * worst;
  }
  static constexpr double kContradiction = 6, kClear = 0.3;

  void checkRates() {
    const double limit = vehicle_.limits.turn_rate_rad_s;
    std::size_t rates = 0, beyond = 0;
    double fastest = 0;
    for (const InsWindow& w : stream_.windows) {
      if (w.rates == 0) continue;
      ++rates;
      fastest = std::max(fastest, w.rate.norm());
      if (w.rate.norm() > limit) ++beyond;
    }
    if (beyond * 100 <= rates || hasFinding(findings_, Ins::label, instance_)) return;
    add("turn-rate", beyond * 2 > rates ? sure : likely,
        print("it turns by up to %.4g deg/s; more than limits: turn_rate_deg_s of the vehicle file, %.4g, in "
              "%.0f %%",
              degrees(fastest), degrees(limit),
              100.0 * static_cast<double>(beyond) / static_cast<double>(rates)));
  }

  const Instance instance_;
  const InsStream& stream_;
  const AttitudeEvidence evidence_{stream_};
  const Vehicle& vehicle_;
  const DvlStream* dvl_;  ///< a witness; null: none
  const Rise rise_;
  std::vector<Finding>& findings_;
  std::vector<Vector3d> forces_;
  double force_scale_ = 0;  ///< to m/s²; 0: unknown
  Vector3d up_{0, 0, 1};    ///< in robot axes
  SignedAxes axes_;         ///< that the INS's axes are found to be
};

}  // namespace

void checkIns(const Streams& streams, const Vehicle& vehicle, std::vector<Finding>& findings) {
  const DvlStream* dvl = streams.dvl.empty() ? nullptr : &streams.dvl.begin()->second;
  for (const auto& one : streams.ins) {
    const InsStream& stream = one.second;
    const auto rise = [&](const SignedAxes& ins_axes) {
      if (streams.depth.empty()) return Regression();
      return verticalEvidence(streams, stream, streams.depth.begin()->second, vehicle, {}, ins_axes);
    };
    InsCheck(one.first, stream, vehicle, dvl, rise, findings).check();
  }
}

}  // namespace fathom
