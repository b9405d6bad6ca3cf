#pragma once

#include <string>
#include <vector>

#include "recording/tum.h"

namespace fathom {

/// Where odom is on the Earth: WGS 84, odom's z along the ellipsoid's normal there.
struct GeoReference {
  double latitude_rad = 0, longitude_rad = 0;
  double height_m = 0;       ///< of odom's origin, over the sea
  double x_heading_rad = 0;  ///< where odom's x axis points, from north by east
};

struct GeoPosition {
  double latitude_rad = 0, longitude_rad = 0, height_m = 0;
};
/// The inverse of MRPT's geodeticToENU_WGS84, to 1e-6 m. Not at a pole.
GeoPosition geoPositionOf(const Vector3d& position_odom, const GeoReference& reference);

/// Beyond, a path is in no local metres: no vehicle goes so far on one dive.
inline constexpr double kFarthestLocal_m = 200e3;
/// Of any pose, from odom's origin.
double farthest_m(const std::vector<StampedPose>& path);

/// A path as Google Earth and its kin draw it: KML 2.2 (OGC 07-147r2), a line and, of the same places with
/// time and heading, a gx:Track, of poses at least `spacing_s` apart and the last one. Heights are over the
/// sea, below it negative.
std::string formatKml(const std::vector<StampedPose>& path, const GeoReference& reference, double spacing_s,
                      const std::string& name);

}  // namespace fathom
