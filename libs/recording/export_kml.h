#pragma once

#include <optional>
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
/// The inverse of MRPT's geodeticToENU_WGS84, to 1e-6 m. Latitudes are within 90 degrees, longitudes within
/// 180, beyond a pole too.
GeoPosition geoPositionOf(const Vector3d& position_odom, const GeoReference& reference);

/// Heights over the sea that are somebody's: from below the deepest trench to the edge of space.
inline constexpr double kLowestHeight_m = -12e3, kHighestHeight_m = 100e3;

/// Why a path is on no map: it is in no local metres, or at no height that is somebody's. Nothing where it
/// can be drawn.
std::optional<std::string> whyOnNoMap(const std::vector<StampedPose>& path, const GeoReference& reference);

/// A path as Google Earth and its kin draw it: KML 2.2 (OGC 07-147r2), a line (of one pose, a point) and, of
/// the same places with time and heading, a gx:Track, of poses at least `spacing_s` apart and the last one.
/// Heights are over the sea, below it negative.
std::string formatKml(const std::vector<StampedPose>& path, const GeoReference& reference, double spacing_s,
                      const std::string& name);

}  // namespace fathom
