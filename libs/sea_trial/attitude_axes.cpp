#include "sea_trial/attitude_axes.h"

#include <algorithm>
#include <cmath>

#include "core/stable_sort.h"
#include "sensors/ins.h"

namespace fathom {
namespace {

/// Ratio of residuals as the product over the axes, from the log likelihoods of `count` rows.
double residualRatio(double best, double other, std::size_t count) {
  return std::exp((best - other) / static_cast<double>(std::max<std::size_t>(count, 1)));
}

/// Mean rate between two rows: gyro against attitude increments.
AxesEvidence gyroEvidence(const AlignedStreams& s, const std::vector<Matrix3d>& R_ned_frd) {
  AxesEvidence evidence;
  for (std::size_t k = 0; k + 1 < R_ned_frd.size(); ++k) {
    const double from = s.gt_time_s[k], to = s.gt_time_s[k + 1];
    if (!s.turned_imu.covers(from, to)) continue;
    const Vector3d turned = logSO3<double>(R_ned_frd[k].transpose() * R_ned_frd[k + 1]);
    evidence.add(turned / (to - from), (s.turned_imu.at(to) - s.turned_imu.at(from)) / (to - from));
  }
  return evidence;
}

/// Mean specific force over two intervals: accelerometer against change of velocity less gravity.
AxesEvidence accelerometerEvidence(const AlignedStreams& s, const std::vector<Matrix3d>& R_ned_frd) {
  const World<double> ned{-World<double>{}.gravity_odom};  // 0.1 % off locally, which changes no conclusion
  AxesEvidence evidence;
  for (std::size_t k = 1; k + 1 < R_ned_frd.size(); ++k) {
    const double from = s.gt_time_s[k - 1], to = s.gt_time_s[k + 1];
    if (!s.pushed_imu.covers(from, to)) continue;
    const Vector3d acceleration_ned = (s.data.velocity_ned[k + 1] - s.data.velocity_ned[k - 1]) / (to - from);
    Inputs<double> in;
    in.world = ned;
    in.state.R_odom_robot = R_ned_frd[k];
    in.state.acceleration_robot = R_ned_frd[k].transpose() * acceleration_ned;
    evidence.add(Accelerometer::specificForce(in, {}),
                 (s.pushed_imu.at(to) - s.pushed_imu.at(from)) / (to - from));
  }
  return evidence;
}

/// DVL against the solution's velocity turned into the body, at the delay that suits the axes best.
AxesEvidence dvlEvidence(const AlignedStreams& s, const std::vector<Matrix3d>& R_ned_frd) {
  const SampledSignal velocity_frd = velocityFrd(s, R_ned_frd);
  AxesEvidence best;
  double best_mean = -1e300;
  const int steps = static_cast<int>(kLongestDelay_s / 0.1);
  for (int step = -steps; step <= steps; ++step) {
    AxesEvidence evidence;
    for (std::size_t k = 0; k < s.dvl_time_s.size(); ++k) {
      const double t = s.dvl_time_s[k] + 0.1 * step;
      if (velocity_frd.covers(t, t)) evidence.add(velocity_frd.at(t), s.data.velocity_dvl[k]);
    }
    if (evidence.count() * 2 < s.dvl_time_s.size()) continue;
    const double mean = evidence.ranking()[0].log_likelihood / static_cast<double>(evidence.count());
    if (mean > best_mean) {
      best_mean = mean;
      best = evidence;
    }
  }
  return best;
}

std::string signsText(const Vector3d& sign) {
  std::string text = "(";
  constexpr const char* kNames[] = {"roll", "pitch", "yaw"};
  for (int i = 0; i < 3; ++i) text += (i > 0 ? ", " : "") + std::string(sign[i] < 0 ? "-" : "+") + kNames[i];
  return text + ")";
}

std::string axesText(const SignedAxes& axes) {
  if (axes == SignedAxes{}) return axes.text() + " of the columns is forward, right, down";
  return axes.text() + " of the columns is forward, right, down: corrected" +
         (axes.proper() ? "" : " (as published the axes are left-handed: no mounting explains it)");
}

}  // namespace

std::vector<AttitudeHypothesis> rankAttitudes(const AlignedStreams& s) {
  std::vector<AttitudeHypothesis> all;
  for (int bits = 0; bits < 8; ++bits) {
    AttitudeHypothesis h{{bits & 1 ? -1. : 1., bits & 2 ? -1. : 1., bits & 4 ? -1. : 1.}, {}, {}, {}};
    const auto R_ned_frd = attitudesNed(s.data, h.sign);
    const AxesEvidence gyro = gyroEvidence(s, R_ned_frd);
    const AxesEvidence accelerometer = accelerometerEvidence(s, R_ned_frd);
    const AxesEvidence dvl = dvlEvidence(s, R_ned_frd);
    h.gyro = gyro.ranking();
    h.accelerometer = accelerometer.ranking();
    h.dvl = dvl.ranking();
    h.gyro_rows = gyro.count();
    h.accelerometer_rows = accelerometer.count();
    h.dvl_rows = dvl.count();
    h.gyro_told = gyro.expectedRms() / h.gyro[0].residual_rms.norm();
    all.push_back(std::move(h));
  }
  const AttitudeHypothesis published = all[0];
  stableSort(all, [](const AttitudeHypothesis& a, const AttitudeHypothesis& b) {
    return a.log_likelihood() > b.log_likelihood();
  });
  const double against_published =
      residualRatio(all[0].log_likelihood(), published.log_likelihood(), published.gyro_rows);
  if (all[0].sign != published.sign && against_published < kDecisiveRatio) {
    std::stable_partition(all.begin(), all.end(),
                          [&](const AttitudeHypothesis& h) { return h.sign == published.sign; });
  }
  return all;
}

void settleAttitude(const std::vector<AttitudeHypothesis>& ranked, SeaTrialConventions& c) {
  const AttitudeHypothesis &best = ranked[0], &other = ranked[1];
  c.attitude_sign = best.sign;
  c.conclusions.push_back(
      {"attitude columns",
       "R_ned_frd = Rz(yaw) Ry(pitch) Rx(roll) of " + signsText(best.sign) +
           (best.sign == Vector3d::Ones() ? ", as published" : ", signs corrected"),
       signsText(other.sign) + " with gyro " + other.gyro[0].axes.text() + ", accelerometer " +
           other.accelerometer[0].axes.text() + ", DVL " + other.dvl[0].axes.text(),
       residualRatio(best.log_likelihood(), other.log_likelihood(), best.gyro_rows),
       "gyro, accelerometer and DVL together, each with the axes that suit it best: RMS " +
           printVector("%.2g", best.gyro[0].residual_rms) + " rad/s, " +
           printVector("%.2g", best.accelerometer[0].residual_rms) + " m/s2, " +
           printVector("%.2g", best.dvl[0].residual_rms) + " m/s against " +
           printVector("%.2g", other.gyro[0].residual_rms) + ", " +
           printVector("%.2g", other.accelerometer[0].residual_rms) + ", " +
           printVector("%.2g", other.dvl[0].residual_rms)});
}

bool AttitudeHypothesis::gyroContradicts() const {
  return gyro_told < kDecisiveRatio && gyro[0].residual_rms.norm() > kContradicting_rad;
}

SignedAxes settleAxes(const std::string& what, const std::vector<AxesScore>& ranked, std::size_t rows,
                      const std::string& compared, const std::string& unit, SeaTrialConventions& c) {
  const AxesScore published =
      *std::find_if(ranked.begin(), ranked.end(), [](const AxesScore& s) { return s.axes == SignedAxes{}; });
  const bool decisive =
      residualRatio(ranked[0].log_likelihood, published.log_likelihood, rows) >= kDecisiveRatio;
  const AxesScore& best = decisive ? ranked[0] : published;
  const AxesScore& other = best.axes == ranked[0].axes ? ranked[1] : ranked[0];
  c.conclusions.push_back({what, axesText(best.axes), other.axes.text(),
                           residualRatio(best.log_likelihood, other.log_likelihood, rows),
                           compared + ", RMS " + printVector("%.2g", best.residual_rms) + " " + unit +
                               " against " + printVector("%.2g", other.residual_rms)});
  return best.axes;
}

void settleGyro(const AttitudeHypothesis& best, SeaTrialConventions& c) {
  const std::string compared = "mean rate between rows, attitude against gyro";
  if (!best.gyroContradicts()) {
    c.gyro = settleAxes("gyro axes", best.gyro, best.gyro_rows, compared, "rad/s", c);
    return;
  }
  c.gyro = c.accelerometer;
  c.conclusions.push_back(
      {"gyro axes", "those of the accelerometer, as its rate does not fit the attitude's in any",
       best.gyro[0].axes.text(), best.gyro_told,
       compared + ", RMS " + printVector("%.2g", best.gyro[0].residual_rms) + " rad/s at best"});
}

void concludeImuFrame(SeaTrialConventions& c) {
  const bool agree = c.gyro == c.accelerometer;
  c.conclusions.push_back(
      {"IMU axes as a whole",
       std::string(agree ? "gyro and accelerometer agree"
                         : "gyro and accelerometer disagree: they are corrected separately") +
           (agree && !c.gyro.proper() ? ": one left-handed set of axes, put right in both" : ""),
       "", 0.0, ""});
}

}  // namespace fathom
