// Bare corners, as calibration data sets publish them, from the table to the verdict.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/camera_model.h"
#include "core/files.h"
#include "core/random.h"
#include "core/text.h"
#include "effects/calibration.h"
#include "support/run_program.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

constexpr double kCornerSigma_px = 0.1;

/// A board of 8 x 6 corners of 30 mm, looked at from all sides.
std::string boardTable(int views) {
  const CameraModel camera{1440, 1080, 1200, 1200, 719.5, 539.5, 0, 0, 0, 0, 0};
  Random random(4);
  std::string text = "image,corner,u_px,v_px\n";
  for (int view = 0; view < views; ++view) {
    const Pose T_camera_board{
        rotationFromYawPitchRoll(random.uniform(-0.5, 0.5), random.uniform(-0.6, 0.6),
                                 random.uniform(-0.6, 0.6)),
        {random.uniform(-0.15, -0.05), random.uniform(-0.12, -0.03), random.uniform(0.5, 0.9)}};
    for (int k = 0; k < 48; ++k) {
      const int column = k % 8, row = k / 8;
      const Vector2d pixel = camera.project<double>(T_camera_board * Vector3d(0.03 * column, 0.03 * row, 0));
      text += print("%02d.png,%d,%.6f,%.6f\n", view, k, pixel.x() + kCornerSigma_px * random.normal(),
                    pixel.y() + kCornerSigma_px * random.normal());
    }
  }
  return text;
}

class ImportCorners : public testing::Test {
 protected:
  ImportCorners() { writeTextFile(folder_ / "views.csv", boardTable(24)); }

  /// Imported with this focal length and diagnosed.
  nlohmann::json verdictWith(double focal_px) {
    writeTextFile(folder_ / "camera.yaml",
                  print("fx_px: %g\nfy_px: %g\ncx_px: 719.5\ncy_px: 539.5\n", focal_px, focal_px));
    const std::string out = (folder_ / "out").string();
    const auto imported = test::runFathom("import corners " + (folder_ / "views.csv").string() +
                                          " --board 8x6 --square-m 0.03 --camera " +
                                          (folder_ / "camera.yaml").string() + " --out " + out);
    EXPECT_EQ(imported.status, 0) << imported.err;
    const auto diagnosed = test::runFathom("diagnose " + out + "/views.rawlog --out " + out + "/diagnosis");
    EXPECT_EQ(diagnosed.status, 0) << diagnosed.err;
    EXPECT_NE(diagnosed.out.find("images are not searched"), std::string::npos) << diagnosed.out;
    return nlohmann::json::parse(readTextFile(folder_ / "out/diagnosis/result.json")).at("diagnosis");
  }

  fs::path folder_ = test::scratchFolder();
};

TEST_F(ImportCorners, NothingIsMissingWhereTheCameraIsRight) {
  EXPECT_EQ(verdictWith(1200).at("verdict"), "none");
}

TEST_F(ImportCorners, AWrongFocalLengthIsFound) {
  const auto result = verdictWith(1212);
  EXPECT_EQ(result.at("verdict"), "explained");
  ASSERT_EQ(result.at("effects").size(), 1U);
  const auto& effect = result.at("effects")[0];
  EXPECT_EQ(effect.at("id"), "focal-scale");
  const double found = effect.at("parameters").at("scale_error"),
               sigma = effect.at("sigma").at("scale_error");
  EXPECT_NEAR(found, 1200.0 / 1212 - 1, 4 * sigma);
  EXPECT_LT(sigma, 0.002);
}

/// Three boards behind a tank of water, 0.25 m from wall to wall, seen from air in one image. The light is
/// followed through by Snell's law: the angle at which it meets a point, by halving.
std::string tankTable(const CameraModel& camera) {
  constexpr double kWater_m = 0.25, kIndex = 1.34;
  const Vector3d normal = expSO3<double>(Vector3d(radians(4), radians(-6), 0)) * Vector3d::UnitZ();
  const auto seen = [&](const Vector3d& point_camera) {
    const double height = normal.dot(point_camera);
    const Vector3d lateral = point_camera - height * normal;
    double low = 0, high = radians(89);
    for (int halving = 0; halving < 60; ++halving) {
      const double angle = 0.5 * (low + high);
      const double reached =
          (height - kWater_m) * std::tan(angle) + kWater_m * std::tan(std::asin(std::sin(angle) / kIndex));
      (reached < lateral.norm() ? low : high) = angle;
    }
    return Vector3d(normal + std::tan(low) * lateral.normalized());
  };
  const Pose T_camera_boards{rotationFromYawPitchRoll(0.1, 0.2, 0.3), {-0.12, -0.15, 0.7}};
  const double slanted = 0.03 * std::sqrt(0.5);
  const auto boards = {
      std::array{Vector3d(0, 0, 0), Vector3d(0.03, 0, 0), Vector3d(0, 0.03, 0)},
      std::array{Vector3d(0, 0.21, 0), Vector3d(0.03, 0, 0), Vector3d(0, slanted, slanted)},
      std::array{Vector3d(0.27, 0, 0), Vector3d(slanted, 0, -slanted), Vector3d(0, 0.03, 0)}};
  Random random(6);
  std::string text = "x_mm,y_mm,z_mm,u_px,v_px\n";
  for (const auto& [origin, right, down] : boards)
    for (int row = 0; row < 6; ++row)
      for (int column = 0; column < 8; ++column) {
        const Vector3d corner = origin + column * right + row * down;
        const Vector2d pixel = camera.project<double>(seen(T_camera_boards * corner));
        text += print("%.6f,%.6f,%.6f,%.6f,%.6f\n", 1000 * corner.x(), 1000 * corner.y(), 1000 * corner.z(),
                      pixel.x() + kCornerSigma_px * random.normal(),
                      pixel.y() + kCornerSigma_px * random.normal());
      }
  return text;
}

nlohmann::json verdictOf(const fs::path& table, const fs::path& camera, const fs::path& folder) {
  const auto imported = test::runFathom("import corners " + table.string() + " --camera " + camera.string() +
                                        " --name tank --out " + folder.string());
  EXPECT_EQ(imported.status, 0) << imported.err;
  const auto diagnosed = test::runFathom("diagnose " + (folder / "tank.rawlog").string() + " --out " +
                                         (folder / "diagnosis").string());
  EXPECT_EQ(diagnosed.status, 0) << diagnosed.err;
  return nlohmann::json::parse(readTextFile(folder / "diagnosis/result.json")).at("diagnosis");
}

/// Tens of pixels off, so that the first order says little, and nothing but markers to hold out.
TEST_F(ImportCorners, TheWaterOfATankThatACameraLooksThroughIsFound) {
  writeTextFile(folder_ / "tank.csv", tankTable({1440, 1080, 1200, 1200, 719.5, 539.5, 0, 0, 0, 0, 0}));
  writeTextFile(folder_ / "camera.yaml", "fx_px: 1200\nfy_px: 1200\ncx_px: 719.5\ncy_px: 539.5\n");
  const auto result = verdictOf(folder_ / "tank.csv", folder_ / "camera.yaml", folder_ / "out");
  EXPECT_EQ(result.at("verdict"), "explained") << result.at("why");
  ASSERT_EQ(result.at("effects").size(), 1U);
  const auto& effect = result.at("effects")[0];
  EXPECT_EQ(effect.at("id"), "flat-port-refraction");
  const double slab_m = effect.at("parameters").at("slab_m"), sigma_m = effect.at("sigma").at("slab_m");
  // Each corner is a marker of its own, so that print as the budget has it makes up for all that is left: the
  // last step, a linear one, then leads too far (from 0.251 m to 0.297 m).
  EXPECT_NEAR(slab_m, 0.25, 4 * sigma_m);
  EXPECT_LT(sigma_m, 0.02);
  const auto& held_out = result.at("heldout");
  EXPECT_LT(held_out.at("after"), 1.5 * kCornerSigma_px);
  EXPECT_GT(held_out.at("before"), 10 * kCornerSigma_px);
  EXPECT_GT(held_out.at("black_box"), held_out.at("after"));

  // The smoother starts from other places too, where a camera stands by itself: from no water at all it ends
  // in another minimum.
  const auto smoothed =
      test::runFathom("smooth " + (folder_ / "out/tank.rawlog").string() +
                      " --estimate flat-port-refraction --out " + (folder_ / "smoothed").string());
  ASSERT_EQ(smoothed.status, 0) << smoothed.err;
  EXPECT_EQ(smoothed.out.find("noise is left"), std::string::npos) << smoothed.out;
  const EffectParameters<double> smooth = readCalibration(folder_ / "smoothed/calibration.yaml");
  const double* port = smooth.of<FlatPortRefraction>();
  EXPECT_GE(port[0], 0);
  EXPECT_GE(port[1], 0);
  EXPECT_NEAR(port[5] + port[1], 0.25, 0.02);
}

/// A board of 8 x 6 corners that lies level at the bottom of a pool, face up, under 0.25 m of water, seen
/// from the air. The light is followed by Snell's law: the angle at which it meets a corner, by halving.
std::string poolTable(const CameraModel& camera) {
  constexpr double kWater_m = 0.25, kIndex = 1.34;
  Random random(8);
  std::string text = "image,corner,u_px,v_px\n";
  for (int view = 0; view < 24; ++view) {
    const double off_rad = random.uniform(0, 0.8), azimuth_rad = random.uniform(-3, 3),
                 roll_rad = random.uniform(-3, 3), range_m = random.uniform(0.55, 0.9);
    const Vector3d aim(0.105, -0.075, 0);
    const Vector3d eye =
        aim + range_m * Vector3d(std::sin(off_rad) * std::cos(azimuth_rad),
                                 std::sin(off_rad) * std::sin(azimuth_rad), std::cos(off_rad));
    const Vector3d forward = (aim - eye).normalized(), level(std::cos(roll_rad), std::sin(roll_rad), 0);
    const Vector3d right = (level - level.dot(forward) * forward).normalized();
    Matrix3d R_board_camera;
    R_board_camera << right, forward.cross(right), forward;
    for (int k = 0; k < 48; ++k) {
      const Vector3d corner(0.03 * (k % 8), -0.03 * (k / 8), 0);
      const Vector3d lateral = (corner - eye).cwiseProduct(Vector3d(1, 1, 0));
      double low = 0, high = radians(89);
      for (int halving = 0; halving < 60; ++halving) {
        const double angle = 0.5 * (low + high);
        const double reached =
            (eye.z() - kWater_m) * std::tan(angle) + kWater_m * std::tan(std::asin(std::sin(angle) / kIndex));
        (reached < lateral.norm() ? low : high) = angle;
      }
      const Vector3d seen = std::tan(low) * lateral.normalized() - Vector3d::UnitZ();
      const Vector2d pixel = camera.project<double>(R_board_camera.transpose() * seen);
      text += print("%02d.png,%d,%.6f,%.6f\n", view, k, pixel.x() + kCornerSigma_px * random.normal(),
                    pixel.y() + kCornerSigma_px * random.normal());
    }
  }
  return text;
}

/// By a fit of its own, of a pinhole and two layers, the water is known to 1.2 mm; without it 0.33 px are
/// left, with a focal length and a distortion in its place 0.28.
TEST_F(ImportCorners, TheWaterOfAPoolUnderACameraIsFound) {
  writeTextFile(folder_ / "pool.csv", poolTable({1440, 1080, 1200, 1200, 719.5, 539.5, 0, 0, 0, 0, 0}));
  writeTextFile(folder_ / "camera.yaml",
                "fx_px: 1200\nfy_px: 1200\ncx_px: 719.5\ncy_px: 539.5\nabove_water: true\n");
  const std::string out = (folder_ / "out").string();
  const auto imported = test::runFathom("import corners " + (folder_ / "pool.csv").string() +
                                        " --board 8x6 --square-m 0.03 --camera " +
                                        (folder_ / "camera.yaml").string() + " --out " + out);
  ASSERT_EQ(imported.status, 0) << imported.err;
  const auto diagnosed = test::runFathom("diagnose " + out + "/pool.rawlog --out " + out + "/diagnosis");
  ASSERT_EQ(diagnosed.status, 0) << diagnosed.err;
  const auto result =
      nlohmann::json::parse(readTextFile(folder_ / "out/diagnosis/result.json")).at("diagnosis");
  ASSERT_EQ(result.at("effects").size(), 1U) << result.at("why");
  const auto& effect = result.at("effects")[0];
  EXPECT_EQ(effect.at("id"), "flat-water-surface") << result.at("why");
  const double water_m = effect.at("parameters").at("water_m"), sigma_m = effect.at("sigma").at("water_m");
  EXPECT_NEAR(water_m, 0.25, 3 * sigma_m);
  EXPECT_LT(sigma_m, 0.01);
  const double camera_m = effect.at("parameters").at("distance_m");  // over the surface
  EXPECT_GT(camera_m, 0.55 * std::cos(0.8) - 0.25);
  EXPECT_LT(camera_m, 0.9 - 0.25);
}

TEST_F(ImportCorners, TheRealTankIsKnownByItsWater) {
  FATHOM_NEEDS_SHARED("data/tank");
  const fs::path data = test::sharedData("data/tank");
  const auto result = verdictOf(data / "corners.csv", data / "camera.yaml", folder_ / "real");
  const auto& found = result.at("effects");
  ASSERT_GE(found.size(), 1U);
  EXPECT_EQ(found[0].at("id"), "flat-port-refraction");
  const double slab_m = found[0].at("parameters").at("slab_m");
  EXPECT_NEAR(slab_m, 0.25, 0.03);
  const double before_px = result.at("heldout").at("before"), after_px = result.at("heldout").at("after");
  EXPECT_LT(after_px, 0.1 * before_px);
  // A camera calibrated anew leaves pixels; what is left here is what the budget allows boards to be folded
  // by.
  EXPECT_LT(after_px, 0.25 * result.at("heldout").at("black_box").get<double>());
}

TEST_F(ImportCorners, WrongInputIsOneLine) {
  const std::string table = (folder_ / "views.csv").string();
  const auto complaint = [&](const std::string& arguments) {
    const auto done =
        test::runFathom("import corners " + arguments + " --out " + (folder_ / "wrong").string());
    EXPECT_EQ(done.status, 2) << arguments;
    return done.err;
  };
  writeTextFile(folder_ / "camera.yaml", "fx_px: 1200\nfy_px: 1200\ncx_px: 719.5\ncy_px: 539.5\n");
  const std::string camera = " --camera " + (folder_ / "camera.yaml").string();
  EXPECT_NE(complaint(table).find("--calibrate is needed"), std::string::npos);
  EXPECT_NE(complaint(table + camera).find("--board"), std::string::npos);
  EXPECT_NE(complaint(table + camera + " --board 8").find("WIDTHxHEIGHT"), std::string::npos);
  EXPECT_NE(complaint(table + camera + " --board 8x6").find("--square-m"), std::string::npos);
  EXPECT_NE(complaint(table + " --board 8x6 --square-m 0.03 --calibrate " + table).find("--image-size"),
            std::string::npos);
  // What claims to be huge takes no memory.
  const std::string board = " --board 8x6 --square-m 0.03";
  EXPECT_NE(complaint(table + board + camera + " --image-size 4000000x4000000").find("--image-size"),
            std::string::npos);
  EXPECT_NE(complaint(table + camera + " --board 60000x60000 --square-m 0.03").find("of which there are"),
            std::string::npos);
  writeTextFile(folder_ / "far.yaml", "fx_px: 1200\nfy_px: 1200\ncx_px: 1e12\ncy_px: 539.5\n");
  EXPECT_NE(complaint(table + board + " --camera " + (folder_ / "far.yaml").string()).find("cx_px"),
            std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "wrong/views.rawlog"));
}

}  // namespace
}  // namespace fathom
