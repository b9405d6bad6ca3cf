#include "recording/sea_trial.h"

#include <mrpt/topography/conversions.h>

#include <Eigen/Dense>
#include <algorithm>
#include <stdexcept>

#include "core/median.h"
#include "core/text.h"

namespace fathom {
namespace {

constexpr double kGravity = 9.80665;        // m/s²; a local value 0.1 % off changes no conclusion
constexpr double kEarthRate = 7.292115e-5;  // rad/s, WGS-84
constexpr double kLongestDelay = 3.0;       // s, searched on both sides

// ---- small helpers ----

std::string printVector(const char* number_format, const Vector3d& v) {
  std::string text = "(";
  for (int i = 0; i < 3; ++i) {
    if (i > 0) text += ", ";
    text += print(number_format, v[i]);
  }
  return text + ")";
}

/// A sampled vector signal, straight lines between the samples, constant outside.
class Signal {
 public:
  Signal(const std::vector<double>& time_s, std::vector<Vector3d> value)
      : time_(time_s), value_(std::move(value)) {}

  Vector3d at(double t) const {
    const auto after = std::upper_bound(time_.begin(), time_.end(), t);
    if (after == time_.begin()) return value_.front();
    if (after == time_.end()) return value_.back();
    const auto k = static_cast<std::size_t>(after - time_.begin());
    const double share = (t - time_[k - 1]) / (time_[k] - time_[k - 1]);
    return (1.0 - share) * value_[k - 1] + share * value_[k];
  }
  bool covers(double from, double to) const { return from >= time_.front() && to <= time_.back(); }

  /// Its integral from the first sample on, by trapezia.
  Signal integral() const {
    std::vector<Vector3d> sum{Vector3d::Zero()};
    for (std::size_t k = 1; k < value_.size(); ++k)
      sum.emplace_back(sum.back() + 0.5 * (time_[k] - time_[k - 1]) * (value_[k] + value_[k - 1]));
    return {time_, std::move(sum)};
  }

 private:
  std::vector<double> time_;
  std::vector<Vector3d> value_;
};

std::vector<double> scaled(std::vector<double> time_s, double factor) {
  for (double& t : time_s) t = time_s.front() + (t - time_s.front()) * factor;
  return time_s;
}

double rootMeanSquare(double sum_of_squares, std::size_t count) {
  return std::sqrt(sum_of_squares / static_cast<double>(std::max<std::size_t>(count, 1)));
}

Vector3d median(const std::vector<Vector3d>& values) {
  Vector3d result = Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    std::vector<double> column;
    column.reserve(values.size());
    for (const Vector3d& v : values) column.push_back(v[i]);
    if (!column.empty()) result[i] = upperMedian(std::move(column));
  }
  return result;
}

/// Ratio of residuals as the product over the axes, from the log likelihoods of `count` rows.
double residualRatio(double best, double other, std::size_t count) {
  return std::exp((best - other) / static_cast<double>(std::max<std::size_t>(count, 1)));
}

// ---- columns ----

double positionResidual(const SeaTrialData& data, bool swapped) {
  const auto position = positionsEnu(data, swapped, 1);
  const Signal travelled = Signal(data.gt_time_s, data.velocity_ned).integral();
  std::vector<Vector3d> difference;
  Vector3d mean = Vector3d::Zero();
  for (std::size_t k = 0; k < position.size(); ++k) {
    difference.emplace_back(position[k] - swapNedEnu() * travelled.at(data.gt_time_s[k]));
    mean += difference.back() / static_cast<double>(position.size());
  }
  double sum = 0.0;
  for (const Vector3d& d : difference) sum += (d - mean).head<2>().squaredNorm();
  return rootMeanSquare(sum, position.size());
}

void settlePositionColumns(const SeaTrialData& data, SeaTrialConventions& c) {
  const double named = positionResidual(data, false), swapped = positionResidual(data, true);
  c.position_columns_swapped = swapped * kDecisiveRatio < named;
  const double best = c.position_columns_swapped ? swapped : named;
  const double other = c.position_columns_swapped ? named : swapped;
  constexpr const char *kNamed = "as named", *kSwapped = "names swapped";
  const double latitude = c.position_columns_swapped ? data.longitude_rad[0] : data.latitude_rad[0];
  const double longitude = c.position_columns_swapped ? data.latitude_rad[0] : data.longitude_rad[0];
  c.conclusions.push_back(
      {"longitude and latitude columns", c.position_columns_swapped ? kSwapped : kNamed,
       c.position_columns_swapped ? kNamed : kSwapped, other / best,
       print("position minus integrated V north and V east, RMS %.3g m against %.4g m; the section starts at "
             "%.5f deg north, %.5f deg east",
             best, other, degrees(latitude), degrees(longitude))});
}

void settleAltitude(const SeaTrialData& data, SeaTrialConventions& c) {
  double up = 0.0, down = 0.0;
  const std::size_t rows = data.gt_time_s.size();
  for (std::size_t k = 1; k + 1 < rows; ++k) {
    const double climb =
        (data.altitude_m[k + 1] - data.altitude_m[k - 1]) / (data.gt_time_s[k + 1] - data.gt_time_s[k - 1]);
    up += std::pow(climb + data.velocity_ned[k].z(), 2);
    down += std::pow(climb - data.velocity_ned[k].z(), 2);
  }
  up = rootMeanSquare(up, rows - 2);
  down = rootMeanSquare(down, rows - 2);
  c.altitude_sign = down * kDecisiveRatio < up ? -1 : 1;
  const bool is_up = c.altitude_sign > 0;
  c.conclusions.push_back({"altitude column", is_up ? "positive up" : "positive down",
                           is_up ? "positive down" : "positive up",
                           std::max(is_up ? down / up : up / down, 1.0),
                           print("its slope against -V down, RMS %.3g m/s against %.3g m/s",
                                 is_up ? up : down, is_up ? down : up)});
}

// ---- clocks ----

struct Alignment {
  double offset_s = 0.0;
  double residual_rad = 1e300;
};

/// The offset at which the angle turned between rows agrees best with the gyro's: angles have no axes.
Alignment alignTurnedAngles(const Signal& turned_imu, const std::vector<double>& gt_time_s,
                            const std::vector<Matrix3d>& attitude) {
  std::vector<double> angle;
  for (std::size_t k = 0; k + 1 < attitude.size(); ++k)
    angle.push_back(angleBetween(attitude[k], attitude[k + 1]));
  const auto residual = [&](double offset) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t k = 0; k < angle.size(); ++k) {
      const double from = gt_time_s[k] + offset, to = gt_time_s[k + 1] + offset;
      if (!turned_imu.covers(from, to)) continue;
      sum += std::pow((turned_imu.at(to) - turned_imu.at(from)).norm() - angle[k], 2);
      ++count;
    }
    return count * 2 < angle.size() ? 1e300 : rootMeanSquare(sum, count);
  };
  Alignment best{0.0, residual(0.0)};
  const auto search = [&](double centre, int steps, double step) {
    for (int k = -steps; k <= steps; ++k)
      if (const double r = residual(centre + k * step); r < best.residual_rad) best = {centre + k * step, r};
  };
  search(0.0, static_cast<int>(kLongestDelay / 0.02), 0.02);
  search(best.offset_s, 20, 0.001);
  return best;
}

void settleClocks(const SeaTrialData& data, const Signal& turned_imu, SeaTrialConventions& c) {
  const auto attitude = attitudesNed(data, Vector3d::Ones());
  const double rows = static_cast<double>(data.gt_time_s.size());
  const double stretch = (rows - 1.0) / rows;
  const Alignment stamped = alignTurnedAngles(turned_imu, data.gt_time_s, attitude);
  const Alignment restored = alignTurnedAngles(turned_imu, scaled(data.gt_time_s, stretch), attitude);
  if (stamped.residual_rad == 1e300)
    throw std::invalid_argument("IMU and navigation solution hardly overlap in time");
  const bool is_stretched = restored.residual_rad * kDecisiveRatio < stamped.residual_rad;
  const Alignment& best = is_stretched ? restored : stamped;
  const Alignment& other = is_stretched ? stamped : restored;
  c.stamp_stretch = is_stretched ? stretch : 1.0;
  c.imu_offset_s = best.offset_s;

  const double step =
      (data.gt_time_s.back() - data.gt_time_s.front()) / (static_cast<double>(data.gt_time_s.size()) - 1.0);
  const std::string as_stamped = print("%.6f s apart, as stamped", step);
  const std::string as_restored = print("%.6f s apart, stamps stretched by N/(N-1)", step * stretch);
  c.conclusions.push_back(
      {"stamps of DVL and navigation solution", is_stretched ? as_restored : as_stamped,
       is_stretched ? as_stamped : as_restored, other.residual_rad / best.residual_rad,
       print("angle turned between rows, attitude against gyro, each at its best constant offset: RMS %.3g "
             "rad against %.3g rad",
             best.residual_rad, other.residual_rad)});
  c.conclusions.push_back({"time alignment of navigation solution and IMU",
                           print("a row stamped t%s fits the IMU at t %+.3f s (not corrected)",
                                 is_stretched ? " (stretch undone)" : "", best.offset_s),
                           "", 0.0, "the same comparison; angles do not depend on axes"});
}

// ---- axes ----

/// What follows from one choice of the signs of roll, pitch and yaw.
struct AttitudeHypothesis {
  Vector3d sign;
  std::vector<AxesScore> gyro, accelerometer, dvl;
  std::size_t gyro_rows = 0, accelerometer_rows = 0, dvl_rows = 0;
  double log_likelihood() const {
    return gyro[0].log_likelihood + accelerometer[0].log_likelihood + dvl[0].log_likelihood;
  }
};

/// The streams on one clock, the IMU's, and the integrals that comparisons over intervals need.
struct AlignedStreams {
  const SeaTrialData& data;
  Signal turned_imu, pushed_imu;  // integrals of rate and acceleration
  std::vector<double> gt_time_s;
  std::vector<double> dvl_time_s;

  AlignedStreams(const SeaTrialData& d, const SeaTrialConventions& c)
      : data(d),
        turned_imu(Signal(d.imu_time_s, d.rate_imu).integral()),
        pushed_imu(Signal(d.imu_time_s, d.acceleration_imu).integral()),
        gt_time_s(scaled(d.gt_time_s, c.stamp_stretch)),
        dvl_time_s(scaled(d.dvl_time_s, c.stamp_stretch)) {
    for (double& t : gt_time_s) t += c.imu_offset_s;
  }
};

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
  AxesEvidence evidence;
  for (std::size_t k = 1; k + 1 < R_ned_frd.size(); ++k) {
    const double from = s.gt_time_s[k - 1], to = s.gt_time_s[k + 1];
    if (!s.pushed_imu.covers(from, to)) continue;
    const Vector3d acceleration_ned = (s.data.velocity_ned[k + 1] - s.data.velocity_ned[k - 1]) / (to - from);
    const Vector3d force_frd = R_ned_frd[k].transpose() * (acceleration_ned - Vector3d(0, 0, kGravity));
    evidence.add(force_frd, (s.pushed_imu.at(to) - s.pushed_imu.at(from)) / (to - from));
  }
  return evidence;
}

Signal velocityFrd(const AlignedStreams& s, const std::vector<Matrix3d>& R_ned_frd) {
  std::vector<Vector3d> velocity_frd;
  for (std::size_t k = 0; k < R_ned_frd.size(); ++k)
    velocity_frd.emplace_back(R_ned_frd[k].transpose() * s.data.velocity_ned[k]);
  return {s.gt_time_s, std::move(velocity_frd)};
}

/// DVL against the solution's velocity turned into the body, at the delay that suits the axes best.
AxesEvidence dvlEvidence(const AlignedStreams& s, const std::vector<Matrix3d>& R_ned_frd) {
  const Signal velocity_frd = velocityFrd(s, R_ned_frd);
  AxesEvidence best;
  double best_mean = -1e300;
  const int steps = static_cast<int>(kLongestDelay / 0.1);
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
    all.push_back(std::move(h));
  }
  const AttitudeHypothesis published = all[0];
  std::stable_sort(all.begin(), all.end(), [](const AttitudeHypothesis& a, const AttitudeHypothesis& b) {
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

std::string signsText(const Vector3d& sign) {
  std::string text = "(";
  constexpr const char* kNames[] = {"roll", "pitch", "yaw"};
  for (int i = 0; i < 3; ++i) text += (i > 0 ? ", " : "") + std::string(sign[i] < 0 ? "-" : "+") + kNames[i];
  return text + ")";
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

std::string axesText(const SignedAxes& axes) {
  if (axes == SignedAxes{}) return axes.text() + " of the columns is forward, right, down";
  return axes.text() + " of the columns is forward, right, down: corrected" +
         (axes.proper() ? "" : " (as published the axes are left-handed: no mounting explains it)");
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

void concludeImuFrame(SeaTrialConventions& c) {
  const bool agree = c.gyro == c.accelerometer;
  c.conclusions.push_back(
      {"IMU axes as a whole",
       std::string(agree ? "gyro and accelerometer agree"
                         : "gyro and accelerometer disagree: they are corrected separately") +
           (agree && !c.gyro.proper() ? ": one left-handed set of axes, put right in both" : ""),
       "", 0.0, ""});
}

// ---- information that is not corrected ----

/// Columns: scale, rotation (3), lever arm (3).
using DvlDesign = Eigen::Matrix<double, 3, 7>;

struct DvlFit {
  Eigen::Matrix<double, 7, 1> parameters, sigmas;
  Vector3d before, after;
  double sum = 1e300;
};

DvlFit fitDvl(const std::vector<DvlDesign>& designs, const std::vector<Vector3d>& differences) {
  Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Identity() * 1e-9;
  Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero();
  for (std::size_t k = 0; k < designs.size(); ++k) {
    normal += designs[k].transpose() * designs[k];
    right += designs[k].transpose() * differences[k];
  }
  DvlFit fit;
  const Eigen::Matrix<double, 7, 7> inverse = normal.inverse();
  fit.parameters = inverse * right;
  Vector3d before = Vector3d::Zero(), after = Vector3d::Zero();
  for (std::size_t k = 0; k < designs.size(); ++k) {
    before += differences[k].cwiseAbs2();
    after += (differences[k] - designs[k] * fit.parameters).cwiseAbs2();
  }
  const double count = static_cast<double>(designs.size());
  fit.before = (before / count).cwiseSqrt();
  fit.after = (after / count).cwiseSqrt();
  fit.sum = after.sum() / count;
  fit.sigmas = (inverse.diagonal() * (fit.sum / 3.0)).cwiseSqrt();
  return fit;
}

DvlFit fitDvlAtDelay(const AlignedStreams& s, const SeaTrialConventions& c, const Signal& velocity_frd,
                     double delay_s) {
  const Matrix3d to_robot = flipFrdRobot();
  std::vector<DvlDesign> designs;
  std::vector<Vector3d> differences;
  for (std::size_t k = 0; k < s.dvl_time_s.size(); ++k) {
    const double t = s.dvl_time_s[k] + delay_s;
    if (!velocity_frd.covers(t, t) || !s.turned_imu.covers(t - 0.5, t + 0.5)) continue;
    const Vector3d velocity = to_robot * velocity_frd.at(t);
    const Vector3d rate = to_robot * c.gyro.matrix() * (s.turned_imu.at(t + 0.5) - s.turned_imu.at(t - 0.5));
    DvlDesign design;
    design << velocity, crossMatrix<double>(velocity), crossMatrix<double>(rate);
    designs.push_back(design);
    differences.emplace_back(to_robot * c.dvl.matrix() * s.data.velocity_dvl[k] - velocity);
  }
  return designs.size() * 2 < s.dvl_time_s.size() ? DvlFit{} : fitDvl(designs, differences);
}

void reportDvl(const AlignedStreams& s, SeaTrialConventions& c) {
  const Signal velocity_frd = velocityFrd(s, attitudesNed(s.data, c.attitude_sign));
  DvlFit best;
  DvlRegression& r = c.dvl_regression;
  const int steps = static_cast<int>(kLongestDelay / 0.02);
  for (int step = -steps; step <= steps; ++step) {
    const DvlFit fit = fitDvlAtDelay(s, c, velocity_frd, 0.02 * step);
    if (fit.sum >= best.sum) continue;
    best = fit;
    r.delay_s = 0.02 * step;
  }
  r.scale_error = best.parameters[0];
  r.scale_error_sigma = best.sigmas[0];
  r.rotation_rad = best.parameters.segment<3>(1);
  r.rotation_sigma_rad = best.sigmas.segment<3>(1);
  r.lever_arm_m = best.parameters.tail<3>();
  r.lever_arm_sigma_m = best.sigmas.tail<3>();
  r.residual_before_m_s = best.before;
  r.residual_m_s = best.after;
  c.conclusions.push_back(
      {"DVL against the navigation solution",
       print("scale error %+.4f +- %.4f", r.scale_error, r.scale_error_sigma) + ", rotation " +
           printVector("%+.2f", r.rotation_rad * degrees(1.0)) + " +- " +
           printVector("%.2f", r.rotation_sigma_rad * degrees(1.0)) + " deg, lever arm " +
           printVector("%+.2f", r.lever_arm_m) + " +- " + printVector("%.2f", r.lever_arm_sigma_m) + " m" +
           print(", valid %+.2f s after its stamp on the IMU's clock (not corrected)", r.delay_s),
       "", 0.0,
       "least squares, robot axes (x forward, y left, z up): RMS " +
           printVector("%.3f", r.residual_before_m_s) + " m/s before, " +
           printVector("%.3f", r.residual_m_s) + " m/s after"});
}

void reportEarthRate(const AlignedStreams& s, SeaTrialConventions& c) {
  const auto R_ned_frd = attitudesNed(s.data, c.attitude_sign);
  std::vector<Vector3d> excess;
  for (std::size_t k = 0; k + 1 < R_ned_frd.size(); ++k) {
    const double from = s.gt_time_s[k], to = s.gt_time_s[k + 1];
    if (!s.turned_imu.covers(from, to)) continue;
    const Vector3d turned = c.gyro.matrix() * (s.turned_imu.at(to) - s.turned_imu.at(from));
    const Vector3d solution = logSO3<double>(R_ned_frd[k].transpose() * R_ned_frd[k + 1]);
    excess.emplace_back(R_ned_frd[k] * (turned - solution) / (to - from));
  }
  c.rate_excess_ned = median(excess);
  const double latitude = c.position_columns_swapped ? s.data.longitude_rad[0] : s.data.latitude_rad[0];
  const Vector3d earth(kEarthRate * std::cos(latitude), 0.0, -kEarthRate * std::sin(latitude));
  const double with = (c.rate_excess_ned - earth).norm(), without = c.rate_excess_ned.norm();
  const bool contained = with < without;
  constexpr const char *kContained = "contained (not compensated, not corrected)", *kNone = "not contained";
  c.conclusions.push_back(
      {"Earth's rotation in the gyro", contained ? kContained : kNone, contained ? kNone : kContained,
       contained ? without / with : with / std::max(without, 1e-12),
       "gyro minus the solution's rate, median, north east down " + printVector("%.2g", c.rate_excess_ned) +
           " rad/s; Earth turns " + printVector("%.2g", earth)});
}

}  // namespace

Matrix3d swapNedEnu() {
  Matrix3d m;
  m << 0, 1, 0, 1, 0, 0, 0, 0, -1;
  return m;
}

Matrix3d flipFrdRobot() { return Vector3d(1, -1, -1).asDiagonal(); }

std::vector<Vector3d> positionsEnu(const SeaTrialData& data, bool columns_swapped, int altitude_sign) {
  const auto& latitude = columns_swapped ? data.longitude_rad : data.latitude_rad;
  const auto& longitude = columns_swapped ? data.latitude_rad : data.longitude_rad;
  const auto geodetic = [&](std::size_t k) {
    return mrpt::topography::TGeodeticCoords(degrees(latitude[k]), degrees(longitude[k]),
                                             altitude_sign * data.altitude_m[k]);
  };
  const auto origin = geodetic(0);
  std::vector<Vector3d> positions;
  for (std::size_t k = 0; k < latitude.size(); ++k) {
    mrpt::math::TPoint3D p;
    mrpt::topography::geodeticToENU_WGS84(geodetic(k), p, origin);
    positions.emplace_back(p.x, p.y, p.z);
  }
  return positions;
}

std::vector<Matrix3d> attitudesNed(const SeaTrialData& data, const Vector3d& attitude_sign) {
  std::vector<Matrix3d> attitudes;
  for (const Vector3d& published : data.roll_pitch_yaw) {
    const Vector3d a = published.cwiseProduct(attitude_sign);
    attitudes.push_back(rotationFromYawPitchRoll(a[2], a[1], a[0]));
  }
  return attitudes;
}

SeaTrialConventions establishConventions(const SeaTrialData& data) {
  if (data.gt_time_s.size() < 10 || data.dvl_time_s.size() < 10 || data.imu_time_s.size() < 10)
    throw std::invalid_argument("too few rows to establish anything: 10 are needed");
  SeaTrialConventions c;
  settlePositionColumns(data, c);
  settleAltitude(data, c);
  settleClocks(data, Signal(data.imu_time_s, data.rate_imu).integral(), c);

  const AlignedStreams streams(data, c);
  const auto ranked = rankAttitudes(streams);
  const AttitudeHypothesis& best = ranked[0];
  if (best.dvl_rows == 0) throw std::invalid_argument("DVL and navigation solution hardly overlap in time");
  settleAttitude(ranked, c);
  c.gyro = settleAxes("gyro axes", best.gyro, best.gyro_rows, "mean rate between rows, attitude against gyro",
                      "rad/s", c);
  c.accelerometer =
      settleAxes("accelerometer axes (specific force)", best.accelerometer, best.accelerometer_rows,
                 "change of velocity less gravity, in the body, against accelerometer", "m/s2", c);
  concludeImuFrame(c);
  c.dvl = settleAxes("DVL axes", best.dvl, best.dvl_rows,
                     "velocity north, east, down turned into the body, against DVL", "m/s", c);
  reportDvl(streams, c);
  reportEarthRate(streams, c);
  return c;
}

}  // namespace fathom
