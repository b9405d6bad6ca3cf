// Points that two cameras see through the walls of an aquarium, from the table to the verdict.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/camera_model.h"
#include "core/files.h"
#include "core/geometry.h"
#include "core/random.h"
#include "core/text.h"
#include "support/run_program.h"
#include "support/sanitized.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

constexpr double kPoint_px = 1, kCorner_px = 0.3;

/// A camera in air before a wall of an aquarium: the plane z = 0 of the wall's own frame, x right and y down
/// as the camera sees it, water at z > 0.
struct Observer {
  Pose T_world_wall, T_wall_camera;
  CameraModel camera{1600, 1200, 1000, 1000, 799.5, 599.5, 0, 0, 0, 0, 0};

  /// Snell's law: where on the wall the light comes through, by halving the way along it.
  Vector2d seen(const Vector3d& point_world, double index) const {
    const Vector3d point = T_world_wall.inverse() * point_world, eye = T_wall_camera.position;
    const Eigen::Vector2d from = eye.head<2>(), to = point.head<2>();
    double low = 0, high = 1;
    for (int halving = 0; halving < 60; ++halving) {
      const double share = 0.5 * (low + high), way = (to - from).norm();
      const double in_air = share * way / std::hypot(share * way, eye.z()),
                   in_water = (1 - share) * way / std::hypot((1 - share) * way, point.z());
      (in_air < index * in_water ? low : high) = share;
    }
    const Vector2d on_wall = from + low * (to - from);
    return camera.project<double>(T_wall_camera.inverse() * Vector3d(on_wall.x(), on_wall.y(), 0));
  }
};

/// One looks in from the front, one down from above.
std::array<Observer, 2> observers() {
  const Matrix3d down = rotationFromYawPitchRoll(0, 0, radians(90));  // z of the wall: y of the world
  return {Observer{{Matrix3d::Identity(), {-0.2, -0.1, 0}},
                   {rotationFromYawPitchRoll(radians(1), radians(4), radians(-3)), {0.2, 0.1, -0.2}}},
          Observer{{down.transpose(), {-0.2, -0.1, 0.0}},
                   {rotationFromYawPitchRoll(radians(-2), radians(3), radians(4)), {0.22, -0.1, -0.17}}}};
}

class ImportTiePoints : public testing::Test {
 protected:
  /// Fish in water of this index; one in thirty pairs is of two different ones.
  void writeData(double index) {
    const std::array<Observer, 2> eyes = observers();
    Random random(3);
    std::string table = "camera,frame,id,u_px,v_px\n";
    const auto fish = [&] {
      return Vector3d(random.uniform(-0.15, 0.15), random.uniform(-0.06, 0.08), random.uniform(0.03, 0.18));
    };
    for (int frame = 1; frame <= 300; ++frame) {
      const Vector3d point = fish(), other = fish();
      for (int eye = 0; eye < 2; ++eye) {
        const Observer& observer = eyes[static_cast<std::size_t>(eye)];
        const Vector2d pixel = observer.seen(eye == 1 && frame % 30 == 0 ? other : point, index);
        table += print("%d,%d,0,%.3f,%.3f\n", eye + 1, frame, pixel.x() + kPoint_px * random.normal(),
                       pixel.y() + kPoint_px * random.normal());
      }
    }
    writeTextFile(folder_ / "detections.csv", table);
    for (int eye = 0; eye < 2; ++eye) {
      const Observer& observer = eyes[static_cast<std::size_t>(eye)];
      std::string yaml = "fx_px: 1000\nfy_px: 1000\ncx_px: 799.5\ncy_px: 599.5\nreference_corners:\n";
      for (const auto& [x, y] : {std::pair{0.02, 0.01}, {0.38, 0.01}, {0.38, 0.19}, {0.02, 0.19}}) {
        const Vector3d on_wall(x, eye == 0 ? y : -y, 0), corner = observer.T_world_wall * on_wall;
        const Vector2d pixel = observer.camera.project<double>(observer.T_wall_camera.inverse() * on_wall);
        yaml += print("  - {u_px: %.3f, v_px: %.3f, x_cm: %.6f, y_cm: %.6f, z_cm: %.6f}\n",
                      pixel.x() + kCorner_px * random.normal(), pixel.y() + kCorner_px * random.normal(),
                      100 * corner.x(), 100 * corner.y(), 100 * corner.z());
      }
      writeTextFile(folder_ / print("camera%d.yaml", eye + 1), yaml);
    }
  }

  std::string importing(const std::string& table = "detections.csv") const {
    return "import tie-points " + (folder_ / table).string() + " --left " +
           (folder_ / "camera1.yaml").string() + " --right " + (folder_ / "camera2.yaml").string() +
           " --name pairs --out " + (folder_ / "out").string();
  }

  nlohmann::json verdict() const {
    const auto imported = test::runFathom(importing());
    EXPECT_EQ(imported.status, 0) << imported.err;
    const auto diagnosed = test::runFathom("diagnose " + (folder_ / "out/pairs.rawlog").string() + " --out " +
                                           (folder_ / "out/diagnosis").string());
    EXPECT_EQ(diagnosed.status, 0) << diagnosed.err;
    return nlohmann::json::parse(readTextFile(folder_ / "out/diagnosis/result.json")).at("diagnosis");
  }

  fs::path folder_ = test::scratchFolder();
};

TEST_F(ImportTiePoints, NothingIsMissingInAir) {
  writeData(1.0);
  const auto result = verdict();
  EXPECT_EQ(result.at("verdict"), "none") << result.at("why");
}

TEST_F(ImportTiePoints, TheWaterBehindTheWindowsIsFound) {
  writeData(1.34);
  const auto result = verdict();
  EXPECT_EQ(result.at("verdict"), "explained") << result.at("why");
  ASSERT_EQ(result.at("effects").size(), 1U) << result.at("why");
  const auto& effect = result.at("effects")[0];
  EXPECT_EQ(effect.at("id"), "flat-port-refraction");
  const double found = effect.at("parameters").at("index_error"),
               sigma = effect.at("sigma").at("index_error");
  EXPECT_NEAR(found, 0.34, 4 * sigma);
  EXPECT_LT(sigma, 0.1);
  const auto& held_out = result.at("heldout");
  // Of the ten mismatches one was not that far off: it is in both.
  EXPECT_LT(held_out.at("after"), 0.5 * held_out.at("before").get<double>());
  EXPECT_GT(result.at("heldout_log_likelihood_gain").at("over_black_box_ci95")[0], 0);
}

TEST_F(ImportTiePoints, WrongInputIsOneLine) {
  writeData(1.34);
  const auto complaint = [&](const std::string& arguments) {
    const auto done = test::runFathom(arguments);
    EXPECT_EQ(done.status, 2) << arguments;
    return done.err;
  };
  const std::string header = "camera,frame,id,u_px,v_px\n";
  writeTextFile(folder_ / "third.csv", header + "3,1,0,5,5\n");
  EXPECT_NE(complaint(importing("third.csv")).find("camera must be 1"), std::string::npos);
  writeTextFile(folder_ / "alone.csv", header + "1,1,0,5,5\n2,2,0,5,5\n");
  EXPECT_NE(complaint(importing("alone.csv")).find("nothing is seen by both"), std::string::npos);
  writeTextFile(folder_ / "columns.csv", "camera,frame,u_px,v_px\n1,1,5,5\n");
  EXPECT_NE(complaint(importing("columns.csv")).find("must be camera,frame"), std::string::npos);
  writeTextFile(folder_ / "afar.csv", header + "1,1,0,5,5\n2,1,0,1e12,5\n");
  EXPECT_NE(complaint(importing("afar.csv")).find("off the middle"), std::string::npos);
  const std::string camera = readTextFile(folder_ / "camera2.yaml");
  writeTextFile(folder_ / "camera2.yaml", camera + "distortion: [0.1, 0.2, 0.3]\n");
  EXPECT_NE(complaint(importing()).find("distortion"), std::string::npos);
  writeTextFile(folder_ / "camera2.yaml", camera.substr(0, camera.rfind("  - ")));
  EXPECT_NE(complaint(importing()).find("reference_corners"), std::string::npos);
  EXPECT_FALSE(fs::exists(folder_ / "out/pairs.rawlog"));
}

/// Fish in a real aquarium: the index of water comes out of it.
TEST_F(ImportTiePoints, TheRealAquariumHoldsWater) {
  FATHOM_NEEDS_SHARED("data/two_view");
  const fs::path data = test::sharedData("data/two_view");
  const std::string rawlog = (folder_ / "detections.rawlog").string();
  const auto imported = test::runFathom("import tie-points " + (data / "detections.csv").string() +
                                        " --left " + (data / "camera1.yaml").string() + " --right " +
                                        (data / "camera2.yaml").string() + " --out " + folder_.string());
  ASSERT_EQ(imported.status, 0) << imported.err;
  EXPECT_NE(imported.out.find("2109 frames, 4090 points"), std::string::npos) << imported.out;
  if (test::kSanitized)
    GTEST_SKIP() << "a minute under sanitizers: the simulated aquarium takes the same way there";
  const auto smoothed = test::runFathom("smooth " + rawlog + " --estimate flat-port-refraction --out " +
                                        (folder_ / "smoothed").string());
  ASSERT_EQ(smoothed.status, 0) << smoothed.err;
  const std::string calibration = readTextFile(folder_ / "smoothed/calibration.yaml");
  const std::size_t at = calibration.find("index_error: ");
  ASSERT_NE(at, std::string::npos) << calibration;
  // Water against air: 0.333 to 0.34; corners of the windows that fit to 5 px, and no noise but the one
  // stated.
  EXPECT_NEAR(std::stod(calibration.substr(at + 13)), 0.335, 0.05);
}

}  // namespace
}  // namespace fathom
