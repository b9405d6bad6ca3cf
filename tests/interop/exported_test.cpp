// What is exported, read by the programs that it is for.
#include <gtest/gtest.h>

#include <cmath>

#include "core/files.h"
#include "recording/csv.h"
#include "recording/tum.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runFathom;
using test::runShell;
using test::shellQuoted;

std::string shippedFile(const std::string& name) { return shellQuoted((test::kSource / name).string()); }

bool isThere(const std::string& program) { return runShell("command -v " + program).status == 0; }

TEST(Exported, ColmapReadsTheModel) {
  if (!isThere("colmap")) GTEST_SKIP() << "needs colmap";
  const fs::path out = test::scratchFolder() / "colmap";
  const auto exported = runFathom("export colmap " + shippedFile("rawlogs/trial/trial.rawlog") + " --out " +
                                  shellQuoted(out.string()));
  ASSERT_EQ(exported.status, 0) << exported.err;
  const auto read = runShell("QT_QPA_PLATFORM=offscreen colmap model_analyzer --path " +
                             shellQuoted(out.string()) + " 2>&1");
  ASSERT_EQ(read.status, 0) << read.out;
  const std::string images = exported.out.substr(exported.out.find("wrote ") + 6);
  EXPECT_NE(read.out.find("Registered images: " + images.substr(0, images.find(' ')) + "\n"),
            std::string::npos)
      << read.out;
  EXPECT_NE(read.out.find("Points: 48\n"), std::string::npos)
      << "four corners of twelve markers: " << read.out;
}

TEST(Exported, GpsbabelReadsThePath) {
  if (!isThere("gpsbabel")) GTEST_SKIP() << "needs gpsbabel";
  const fs::path folder = test::scratchFolder();
  const std::string tum = shellQuoted((folder / "path.tum").string()),
                    kml = shellQuoted((folder / "path.kml").string()),
                    csv = shellQuoted((folder / "path.csv").string());
  ASSERT_EQ(runFathom("export tum " + shippedFile("rawlogs/dive/dive.rawlog") + " --label TRUTH --out " + tum)
                .status,
            0);
  ASSERT_EQ(
      runFathom("export kml " + tum + " --latitude 43.2 --longitude 5.1 --spacing 0 --out " + kml).status, 0);
  ASSERT_EQ(runShell("gpsbabel -t -i kml -f " + kml + " -o unicsv -F " + csv).status, 0);
  const TextTable points = readTable(folder / "path.csv");
  const std::vector<StampedPose> poses = readTum(folder / "path.tum");
  ASSERT_GT(points.rows.size(), 100U);
  double east_m = 0, north_m = 0;  // the farthest from where it begins
  constexpr double kEarth_m = 6.37e6;
  for (std::size_t k = 0; k < points.rows.size(); ++k) {
    north_m = std::max(north_m, std::abs(radians(points.number(k, 1) - 43.2)) * kEarth_m);
    east_m =
        std::max(east_m, std::abs(radians(points.number(k, 2) - 5.1)) * kEarth_m * std::cos(radians(43.2)));
  }
  double x_m = 0, y_m = 0;
  for (const StampedPose& pose : poses) {
    x_m = std::max(x_m, std::abs(pose.T_odom_robot.position.x()));
    y_m = std::max(y_m, std::abs(pose.T_odom_robot.position.y()));
  }
  // gpsbabel writes 1e-6 degrees, 0.1 m; the Earth is no sphere to half a per cent.
  EXPECT_NEAR(east_m, x_m, 0.15 + 0.005 * x_m);
  EXPECT_NEAR(north_m, y_m, 0.15 + 0.005 * y_m);
}

}  // namespace
}  // namespace fathom
