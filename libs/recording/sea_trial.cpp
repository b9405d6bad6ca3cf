#include "recording/sea_trial.h"

#include <mrpt/topography/conversions.h>

#include <stdexcept>

#include "recording/sea_trial_axes.h"
#include "recording/sea_trial_clocks.h"
#include "recording/sea_trial_columns.h"
#include "recording/sea_trial_remarks.h"

namespace fathom {

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
  settleClocks(data, SampledSignal(data.imu_time_s, data.rate_imu).integral(), c);

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
