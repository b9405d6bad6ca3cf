#include "support/sea_trials.h"

#include <fstream>

#include "core/kinematics.h"
#include "core/random.h"

namespace fathom::test {
namespace sea_trial_motion {

Matrix3d attitude(double t) {
  return rotationFromYawPitchRoll(1.1 + 1.5 * std::sin(0.05 * t) + 0.2 * std::sin(0.31 * t),
                                  -0.02 + 0.07 * std::sin(0.11 * t + 1), 0.03 + 0.05 * std::sin(0.23 * t));
}
Vector3d velocityFrd(double t) {
  return {2.0 + 0.3 * std::sin(0.07 * t), 0.05 * std::sin(0.13 * t), 0.03 * std::cos(0.19 * t)};
}
Vector3d velocityNed(double t) { return attitude(t) * velocityFrd(t); }
Vector3d rateFrd(double t) {
  constexpr double kStep = 1e-4;
  return logSO3<double>(attitude(t - kStep).transpose() * attitude(t + kStep)) / (2 * kStep);
}
Vector3d specificForceFrd(double t) {
  constexpr double kStep = 1e-4;
  const Vector3d acceleration_ned = (velocityNed(t + kStep) - velocityNed(t - kStep)) / (2 * kStep);
  return attitude(t).transpose() * (acceleration_ned - Vector3d(0, 0, 9.7955));
}

}  // namespace sea_trial_motion

namespace {
using namespace sea_trial_motion;

/// Latitude, longitude (rad) and height (m), moved over the ellipsoid by its radii of curvature: independent
/// of the importer's conversion. (MRPT 2.5.8's ENUToGeocentric will not do: its up is geocentric.)
struct Geodetic {
  double latitude = kTrialLatitude, longitude = kTrialLongitude, height = -20.0;
  void move(const Vector3d& step_ned) {
    constexpr double kA = 6378137.0, kE2 = 6.69437999014e-3;  // WGS-84
    const double w2 = 1 - kE2 * std::pow(std::sin(latitude), 2);
    latitude += step_ned.x() / (kA * (1 - kE2) / std::pow(w2, 1.5) + height);
    longitude += step_ned.y() / ((kA / std::sqrt(w2) + height) * std::cos(latitude));
    height -= step_ned.z();
  }
};

Vector3d pointVelocityNed(double t, const Oddities& odd) {
  return attitude(t) * (velocityFrd(t) + rateFrd(t).cross(flipFrdRobot() * odd.reference_point_robot));
}

void addGtRow(SeaTrialData& d, const Oddities& odd, double stamp, double t, const Geodetic& g) {
  d.gt_time_s.push_back(stamp);
  d.latitude_rad.push_back(odd.columns_swapped ? g.longitude : g.latitude);
  d.longitude_rad.push_back(odd.columns_swapped ? g.latitude : g.longitude);
  d.altitude_m.push_back(odd.altitude_down ? -g.height : g.height);
  d.velocity_ned.push_back(pointVelocityNed(t, odd));
  const Vector3d ypr = yawPitchRollFromRotation(attitude(t));
  d.roll_pitch_yaw.emplace_back(Vector3d(ypr[2], ypr[1], ypr[0]).cwiseProduct(odd.attitude_sign));
}

void writeTable(const std::filesystem::path& file, const std::string& header,
                const std::vector<std::vector<double>>& rows) {
  std::ofstream out(file);
  out << header << '\n';
  out.precision(17);
  for (const auto& row : rows)
    for (std::size_t i = 0; i < row.size(); ++i) out << row[i] << (i + 1 < row.size() ? ',' : '\n');
}

}  // namespace

SeaTrialData makeSeaTrial(const Oddities& odd, std::uint64_t seed) {
  Random random(seed);
  SeaTrialData d;
  // measured = axes^-1 (frd): the axes are orthonormal.
  const Matrix3d gyro = odd.gyro.matrix().transpose(), force = odd.accelerometer.matrix().transpose(),
                 dvl = odd.dvl.matrix().transpose();
  const Vector3d earth_ned = 7.292115e-5 * Vector3d(std::cos(kTrialLatitude), 0, -std::sin(kTrialLatitude));
  for (int k = 0; k < 100 * kTrialRows; ++k) {
    const double t = 0.01 * k;
    Vector3d rate = rateFrd(t);
    if (odd.earth_rate) rate += attitude(t).transpose() * earth_ned;
    d.imu_time_s.push_back(t);
    d.rate_imu.emplace_back(gyro * rate + 5e-4 * random.normal3());
    d.acceleration_imu.emplace_back(force * specificForceFrd(t) + 0.02 * random.normal3());
  }
  const double step = odd.stamps_stretched ? kTrialRows / (kTrialRows - 1.0) : 1.0;
  Geodetic position;
  for (int k = 0; k < kTrialRows; ++k) {
    const double t = k + odd.imu_offset_s;
    addGtRow(d, odd, k * step, t, position);
    for (int i = 0; i < 100; ++i) position.move(0.01 * pointVelocityNed(t + 0.01 * i + 0.005, odd));
    const double valid = k + odd.dvl_delay_s;
    const Vector3d lever_frd = flipFrdRobot() * odd.dvl_lever_arm_robot;
    const Vector3d reading = velocityFrd(valid) + rateFrd(valid).cross(lever_frd);
    d.dvl_time_s.push_back(k * step);
    d.velocity_dvl.emplace_back(dvl * reading * (1 + odd.dvl_scale_error) + 0.01 * random.normal3());
  }
  return d;
}

SeaTrialFiles writeSeaTrial(const SeaTrialData& d, const std::filesystem::path& folder) {
  std::vector<std::vector<double>> imu, dvl, gt;
  for (std::size_t k = 0; k < d.imu_time_s.size(); ++k) {
    const Vector3d &a = d.acceleration_imu[k], &w = d.rate_imu[k];
    imu.push_back({d.imu_time_s[k], a.x(), a.y(), a.z(), w.x(), w.y(), w.z()});
  }
  for (std::size_t k = 0; k < d.dvl_time_s.size(); ++k) {
    const Vector3d& v = d.velocity_dvl[k];
    dvl.push_back({d.dvl_time_s[k], v.x(), v.y(), v.z()});
  }
  for (std::size_t k = 0; k < d.gt_time_s.size(); ++k) {
    const Vector3d &v = d.velocity_ned[k], &a = d.roll_pitch_yaw[k];
    gt.push_back({d.gt_time_s[k], d.longitude_rad[k], d.latitude_rad[k], d.altitude_m[k], v.x(), v.y(), v.z(),
                  a.x(), a.y(), a.z()});
  }
  writeTable(
      folder / "IMU_trajectory1.csv",
      "Time [s],ACC X [m/s^2],ACC Y [m/s^2],ACC Z [m/s^2],GYRO X [rad/s],GYRO Y [rad/s],GYRO Z [rad/s]", imu);
  writeTable(folder / "DVL_trajectory1.csv", "Time [s],DVL X [m/s],DVL Y [m/s],DVL Z [m/s]", dvl);
  writeTable(folder / "GT_trajectory1.csv",
             "Time [s],Longitude [rad],Latitude [rad],Altitude [m],V North [m/s],V East [m/s],V Down [m/s],"
             "Roll [rad],Pitch [rad],Yaw [rad]",
             gt);
  return seaTrialFiles(folder, 1);
}

}  // namespace fathom::test
