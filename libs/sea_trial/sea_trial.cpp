#include "sea_trial/sea_trial.h"

#include <mrpt/topography/conversions.h>

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

}  // namespace fathom
