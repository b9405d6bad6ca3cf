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

struct DvlFit {
  Eigen::Matrix<double, 7, 1> parameters, sigmas;
  Vector3d before, after;
  double sum = 1e300;
};

DvlFit fitDvl(const std::vector<DvlModel::Design>& designs, const std::vector<Vector3d>& differences) {
  Eigen::Matrix<double, 7, 7> normal = Eigen::Matrix<double, 7, 7>::Identity() * 1e-9;
  Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero();
  for (std::size_t k = 0; k < designs.size(); ++k) {
    normal += designs[k].transpose() * designs[k];
    right += designs[k].transpose() * differences[k];
  }
  DvlFit fit;
  const Eigen::Matrix<double, 7, 7> inverse = inverseOf(normal);
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

DvlFit fitDvlAtDelay(const AlignedStreams& s, const SeaTrialConventions& c, const SampledSignal& velocity_frd,
                     double delay_s) {
  const Matrix3d to_robot = flipFrdRobot();
  const DvlModel model;
  std::vector<DvlModel::Design> designs;
  std::vector<Vector3d> differences;
  for (std::size_t k = 0; k < s.dvl_time_s.size(); ++k) {
    const double t = s.dvl_time_s[k] + delay_s;
    if (!velocity_frd.covers(t, t) || !s.turned_imu.covers(t - 0.5, t + 0.5)) continue;
    const Vector3d velocity = to_robot * velocity_frd.at(t);
    const Vector3d rate = to_robot * c.gyro.matrix() * (s.turned_imu.at(t + 0.5) - s.turned_imu.at(t - 0.5));
    designs.push_back(model.design(velocity, rate));
    differences.emplace_back(to_robot * c.dvl.matrix() * s.data.velocity_dvl[k] - velocity);
  }
  return designs.size() * 2 < s.dvl_time_s.size() ? DvlFit{} : fitDvl(designs, differences);
}

}  // namespace

void reportDvl(const AlignedStreams& s, SeaTrialConventions& c) {
  const SampledSignal velocity_frd = velocityFrd(s, attitudesNed(s.data, c.attitude_sign));
  DvlFit best;
  DvlRegression& r = c.dvl_regression;
  const int steps = static_cast<int>(kLongestDelay_s / 0.02);
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
