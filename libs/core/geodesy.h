#pragma once

#include <cmath>

#include "core/geometry.h"

/// Places on the Earth (WGS84: semi-major axis 6378137 m, flattening 1/298.257223563; NIMA TR8350.2).
namespace fathom {

/// Geodetic latitude and longitude (degrees), height above the ellipsoid (m).
struct Geodetic {
  double latitude_deg = 0, longitude_deg = 0, height_m = 0;
};

namespace detail {
inline constexpr double kEarthRadius_m = 6378137.0, kFlattening = 1 / 298.257223563;
inline constexpr double kEccentricitySquared = kFlattening * (2 - kFlattening);

/// Axes of east, north and up there, in the Earth's own.
inline Matrix3d R_earth_enu(const Geodetic& at) {
  const double lat = radians(at.latitude_deg), lon = radians(at.longitude_deg);
  Matrix3d R;
  R << -std::sin(lon), -std::sin(lat) * std::cos(lon), std::cos(lat) * std::cos(lon),  //
      std::cos(lon), -std::sin(lat) * std::sin(lon), std::cos(lat) * std::sin(lon),    //
      0, std::cos(lat), std::sin(lat);
  return R;
}

/// In the Earth's axes, m (Farrell 2008, eq. 2.9 to 2.11).
inline Vector3d earthCentred(const Geodetic& at) {
  const double lat = radians(at.latitude_deg), lon = radians(at.longitude_deg), sine = std::sin(lat);
  const double across_m = kEarthRadius_m / std::sqrt(1 - kEccentricitySquared * sine * sine);
  return {(across_m + at.height_m) * std::cos(lat) * std::cos(lon),
          (across_m + at.height_m) * std::cos(lat) * std::sin(lon),
          (across_m * (1 - kEccentricitySquared) + at.height_m) * sine};
}
}  // namespace detail

/// Metres east, north and up of an origin, in its tangent plane.
inline Vector3d eastNorthUp(const Geodetic& at, const Geodetic& origin) {
  return detail::R_earth_enu(origin).transpose() * (detail::earthCentred(at) - detail::earthCentred(origin));
}

/// The inverse, by steps along the tangent planes, for what is within a few
/// hundred kilometres.
inline Geodetic geodetic(const Vector3d& east_north_up_m, const Geodetic& origin) {
  Geodetic at = origin;
  for (int i = 0; i < 8; ++i) {  // each leaves a hundredth or less
    const Vector3d left_m =
        detail::R_earth_enu(at).transpose() * (detail::R_earth_enu(origin) * east_north_up_m +
                                               detail::earthCentred(origin) - detail::earthCentred(at));
    const double cosine = std::cos(radians(at.latitude_deg));
    at.longitude_deg += degrees(left_m.x() / (detail::kEarthRadius_m * cosine));
    at.latitude_deg += degrees(left_m.y() / detail::kEarthRadius_m);
    at.height_m += left_m.z();
  }
  return at;
}

}  // namespace fathom
