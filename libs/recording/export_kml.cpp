#include "recording/export_kml.h"

#include <mrpt/system/datetime.h>
#include <mrpt/topography/conversions.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/text.h"
#include "recording/mrpt_types.h"

namespace fathom {
namespace {

constexpr double kEquator_m = 6378137, kPole_m = 6356752.3142;  // WGS 84, as MRPT has it
constexpr double kEccentricity2 = 1 - kPole_m * kPole_m / (kEquator_m * kEquator_m);
constexpr double kFarthestLocal_m = 200e3;  // no vehicle goes so far on one dive

/// East, north, up of a vector in odom.
Vector3d eastNorthUp(const Vector3d& v_odom, double x_heading_rad) {
  return Eigen::AngleAxisd(std::numbers::pi / 2 - x_heading_rad, Vector3d::UnitZ()) * v_odom;
}

/// East, north and up at a place as columns, in the Earth's frame.
Matrix3d eastNorthUpAt(double latitude_rad, double longitude_rad) {
  const Eigen::AngleAxisd about_pole(longitude_rad + std::numbers::pi / 2, Vector3d::UnitZ()),
      about_east(std::numbers::pi / 2 - latitude_rad, Vector3d::UnitX());
  return (about_pole * about_east).toRotationMatrix();
}

/// Of a point in the Earth's frame. By Bowring's fixed point, whose every step leaves the ellipsoid's
/// flattening times the height over the radius of what is left.
GeoPosition geoPositionOf(const Vector3d& p_earth) {
  const double from_axis_m = std::hypot(p_earth.x(), p_earth.y());
  GeoPosition at{std::atan2(p_earth.z(), (1 - kEccentricity2) * from_axis_m),
                 std::atan2(p_earth.y(), p_earth.x()), 0};
  constexpr int kSteps = 6;
  for (int step = 0; step < kSteps; ++step) {
    const double s = std::sin(at.latitude_rad), flat = std::sqrt(1 - kEccentricity2 * s * s);
    at.height_m = from_axis_m * std::cos(at.latitude_rad) + p_earth.z() * s - kEquator_m * flat;
    at.latitude_rad = std::atan2(p_earth.z() + kEccentricity2 * kEquator_m / flat * s, from_axis_m);
  }
  return at;
}

/// Where the robot's x axis points, degrees from north by east, 0 to 360.
double heading_deg(const Pose& T_odom_robot, const GeoReference& reference) {
  const Vector3d ahead = eastNorthUp(T_odom_robot.rotation.col(0), reference.x_heading_rad);
  const double heading = degrees(std::atan2(ahead.x(), ahead.y()));
  return heading < 0 ? heading + 360 : heading;
}

std::vector<StampedPose> spaced(const std::vector<StampedPose>& path, double spacing_s) {
  std::vector<StampedPose> chosen;
  for (const StampedPose& pose : path)
    if (chosen.empty() || secondsBetween(chosen.back().time, pose.time) >= spacing_s) chosen.push_back(pose);
  if (!path.empty() && chosen.back().time != path.back().time) chosen.push_back(path.back());
  return chosen;
}

std::string xmlText(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    if (c == '&')
      safe += "&amp;";
    else if (c == '<')
      safe += "&lt;";
    else if (c == '>')
      safe += "&gt;";
    else
      safe += c;
  }
  return safe;
}

std::string placeOf(const StampedPose& pose, const GeoReference& reference, char between) {
  const GeoPosition at = geoPositionOf(pose.T_odom_robot.position, reference);
  return print("%.9f%c%.9f%c%.3f", std::remainder(degrees(at.longitude_rad), 360.0), between,
               degrees(at.latitude_rad), between, at.height_m);
}

/// 2023-11-14T22:13:20.000000Z
std::string isoTime(const Time& time) {
  mrpt::system::TTimeParts parts;
  mrpt::system::timestampToParts(toMrpt(time), parts);
  return print("%04d-%02d-%02dT%02d:%02d:%09.6fZ", parts.year, parts.month, parts.day, parts.hour,
               parts.minute, parts.second);
}

}  // namespace

GeoPosition geoPositionOf(const Vector3d& position_odom, const GeoReference& reference) {
  mrpt::math::TPoint3D origin_earth;
  mrpt::topography::geodeticToGeocentric_WGS84(
      {degrees(reference.latitude_rad), degrees(reference.longitude_rad), reference.height_m}, origin_earth);
  const Vector3d off_earth = eastNorthUpAt(reference.latitude_rad, reference.longitude_rad) *
                             eastNorthUp(position_odom, reference.x_heading_rad);
  return geoPositionOf(Vector3d(origin_earth.x, origin_earth.y, origin_earth.z) + off_earth);
}

std::optional<std::string> whyOnNoMap(const std::vector<StampedPose>& path, const GeoReference& reference) {
  for (const StampedPose& pose : path) {
    const Vector3d& position = pose.T_odom_robot.position;
    if (!(position.norm() <= kFarthestLocal_m))
      return print("has a pose %.4g km from odom's origin: not in local metres (UTM?)",
                   position.norm() / 1000);
    const double height_m = geoPositionOf(position, reference).height_m;
    if (!(height_m >= kLowestHeight_m && height_m <= kHighestHeight_m))
      return print("has a pose at %.0f m over the sea", height_m);
  }
  return {};
}

std::string formatKml(const std::vector<StampedPose>& path, const GeoReference& reference, double spacing_s,
                      const std::string& name) {
  const std::vector<StampedPose> poses = spaced(path, spacing_s);
  std::string line, times, places, angles;
  for (const StampedPose& pose : poses) {
    line += placeOf(pose, reference, ',') + "\n";
    times += "<when>" + isoTime(pose.time) + "</when>\n";
    places += "<gx:coord>" + placeOf(pose, reference, ' ') + "</gx:coord>\n";
    angles += print("<gx:angles>%.2f 0 0</gx:angles>\n", heading_deg(pose.T_odom_robot, reference));
  }
  const std::string shape = poses.size() < 2 ? "Point" : "LineString";  // a line has two places or more
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n"
         "<Document>\n<name>" +
         xmlText(printable(name)) +
         "</name>\n"
         "<Placemark>\n<name>path</name>\n"
         "<Style><LineStyle><color>ff0055d4</color><width>2</width></LineStyle></Style>\n"
         "<" +
         shape + ">\n<altitudeMode>absolute</altitudeMode>\n<coordinates>\n" + line + "</coordinates>\n</" +
         shape +
         ">\n</Placemark>\n"
         "<Placemark>\n<name>robot</name>\n"
         "<gx:Track>\n<altitudeMode>absolute</altitudeMode>\n" +
         times + places + angles + "</gx:Track>\n</Placemark>\n</Document>\n</kml>\n";
}

}  // namespace fathom
