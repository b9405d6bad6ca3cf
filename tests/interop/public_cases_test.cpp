// Inputs that failed, from public bug reports: what each must give stands in its README.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "core/files.h"
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
  const auto result = import("camera", inputOf("camera_distortion_key_unknown", "camera.yaml"));
  EXPECT_EQ(result.status, 2);
  EXPECT_NE(result.err.find("no coefficients"), std::string::npos) << result.err;
}

/// Its README: 30 degrees to the right of the axis is at x = 640 + 560 * 0.51997.
TEST(PublicCases, AFisheyeIsOne) {
  FATHOM_NEEDS_SHARED("data/cases");
  const CameraModel camera = importedCamera("camera_opencv_fisheye", "camera");
  const Vector2d pixel = camera.project(Vector3d(std::tan(radians(30)), 0, 1));
  EXPECT_NEAR(pixel.x(), 640 + 560 * 0.51997, 0.01);
  EXPECT_NEAR(pixel.y(), 360, 1e-9);
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
  EXPECT_NE(result.err.find("the clock of its stamps was set"), std::string::npos) << result.err;
}

/// The audit names what a driver got wrong, commands refuse to believe it, and corrected it is as good as if
/// it had been right.
TEST(PublicCases, UnitsThatDriversGetWrong) {
  FATHOM_NEEDS_SHARED("data/cases");
  struct Case {
    const char* folder;
    const char* name;
    const char* says;
  };
  for (const Case& c :
       {Case{"bag_accelerometer_in_g", "accelerometer-in-g", "0.102 of gravity's 9.8066; it is in g"},
        Case{"bag_gyro_in_degrees", "gyro-in-degrees", "if it is in degrees a second"},
        Case{"bag_pressure_in_kilopascal", "pressure-in-kilopascal", "it is in kPa"}}) {
    const auto bag = [&](const std::string& arguments) {
      return import("bag", inputOf(c.folder, "dive.bag"),
                    "--topics " + shellQuoted(inputOf(c.folder, "topics.yaml").string()) + arguments);
    };
    const auto localize = [](const std::string& arguments) {
      return runFathom("localize " + shellQuoted((outFolder() / "dive.rawlog").string()) + " --reference " +
                       shellQuoted((outFolder() / "dive_reference.tum").string()) +
                       " --tasks TL2 --paper-only --out " + shellQuoted((outFolder() / "path").string()) +
                       arguments);
    };
    const auto as_it_is = bag("");
    EXPECT_EQ(as_it_is.status, 0) << as_it_is.err;
    EXPECT_NE(as_it_is.out.find(c.says), std::string::npos) << as_it_is.out;
    const auto refused = localize("");
    EXPECT_EQ(refused.status, 2);
    EXPECT_NE(refused.err.find(std::string("--correct ") + c.name), std::string::npos) << refused.err;
    EXPECT_EQ(localize(std::string(" --accept ") + c.name).status, 0);
    // The same dive with nothing wrong is 0.016 m off (mean).
    const std::regex error("position error (0\\.0[0-9]+) ");
    const auto corrected = localize(std::string(" --correct ") + c.name);
    EXPECT_TRUE(std::regex_search(corrected.out, error)) << corrected.out << corrected.err;
    const auto imported_right = bag(std::string(" --correct ") + c.name);
    EXPECT_EQ(imported_right.out.find("(sure"), std::string::npos) << imported_right.out;
    EXPECT_EQ(localize("").status, 0);
  }
}

/// Engraved plates and Kalibr's grids are read where asked for; an empty table says what was not looked for.
TEST(PublicCases, MarkersThatLookOtherwise) {
  FATHOM_NEEDS_SHARED("data/cases");
  for (const std::string backend : {"aruco", "apriltag"}) {
    const auto detect = [&](const fs::path& image, const std::string& arguments) {
      return runFathom("detect " + shellQuoted(image.string()) + " --corners fitted --backend " + backend +
                       " --family " + arguments);
    };
    const fs::path border2 = inputOf("marker_with_double_border", "border2.png"),
                   grid = inputOf("marker_with_double_border", "aprilgrid.png"),
                   inverted = inputOf("marker_white_on_black", "inverted_enclosed.png");
    const auto none = detect(border2, "DICT_APRILTAG_36h11");
    EXPECT_NE(none.err.find("no marker found"), std::string::npos) << none.err;
    EXPECT_NE(none.err.find("--border-cells"), std::string::npos) << none.err;
    const auto one = detect(border2, "DICT_APRILTAG_36h11 --border-cells 2");
    EXPECT_TRUE(one.err.empty()) << one.err;
    // The border square is drawn from 47.5 to 207.5 px.
    EXPECT_TRUE(std::regex_search(
        one.out, std::regex(",11,4[78]\\.[0-9]+,4[78]\\.[0-9]+,20[78]\\.[0-9]+,4[78]\\.[0-9]+,20[78]\\.")))
        << backend << one.out;
    const auto four = detect(grid, "tag36h11 --border-cells 2");
    for (int id = 0; id < 4; ++id)
      EXPECT_NE(four.out.find("aprilgrid.png," + std::to_string(id) + ","), std::string::npos)
          << backend << four.out;
    EXPECT_NE(detect(inverted, "DICT_5X5_50").err.find("--white-on-black"), std::string::npos);
    const auto engraved = detect(inverted, "DICT_5X5_50 --white-on-black");
    EXPECT_NE(engraved.out.find("inverted_enclosed.png,3,"), std::string::npos) << backend << engraved.out;
  }
}

/// It keeps station 3.4 m from odom's origin, before a panel whose pose is known.
TEST(PublicCases, ARobotStartsWhereMarkersTell) {
  FATHOM_NEEDS_SHARED("data/cases");
  // Detections are kept beside the recording.
  fs::remove_all(outFolder());
  fs::create_directories(outFolder().parent_path());
  fs::copy(inputOf("localize_starts_at_zero_although_markers_tell", ""), outFolder(),
           fs::copy_options::recursive);
  const auto done = runFathom("localize " + shellQuoted((outFolder() / "station.rawlog").string()) +
                              " --tasks TL1,TL3,TL5 --out " + shellQuoted((outFolder() / "out").string()));
  ASSERT_EQ(done.status, 0) << done.err;
  const auto result = nlohmann::json::parse(readTextFile(outFolder() / "out/result.json"));
  ASSERT_EQ(result["tasks"].size(), 6u);
  for (const auto& [id, task] : result["tasks"].items()) {
    // Some centimetres, as from the reference's first pose. TL1 improved has lone markers alone, some of them
    // mirrored.
    EXPECT_LT(task["filter_error"]["position_error_mean_m"].get<double>(), id == "TL1_IMPROVED" ? 0.2 : 0.06)
        << id;
    EXPECT_NE(task["start"]["source"].get<std::string>().find("fixes agree"), std::string::npos)
        << task["start"];
  }
}

/// Class names without a namespace, in the serialization of then.
TEST(PublicCases, RawlogsOfMrpt1) {
  FATHOM_NEEDS_SHARED("data/cases");
  const fs::path rawlog = inputOf("rawlog_class_names_of_mrpt1", "three_imu.rawlog");
  RawlogReader reader(rawlog);
  std::vector<Sample> samples;
  while (const auto sample = reader.next()) samples.push_back(*sample);
  EXPECT_FALSE(reader.loss());
  ASSERT_EQ(samples.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(samples[i].label, "imu");
    EXPECT_NEAR(secondsBetween(samples[0].time, samples[i].time), 0.01 * static_cast<double>(i), 1e-6);
  }
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
