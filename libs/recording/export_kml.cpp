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

constexpr double kEarthRadius_m = 6371e3;
constexpr int kSteps = 6;

/// East, north, up of a vector in odom.
Vector3d eastNorthUp(const Vector3d& v_odom, double x_heading_rad) {
  return Eigen::AngleAxisd(std::numbers::pi / 2 - x_heading_rad, Vector3d::UnitZ()) * v_odom;
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
  const Vector3d p = eastNorthUp(position_odom, reference.x_heading_rad);
  const mrpt::topography::TGeodeticCoords origin(degrees(reference.latitude_rad),
                                                 degrees(reference.longitude_rad), reference.height_m);
  GeoPosition at{reference.latitude_rad, reference.longitude_rad, reference.height_m};
  // MRPT's geocentricToGeodetic is 0.2 m off at 28 m; its way back is exact. On a sphere each step leaves
  // three thousandths, the ellipsoid's flattening, of what is left.
  for (int step = 0; step < kSteps; ++step) {
    mrpt::math::TPoint3D reached;
    mrpt::topography::geodeticToENU_WGS84({degrees(at.latitude_rad), degrees(at.longitude_rad), at.height_m},
                                          reached, origin);
    at.latitude_rad += (p.y() - reached.y) / kEarthRadius_m;
    at.longitude_rad += (p.x() - reached.x) / (kEarthRadius_m * std::cos(at.latitude_rad));
    at.height_m += p.z() - reached.z;
  }
  return at;
}

double farthest_m(const std::vector<StampedPose>& path) {
  double farthest = 0;
  for (const StampedPose& pose : path) farthest = std::max(farthest, pose.T_odom_robot.position.norm());
  return farthest;
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
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
         "<kml xmlns=\"http://www.opengis.net/kml/2.2\" xmlns:gx=\"http://www.google.com/kml/ext/2.2\">\n"
         "<Document>\n<name>" +
         xmlText(name) +
         "</name>\n"
         "<Placemark>\n<name>path</name>\n"
         "<Style><LineStyle><color>ff0055d4</color><width>2</width></LineStyle></Style>\n"
         "<LineString>\n<altitudeMode>absolute</altitudeMode>\n<coordinates>\n" +
         line +
         "</coordinates>\n</LineString>\n</Placemark>\n"
         "<Placemark>\n<name>robot</name>\n"
         "<gx:Track>\n<altitudeMode>absolute</altitudeMode>\n" +
         times + places + angles + "</gx:Track>\n</Placemark>\n</Document>\n</kml>\n";
}

}  // namespace fathom
