#include "recording/export_kml.h"

#include <gtest/gtest.h>
#include <mrpt/topography/conversions.h>

#include <numbers>

#include "core/random.h"

namespace fathom {
namespace {

const GeoReference kMarseille{radians(43.2), radians(5.1), -3, radians(90)};

// Against the ellipsoid's radii of curvature, in the meridian and across (Torge & Müller, Geodesy, 2012, ch.
// 4); over 100 m the sphere of these radii is off by less than 2 mm.
TEST(ExportKml, MetresAreWhatTheEllipsoidSays) {
  const double a = 6378137, e2 = 6.69437999014e-3;
  const double s = std::sin(kMarseille.latitude_rad), w2 = 1 - e2 * s * s;
  const double across_m = a / std::sqrt(w2), along_m = a * (1 - e2) / std::pow(w2, 1.5);
  const GeoPosition at = geoPositionOf({80, 60, -25}, kMarseille);  // x is east
  EXPECT_NEAR((at.latitude_rad - kMarseille.latitude_rad) * (along_m - 28), 60, 0.002);
  EXPECT_NEAR((at.longitude_rad - kMarseille.longitude_rad) * (across_m - 28) * std::cos(at.latitude_rad), 80,
              0.002);
  EXPECT_NEAR(at.height_m, -28, 0.002);
}

TEST(ExportKml, PlacesAreTheInverseOfMrpts) {
  Random random(5);
  for (int i = 0; i < 200; ++i) {
    const double latitude_deg = i == 0 ? 90 : random.uniform(-90, 90),
                 longitude_deg = random.uniform(-180, 180);
    const GeoReference reference{radians(latitude_deg), radians(longitude_deg), random.uniform(-1e4, 1e4),
                                 radians(90)};
    const Vector3d position = 5e4 * random.normal3();
    const GeoPosition at = geoPositionOf(position, reference);
    mrpt::math::TPoint3D back;
    mrpt::topography::geodeticToENU_WGS84({degrees(at.latitude_rad), degrees(at.longitude_rad), at.height_m},
                                          back, {latitude_deg, longitude_deg, reference.height_m});
    EXPECT_LT((Vector3d(back.x, back.y, back.z) - position).norm(), 1e-6) << latitude_deg;
  }
}

TEST(ExportKml, BeyondAPoleIsTheOtherSide) {
  const GeoPosition at = geoPositionOf({0, 3000, 0}, {radians(89.98), radians(10), 0, radians(90)});
  EXPECT_NEAR(degrees(at.latitude_rad), 90 - (3000 - 0.02 * 111694) / 111694, 1e-5);
  EXPECT_NEAR(std::remainder(degrees(at.longitude_rad) - 190, 360), 0, 1e-6);
}

TEST(ExportKml, TheAxisPointsWhereItIsSaidTo) {
  for (const double heading : {0.0, 90.0, 200.0, 315.0}) {
    GeoReference reference = kMarseille;
    reference.x_heading_rad = radians(heading);
    const GeoPosition at = geoPositionOf({10, 0, 0}, reference);
    const double north = at.latitude_rad - reference.latitude_rad;
    const double east = (at.longitude_rad - reference.longitude_rad) * std::cos(reference.latitude_rad);
    const double found = std::atan2(east, north);
    // The earth's flattening turns a direction by up to 0.2 degrees.
    EXPECT_NEAR(std::remainder(found - reference.x_heading_rad, 2 * std::numbers::pi), 0, radians(0.25));
  }
}

TEST(ExportKml, PosesAreSpacedAndTheLastIsThere) {
  std::vector<StampedPose> path;
  for (int i = 0; i <= 25; ++i)
    path.push_back({fromUnixSeconds(1.7e9 + 0.1 * i), Pose{Matrix3d::Identity(), Vector3d(0.1 * i, 0, -2)}});
  const std::string kml = formatKml(path, kMarseille, 1, "a <dive> & more");
  std::size_t times = 0;
  for (std::size_t at = kml.find("<when>"); at != std::string::npos; at = kml.find("<when>", at + 1)) ++times;
  EXPECT_EQ(times, 4U);  // 0, 1, 2 and 2.5 s
  EXPECT_NE(kml.find("<when>2023-11-14T22:13:22.500000Z</when>"), std::string::npos);
  EXPECT_NE(kml.find("<gx:angles>90.00 0 0</gx:angles>"), std::string::npos);
  EXPECT_NE(kml.find("a &lt;dive&gt; &amp; more"), std::string::npos);
}

TEST(ExportKml, LongitudesStayOnTheMap) {
  const GeoReference fiji{radians(-17), radians(179.9999), 0, radians(90)};
  const std::string kml =
      formatKml({{fromUnixSeconds(1.7e9), Pose{Matrix3d::Identity(), {100, 0, -2}}}}, fiji, 1, "x");
  EXPECT_NE(kml.find("-179.99"), std::string::npos) << kml;
  EXPECT_EQ(kml.find("180.00"), std::string::npos) << kml;
}

StampedPose poseAtPlace(const Vector3d& position_odom) {
  return {fromUnixSeconds(1.7e9), Pose{Matrix3d::Identity(), position_odom}};
}

TEST(ExportKml, APathMustBeSomewhere) {
  EXPECT_FALSE(whyOnNoMap({poseAtPlace({80, 60, -25})}, kMarseille).has_value());
  EXPECT_NE(whyOnNoMap({poseAtPlace({458075, 5429380, 0})}, kMarseille).value().find("UTM"),
            std::string::npos);
  EXPECT_NE(whyOnNoMap({poseAtPlace({0, 0, -13e3})}, kMarseille).value().find("over the sea"),
            std::string::npos);
}

// A line has two places at least (OGC 07-147r2, 10.7).
TEST(ExportKml, OnePoseIsAPoint) {
  const std::string kml = formatKml({poseAtPlace({1, 2, -3})}, kMarseille, 1, "x");
  EXPECT_EQ(kml.find("LineString"), std::string::npos);
  EXPECT_NE(kml.find("<Point>"), std::string::npos);
  EXPECT_NE(kml.find("</Point>"), std::string::npos);
}

}  // namespace
}  // namespace fathom
