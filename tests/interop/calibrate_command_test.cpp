// A camera and its dome from a published data set, to a file that other programs read.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "effects/calibration.h"
#include "imaging/camera_files.h"
#include "support/run_program.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const nlohmann::json& kindNamed(const nlohmann::json& result, const std::string& id) {
  for (const auto& kind : result.at("kinds"))
    if (kind.at("kind") == id) return kind;
  throw std::runtime_error("no " + id);
}

TEST(CalibrateCommand, ADomeHoldsOnImagesThatWereLeftOut) {
  FATHOM_NEEDS_SHARED("data/dome");
  const fs::path out = test::scratchFolder() / "out", data = test::sharedData("data/dome");
  const auto done = test::runFathom(
      "calibrate camera --kind pinhole,dome-port --folds 2 --air " + (data / "air_corners.csv").string() +
      " --water " + (data / "water_corners.csv").string() +
      " --board 8x6 --square-m 0.03 --image-size 1440x1080 --out " + out.string());
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_NE(done.out.find("dome-port *"), std::string::npos) << done.out;
  const auto result = nlohmann::json::parse(readTextFile(out / "result.json"));
  // One lens and a dome see in air and in water what takes two lenses otherwise.
  const double dome = kindNamed(result, "dome-port").at("heldout_rms_px"),
               pinhole = kindNamed(result, "pinhole").at("heldout_rms_px");
  EXPECT_LT(dome, 1.05 * pinhole);
  EXPECT_LT(dome, 0.3);

  const CameraModel camera = readCameraFile(out / "camera.yaml").camera;
  EXPECT_EQ(camera.width_px, 1440);
  EXPECT_NEAR(camera.fx_px, 2420, 30);  // in air, as OpenCV has it of the views in air
  const auto port = readCalibration(out / "calibration.yaml");
  EXPECT_TRUE(port.has<DecentredDome>());
  EXPECT_LT(std::abs(port.of<DecentredDome>()[2]), 0.1);
}

TEST(CalibrateCommand, WrongInputIsOneLine) {
  const fs::path folder = test::scratchFolder();
  writeTextFile(folder / "two.csv", "image,corner,u_px,v_px\na,0,1,2\nb,0,1,2\n");
  const std::string rest = " --board 8x6 --square-m 0.03 --image-size 1440x1080 --out " + folder.string();
  const auto expectRefused = [](const test::ProgramResult& done, const std::string& why) {
    EXPECT_EQ(done.status, 2);
    EXPECT_NE(done.err.find(why), std::string::npos) << done.err;
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
  };
  expectRefused(test::runFathom("calibrate camera" + rest), "--recording: is needed, or --air or --water");
  expectRefused(test::runFathom("calibrate camera --air " + (folder / "two.csv").string() + rest),
                "three views");
  expectRefused(test::runFathom("calibrate camera --kind pin --air " + (folder / "two.csv").string() + rest),
                "no such kind");
  EXPECT_FALSE(fs::exists(folder / "result.json"));
}

}  // namespace
}  // namespace fathom
