// Inputs that failed, from public bug reports: what each must give stands in its README.
#include <gtest/gtest.h>

#include "recording/rawlog.h"
#include "recording/tum.h"
#include "sensors/vehicle.h"
#include "support/run_program.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

using test::runFathom;
using test::shellQuoted;

fs::path inputOf(const std::string& name, const std::string& file) {
  return test::sharedData("data/cases/" + name + "/" + file);
}

/// Of this test; each import writes its own files anew.
fs::path outFolder() {
  const char* test = testing::UnitTest::GetInstance()->current_test_info()->name();
  return fs::temp_directory_path() / "fathom-tests" / "public_cases" / test;
}

/// `fathom import WHAT FILE ARGUMENTS --out OUT`.
test::ProgramResult import(const std::string& what, const fs::path& file, const std::string& arguments = "") {
  return runFathom("import " + what + " " + shellQuoted(file.string()) + " " + arguments + " --out " +
                   shellQuoted(outFolder().string()));
}

CameraModel importedCamera(const std::string& name, const std::string& file,
                           const std::string& arguments = "") {
  const auto result = import("camera", inputOf(name, file + ".yaml"), arguments);
  EXPECT_EQ(result.status, 0) << result.err;
  return readVehicle(outFolder() / (file + "_vehicle.yaml")).camera.value().model;
}

void expectCamera(const CameraModel& camera, int width_px, int height_px,
                  const std::array<double, 4>& fx_fy_cx_cy, const std::array<double, 4>& k1_k2_p1_p2) {
  EXPECT_EQ(camera.width_px, width_px);
  EXPECT_EQ(camera.height_px, height_px);
  EXPECT_EQ((std::array{camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px}), fx_fy_cx_cy);
  EXPECT_EQ((std::array{camera.k1, camera.k2, camera.p1, camera.p2}), k1_k2_p1_p2);
  EXPECT_EQ(camera.k3, 0);
}

TEST(PublicCases, CamerasInOtherForms) {
  FATHOM_NEEDS_SHARED("data/cases");
  for (const char* file : {"camera_info", "camera_info_ros1"})
    expectCamera(importedCamera("camera_info_topic_echo", file), 640, 480, {533, 530, 307, 235},
                 {-0.0946, -0.0061, -0.0017, -0.0013});
  expectCamera(importedCamera("camera_several_in_one_ros_file", "cameras", "--camera cam_front"), 640, 480,
               {533, 530, 307, 235}, {-0.095, -0.006, -0.0017, -0.0013});
  expectCamera(importedCamera("camera_kalibr_radial_tangential", "camchain"), 848, 480,
               {434.5, 433.0, 429.3, 235.5}, {0.00878, -0.00585, 0.00095, 0.00083});
}

TEST(PublicCases, CamerasThatMakeNoSense) {
  FATHOM_NEEDS_SHARED("data/cases");
  for (const auto& [name, remark] : {std::pair("camera_distortion_folds", "83 % of the pixels"),
                                     {"camera_principal_point_outside", "1806 x 1132"},
                                     {"camera_width_and_height_swapped", "look swapped"}}) {
    const auto result = import("camera", inputOf(name, "camera.yaml"));
    EXPECT_EQ(result.status, 0) << name;
    EXPECT_NE(result.out.find(remark), std::string::npos) << name << "\n" << result.out;
  }
  for (const auto& [name, reason] : {std::pair("camera_distortion_key_unknown", "no coefficients"),
                                     {"camera_opencv_fisheye", "fisheye"}}) {
    const auto result = import("camera", inputOf(name, "camera.yaml"));
    EXPECT_EQ(result.status, 2) << name;
    EXPECT_NE(result.err.find(reason), std::string::npos) << name << "\n" << result.err;
  }
}

test::ProgramResult importBagOf(const std::string& name) {
  return import("bag", inputOf(name, "dive.bag"),
                "--topics " + shellQuoted(inputOf(name, "topics.yaml").string()));
}

/// The entries of a label.
std::vector<Sample> imported(const std::string& label) {
  std::vector<Sample> samples;
  RawlogReader reader(outFolder() / "dive.rawlog");
  while (const auto sample = reader.next())
    if (sample->label == label) samples.push_back(*sample);
  return samples;
}

TEST(PublicCases, ADvlWithoutBottomLock) {
  FATHOM_NEEDS_SHARED("data/cases");
  for (const auto& [name, all, absent] : {std::tuple("bag_dvl_covariance_says_unknown", 150U, 15),
                                          {"bag_dvl_nan_when_lock_is_lost", 30U, 5},
                                          {"bag_dvl_twiststamped", 15U, 0}}) {
    const auto result = importBagOf(name);
    ASSERT_EQ(result.status, 0) << name << result.err;
    const auto samples = imported(labels::kDvl);
    EXPECT_EQ(samples.size(), all) << name;
    EXPECT_EQ(std::count_if(samples.begin(), samples.end(),
                            [](const Sample& s) { return !std::get<DvlSample>(s.reading).velocity_dvl; }),
              absent)
        << name;
  }
}

TEST(PublicCases, ImagesAndReferencesOfOtherTypes) {
  FATHOM_NEEDS_SHARED("data/cases");
  for (const char* name : {"bag_image_8UC1", "bag_image_mono16"}) {
    const auto result = importBagOf(name);
    ASSERT_EQ(result.status, 0) << name << result.err;
    EXPECT_EQ(imported(labels::kCamera).size(), 2U) << name;
  }
  ASSERT_EQ(importBagOf("bag_reference_posestamped").status, 0);
  const auto reference = readTum(outFolder() / "dive_reference.tum");
  ASSERT_EQ(reference.size(), 15U);
  EXPECT_LT((reference.back().T_odom_robot.position - Vector3d(1.40, 0.10, -5.06)).norm(), 0.01);
}

TEST(PublicCases, AClockThatStepsBack) {
  FATHOM_NEEDS_SHARED("data/cases");
  const auto result = importBagOf("bag_clock_steps_back");
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("reorder window"), std::string::npos) << result.err;
}

TEST(PublicCases, FilesWithOddBytesAndOddPlaces) {
  FATHOM_NEEDS_SHARED("data/cases");
  const auto found =
      runFathom("detect " + shellQuoted(inputOf("jpeg_with_fill_bytes", "marker.jpg").string()) +
                " --family DICT_APRILTAG_36h11");
  EXPECT_EQ(found.status, 0) << found.err;
  EXPECT_NE(found.out.find("59.5"), std::string::npos) << found.out;
  const auto refused =
      runFathom("export kml " + shellQuoted(inputOf("kml_path_in_utm", "path.tum").string()) +
                " --latitude 49.0 --longitude 8.4 --out " + shellQuoted((outFolder() / "x.kml").string()));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("5449 km"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace fathom
