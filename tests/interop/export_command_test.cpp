// `fathom export`, read back by rules that are not the program's.
#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <map>
#include <sstream>

#include "core/files.h"
#include "support/run_program.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runFathom;
using test::scratchFolder;
using test::shellQuoted;

const std::string kRoot = FATHOM_SOURCE_DIR;
const std::string kPath = kRoot + "/rawlogs/dive/dive.rawlog";
const std::string kImages = kRoot + "/rawlogs/trial/trial.rawlog";

fs::path exported(const std::string& what, const fs::path& out) {
  const auto result = runFathom("export " + what + " --out " + shellQuoted(out.string()));
  EXPECT_EQ(result.status, 0) << result.err;
  return out;
}

std::vector<std::string> linesOf(const fs::path& file) {
  std::istringstream text(readTextFile(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);)
    if (line.empty() || line[0] != '#') lines.push_back(line);
  return lines;
}

TEST(ExportCommand, TablesOfEachSensor) {
  const fs::path out = exported("csv " + kPath, scratchFolder() / "tables");
  for (const char* label : {"INS", "DVL", "DEPTH", "TRUTH"})
    EXPECT_GT(linesOf(out / (std::string(label) + ".csv")).size(), 100U) << label;
}

TEST(ExportCommand, APathAndThenTheSamePathOnTheMap) {
  const fs::path folder = scratchFolder();
  const fs::path tum = exported("tum " + kPath + " --label TRUTH", folder / "truth.tum");
  const std::string where = " --latitude 43.2 --longitude 5.1 --height -2";
  const std::string of_tum =
      readTextFile(exported("kml " + shellQuoted(tum.string()) + where, folder / "a/dive.kml"));
  const std::string of_rawlog =
      readTextFile(exported("kml " + kPath + " --label TRUTH" + where, folder / "b/dive.kml"));
  EXPECT_EQ(of_tum.substr(of_tum.find("<Placemark>")), of_rawlog.substr(of_rawlog.find("<Placemark>")));
  const auto parsed = test::runShell("python3 -c 'import sys, xml.dom.minidom as d; d.parse(sys.argv[1])' " +
                                     shellQuoted((folder / "a/dive.kml").string()));
  EXPECT_EQ(parsed.status, 0) << parsed.err;
}

TEST(ExportCommand, ColmapsCamerasSeeThePointsWhereTheImagesDo) {
  const fs::path out = exported("colmap " + kImages, scratchFolder() / "colmap");
  std::istringstream camera(linesOf(out / "cameras.txt").at(0));
  std::string id, model;
  double w = 0, h = 0, fx = 0, fy = 0, cx = 0, cy = 0, k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;
  camera >> id >> model >> w >> h >> fx >> fy >> cx >> cy >> k1 >> k2 >> p1 >> p2 >> k3;
  ASSERT_EQ(model, "FULL_OPENCV");
  std::map<std::size_t, Eigen::Vector3d> points;
  for (const std::string& line : linesOf(out / "points3D.txt")) {
    std::istringstream text(line);
    std::size_t point = 0;
    Eigen::Vector3d p;
    text >> point >> p.x() >> p.y() >> p.z();
    points[point] = p;
  }
  const std::vector<std::string> lines = linesOf(out / "images.txt");
  ASSERT_GT(lines.size(), 1000U);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  double squares = 0, count = 0;
  for (std::size_t i = 0; i + 1 < lines.size(); i += 2) {
    std::istringstream pose(lines[i]), seen(lines[i + 1]);
    double qw = 0, qx = 0, qy = 0, qz = 0;
    Eigen::Vector3d t;
    std::string number, camera_number, name;
    pose >> number >> qw >> qx >> qy >> qz >> t.x() >> t.y() >> t.z() >> camera_number >> name;
    ASSERT_TRUE(fs::exists(fs::path(kImages).parent_path() / "trial_Images" / name)) << name;
    double x_px = 0, y_px = 0;
    for (std::size_t point = 0; seen >> x_px >> y_px >> point; ++count) {
      const Eigen::Vector3d p = Eigen::Quaterniond(qw, qx, qy, qz) * points.at(point) + t;
      const double x = p.x() / p.z(), y = p.y() / p.z(), r2 = x * x + y * y;
      const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
      const Eigen::Vector2d off(fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + cx - x_px,
                                fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + cy - y_px);
      sum += off;
      squares += off.squaredNorm();
    }
  }
  // The poses are those that fit the corners best. A pixel's corner for its centre would be 0.5 px off on
  // average; corners in small JPEG images are sure to a pixel's rounding.
  EXPECT_LT((sum / count).norm(), 0.05);
  EXPECT_LT(std::sqrt(squares / count), 1);
}

TEST(ExportCommand, RefusesInOneLine) {
  const std::string out = " --out " + shellQuoted((scratchFolder() / "out").string());
  test::expectBadInput(runFathom("export tum " + kPath + " --label NOWHERE" + out), "NOWHERE");
  test::expectBadInput(runFathom("export csv /no/such.rawlog" + out), "/no/such.rawlog");
  test::expectBadInput(runFathom("export kml " + kPath + " --latitude 100 --longitude 0" + out), "latitude");
  test::expectBadInput(runFathom("export colmap " + kPath + out), "");
  const std::string place = " --latitude 43 --longitude 5 --height ";
  test::expectBadInput(runFathom("export kml " + kPath + " --label TRUTH" + place + "1e9" + out), "--height");
  test::expectBadInput(runFathom("export kml " + kPath + " --label TRUTH" + place + "-11999" + out),
                       "over the sea");
}

TEST(ExportCommand, WhatHasNoTableIsSaid) {
  const fs::path folder = scratchFolder();
  const std::string out = " --out " + shellQuoted((folder / "out").string());
  const auto written = [&](const char* name, std::vector<std::string> labels) {
    mrpt::io::CMemoryStream stream;
    auto archive = mrpt::serialization::archiveFrom(stream);
    for (const std::string& label : labels) {
      mrpt::obs::CObservationIMU imu;
      imu.sensorLabel = label;
      imu.timestamp = mrpt::Clock::now();
      archive << imu;
    }
    writeTextFile(folder / name,
                  {static_cast<const char*>(stream.getRawBufferData()), stream.getTotalBytesCount()});
    return shellQuoted((folder / name).string());
  };
  test::expectBadInput(
      runFathom("export csv " + written("none.rawlog", {"XSENS", "XSENS"}) + out),
      "holds nothing that becomes a table, only 2 entries (XSENS, mrpt::obs::CObservationIMU)");
  const auto some = runFathom("export csv " + written("some.rawlog", {"INS", "XSENS"}) + out);
  EXPECT_EQ(some.status, 0) << some.err;
  EXPECT_NE(some.out.find("no table of 1 entry (XSENS, "), std::string::npos) << some.out;
}

}  // namespace
}  // namespace fathom
