#include "sea_trial/remarks.h"

#include <ceres/jet.h>

#include <algorithm>
#include <cmath>

#include "core/linear_algebra.h"
#include "core/median.h"
#include "core/text.h"
#include "sensors/dvl.h"

namespace fathom {
namespace {

/// A point that is known less well is not worth moving anything by.
constexpr double kPointIsTold_m = 0.1;

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

/// The mean turning rate from so long before a time to as long after, robot axes.
Vector3d rateAt(const AlignedStreams& s, const SeaTrialConventions& c, double t, double half_s) {
  return flipFrdRobot() * c.gyro.matrix() * (s.turned_imu.at(t + half_s) - s.turned_imu.at(t - half_s)) /
         (2.0 * half_s);
}

/// What the DVL should read by its sensor's model, and that model's derivative by what the fit looks for,
/// where there is nothing of it. Columns: scale, rotation (3), lever arm (3).
class DvlModel {
 public:
  using Jet = ceres::Jet<double, 7>;
  using Design = Eigen::Matrix<double, 3, 7>;

  DvlModel() {
    effects_.add<DvlScale>({Jet(0, 0)});
    const auto ofDegrees = [](int column) {
      Jet angle_deg(0);
      angle_deg.v[column] = degrees(1.0);
      return angle_deg;
    };
    effects_.add<DvlMisalignment>({ofDegrees(1), ofDegrees(2), ofDegrees(3)});
    effects_.add<DvlLeverArm>({Jet(0, 4), Jet(0, 5), Jet(0, 6)});
  }

  /// Of a robot that moves and turns so, in its axes.
  Design design(const Vector3d& velocity, const Vector3d& rate) const {
    Inputs<Jet> in;
    in.state.velocity_robot = velocity.cast<Jet>();
    in.state.angular_velocity_robot = rate.cast<Jet>();
    in.effects = effects_;
    const Vector3<Jet> reading = Dvl::velocity(in, {});
    Design design;
    for (int i = 0; i < 3; ++i) design.row(i) = reading[i].v;
    return design;
  }

 private:
  EffectParameters<Jet> effects_;
};

/// How a point moves against the IMU, by where it is from there (robot axes).
Matrix3d byLeverArmNed(const AlignedStreams& s, const SeaTrialConventions& c, const Matrix3d& R_ned_frd,
                       double t) {
  static const DvlModel model;
  return R_ned_frd * flipFrdRobot() * model.design(Vector3d::Zero(), rateAt(s, c, t, 0.1)).rightCols<3>();
}

template <int size>
struct Fit {
  Eigen::Matrix<double, size, 1> parameters, sigmas;
  Vector3d before, after;  ///< RMS of each axis
  double sum = 1e300;
};

template <int size>
Fit<size> leastSquares(const std::vector<Eigen::Matrix<double, 3, size>>& designs,
                       const std::vector<Vector3d>& differences) {
  using Square = Eigen::Matrix<double, size, size>;
  Square normal = Square::Identity() * 1e-9;
  Eigen::Matrix<double, size, 1> right = Eigen::Matrix<double, size, 1>::Zero();
  for (std::size_t k = 0; k < designs.size(); ++k) {
    normal += designs[k].transpose() * designs[k];
    right += designs[k].transpose() * differences[k];
  }
  Fit<size> fit;
  const Square inverse = inverseOf(normal);
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

using DvlFit = Fit<7>;

/// What the IMU's velocity changes by between two times, and the derivative of that by a bias in robot axes.
struct Pushed {
  Vector3d velocity_ned = Vector3d::Zero();
  Matrix3d by_bias_ned = Matrix3d::Zero();
};

/// From the attitude at the first one on, turned by the gyro.
Pushed pushedBetween(const AlignedStreams& s, const SeaTrialConventions& c, const Matrix3d& R_ned_frd,
                     double from, double to) {
  constexpr double kLongestStep_s = 0.03;
  const int steps = std::max(1, static_cast<int>(std::ceil((to - from) / kLongestStep_s)));
  const double step = (to - from) / steps;
  Pushed pushed;
  pushed.velocity_ned = -World<double>{}.gravity_odom * (to - from);
  for (int i = 0; i < steps; ++i) {
    const double begin = from + i * step;
    const Vector3d turned = s.turned_imu.at(begin + 0.5 * step) - s.turned_imu.at(from);
    const Matrix3d R = R_ned_frd * expSO3<double>(c.gyro.matrix() * turned);
    pushed.velocity_ned +=
        R * c.accelerometer.matrix() * (s.pushed_imu.at(begin + step) - s.pushed_imu.at(begin));
    pushed.by_bias_ned -= R * flipFrdRobot() * step;
  }
  return pushed;
}

/// The IMU's velocity in FRD at a time: the solution's of the row before, less what its point moves by, and
/// from there by the IMU. (Straight lines between rows a second apart would be off by centimetres a second.)
Vector3d imuVelocityFrd(const AlignedStreams& s, const SeaTrialConventions& c,
                        const std::vector<Matrix3d>& R_ned_frd, double t) {
  const auto next = std::upper_bound(s.gt_time_s.begin(), s.gt_time_s.end(), t);
  const auto k = static_cast<std::size_t>(std::max<std::ptrdiff_t>(next - s.gt_time_s.begin() - 1, 0));
  const double from = s.gt_time_s[k];
  const Pushed pushed = pushedBetween(s, c, R_ned_frd[k], from, t);
  const Vector3d velocity_ned = s.data.velocity_ned[k] -
                                byLeverArmNed(s, c, R_ned_frd[k], from) * c.reference_point_m +
                                pushed.velocity_ned + pushed.by_bias_ned * c.accelerometer_bias_m_s2;
  const Matrix3d R =
      R_ned_frd[k] * expSO3<double>(c.gyro.matrix() * (s.turned_imu.at(t) - s.turned_imu.at(from)));
  return R.transpose() * velocity_ned;
}

/// Worse known, it is not told: straight ahead nothing tells how a DVL rolls.
constexpr double kToldScale = 0.1, kTold_rad = radians(5.0);

Vector3d told(const Vector3d& rotation, const Vector3d& sigma, double limit) {
  return (sigma.array() < limit).select(rotation, Vector3d::Zero());
}

/// What a DVL reads of a velocity: scale Exp(-rotation) of it.
struct ScaleAndTurn {
  double scale = 1.0;
  Matrix3d turn = Matrix3d::Identity();

  Vector3d undone(const Vector3d& reading) const { return turn.transpose() * reading / scale; }
  Vector3d rotation() const { return -logSO3<double>(turn); }
  /// The same, and what a fit finds off yet: (1 + error) I - rotation x, which is linear: cosine and sine of
  /// a large angle.
  ScaleAndTurn improved(double scale_error, const Vector3d& rotation) const {
    const double cosine = 1.0 + scale_error, sine = rotation.norm();
    const Vector3d angle = sine > 0 ? Vector3d(rotation * (std::atan2(sine, cosine) / sine)) : rotation;
    return {scale * std::hypot(cosine, sine), turn * expSO3<double>(-angle)};
  }
  /// By what the fit tells.
  ScaleAndTurn improved(const DvlFit& fit) const {
    const double length = 1.0 + fit.parameters[0];  // axes are settled: it is turned by 45 degrees at most
    return improved(fit.sigmas[0] < kToldScale * length ? fit.parameters[0] : 0.0,
                    told(fit.parameters.segment<3>(1), fit.sigmas.segment<3>(1), kTold_rad * length));
  }
};

/// What is off beyond what is known.
DvlFit fitDvlAtDelay(const AlignedStreams& s, const SeaTrialConventions& c,
                     const std::vector<Matrix3d>& R_ned_frd, double delay_s, const ScaleAndTurn& known) {
  const Matrix3d to_robot = flipFrdRobot();
  const DvlModel model;
  std::vector<DvlModel::Design> designs;
  std::vector<Vector3d> differences;
  for (std::size_t k = 0; k < s.dvl_time_s.size(); ++k) {
    const double t = s.dvl_time_s[k] + delay_s;
    if (t < s.gt_time_s.front() || t > s.gt_time_s.back() || !s.turned_imu.covers(t - 0.5, t + 0.5)) continue;
    const Vector3d velocity = to_robot * imuVelocityFrd(s, c, R_ned_frd, t);
    designs.push_back(model.design(velocity, rateAt(s, c, t, 0.1)));
    differences.emplace_back(known.undone(to_robot * c.dvl.matrix() * s.data.velocity_dvl[k]) - velocity);
  }
  return designs.size() * 2 < s.dvl_time_s.size() ? DvlFit{} : leastSquares(designs, differences);
}

}  // namespace

double DvlRegression::toldScaleError() const {
  return scale_error_sigma < kToldScale * (1 + scale_error) ? scale_error : 0.0;
}

Vector3d DvlRegression::toldRotation() const { return told(rotation_rad, rotation_sigma_rad, kTold_rad); }

bool DvlRegression::explainsMore() const {
  constexpr double kSeen_m_s = 0.05;  // at rest a vehicle's own velocity is noise, too
  return residual_before_m_s.norm() > kSeen_m_s &&
         kDecisiveRatio * residual_m_s.norm() < residual_before_m_s.norm();
}

bool DvlRegression::fits() const { return 3 * residual_m_s.norm() < residual_before_m_s.norm(); }

bool DvlRegression::isDelayed() const {
  constexpr double kClear_s = 0.1;
  return std::abs(delay_s) >= kClear_s && std::abs(delay_s) < kLongestDelay_s &&
         residual_undelayed_m_s > kDecisiveRatio * residual_m_s.norm();
}

void settleReferencePoint(const AlignedStreams& s, SeaTrialConventions& c) {
  // A point on a lever arm r from the IMU moves by what a DVL there would read more: its model's derivative
  // by r. So the solution's change of velocity is the IMU's, and the change of that.
  const auto R_ned_frd = attitudesNed(s.data, c.attitude_sign);
  const auto lever_ned = [&](std::size_t k) { return byLeverArmNed(s, c, R_ned_frd[k], s.gt_time_s[k]); };
  std::vector<Eigen::Matrix<double, 3, 6>> designs;  // by the point and by the accelerometer's bias
  std::vector<Vector3d> differences;
  for (std::size_t k = 0; k + 1 < R_ned_frd.size(); ++k) {
    if (!s.pushed_imu.covers(s.gt_time_s[k] - 0.1, s.gt_time_s[k + 1] + 0.1)) continue;
    const Pushed pushed = pushedBetween(s, c, R_ned_frd[k], s.gt_time_s[k], s.gt_time_s[k + 1]);
    designs.emplace_back();
    designs.back() << lever_ned(k + 1) - lever_ned(k), pushed.by_bias_ned;
    differences.emplace_back(s.data.velocity_ned[k + 1] - s.data.velocity_ned[k] - pushed.velocity_ned);
  }
  if (designs.size() < 10) return;
  const auto fit = leastSquares(designs, differences);
  const Vector3d point = fit.parameters.head<3>(), sigma = fit.sigmas.head<3>();
  const bool is_told = sigma.maxCoeff() < kPointIsTold_m;
  if (is_told) {
    c.reference_point_m = point;
    c.reference_point_sigma_m = sigma;
    c.accelerometer_bias_m_s2 = fit.parameters.tail<3>();
  }
  c.conclusions.push_back(
      {"the navigation solution's point",
       (is_told ? std::string() : "taken for the IMU: the vehicle turns too little to tell, ") +
           printVector("%+.2f", point) + " +- " + printVector("%.3f", sigma) + " m from the IMU",
       "", 0.0,
       "its change of velocity against the IMU's, least squares, robot axes (x forward, y left, z up): RMS " +
           printVector("%.3f", fit.before) + " m/s before, " + printVector("%.3f", fit.after) +
           " m/s after"});
}

void reportDvl(const AlignedStreams& s, SeaTrialConventions& c) {
  const auto R_ned_frd = attitudesNed(s.data, c.attitude_sign);
  DvlFit best;
  DvlRegression& r = c.dvl_regression;
  ScaleAndTurn known;
  const auto search = [&](double centre_s, double reach_s, double step_s) {
    const int steps = static_cast<int>(std::lround(reach_s / step_s));
    for (int step = -steps; step <= steps; ++step) {
      const DvlFit fit = fitDvlAtDelay(s, c, R_ned_frd, centre_s + step_s * step, known);
      if (fit.sum >= best.sum) continue;
      best = fit;
      r.delay_s = centre_s + step_s * step;
    }
  };
  search(0.0, kLongestDelay_s, 0.2);
  r.residual_before_m_s = best.before;
  for (int i = 0; i < 5; ++i) {
    known = known.improved(best);
    best = fitDvlAtDelay(s, c, R_ned_frd, r.delay_s, known);
  }
  search(r.delay_s, 0.2, 0.02);
  r.residual_undelayed_m_s = std::sqrt(fitDvlAtDelay(s, c, R_ned_frd, 0.0, known).sum);
  known = known.improved(best.parameters[0], best.parameters.segment<3>(1));
  r.scale_error = known.scale - 1.0;
  r.scale_error_sigma = best.sigmas[0] * known.scale;
  r.rotation_rad = known.rotation();
  r.rotation_sigma_rad = best.sigmas.segment<3>(1);
  r.lever_arm_m = best.parameters.tail<3>();
  r.lever_arm_sigma_m = best.sigmas.tail<3>();
  r.residual_m_s = best.after;
  c.conclusions.push_back(
      {"DVL against the navigation solution",
       print("scale error %+.4f +- %.4f", r.scale_error, r.scale_error_sigma) + ", rotation " +
           printVector("%+.2f", r.rotation_rad * degrees(1.0)) + " +- " +
           printVector("%.2f", r.rotation_sigma_rad * degrees(1.0)) + " deg, lever arm " +
           printVector("%+.2f", r.lever_arm_m) + " +- " + printVector("%.2f", r.lever_arm_sigma_m) +
           print(" m from the IMU, valid %+.2f s after its stamp on the IMU's clock (left as it is: `fathom "
                 "diagnose` finds both)",
                 r.delay_s),
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
  const Vector3d earth = EarthRotation::kRate_rad_s * Vector3d(std::cos(latitude), 0.0, -std::sin(latitude));
  const double with = (c.rate_excess_ned - earth).norm(), without = c.rate_excess_ned.norm();
  const bool contained = with < without;
  constexpr const char *kContained = "contained (not compensated, not corrected)", *kNone = "not contained";
  c.conclusions.push_back(
      {"Earth's rotation in the gyro", contained ? kContained : kNone, contained ? kNone : kContained,
       contained ? without / with : with / std::max(without, 1e-12),
       "gyro minus the solution's rate, median, north east down " + printVector("%.2g", c.rate_excess_ned) +
           " rad/s; Earth turns " + printVector("%.2g", earth)});
}

}  // namespace fathom
