// Whole recordings with images: what other programs find in them, and what an interruption leaves.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <opencv2/aruco.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/files.h"
#include "panel/panel_map.h"
#include "recording/rawlog.h"
#include "simulation/copy_panel_map.h"
#include "simulation/image_simulator.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"
#include "support/folder_contents.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

using test::kDexrovMap;
using test::kRov;
using test::kSource;

/// Two metres before the panel, moving a little.
const std::string kStation =
    "kind: station\npose: {x: 3.9, y: 0.05, z: -4.25, yaw_deg: 1}\nduration_s: 20\nsway:\n"
    "  - {axis: y, amplitude_m: 0.1, period_s: 7}\n  - {axis: roll, amplitude_deg: 4, period_s: 5}\n"
    "  - {axis: pitch, amplitude_deg: 2, period_s: 6}\n  - {axis: yaw, amplitude_deg: 3, period_s: 8}\n";

Trajectory station(const fs::path& folder) {
  writeTextFile(folder / "station.yaml", kStation);
  return readTrajectory(folder / "station.yaml");
}

/// The shipped vehicle with a camera of 320 x 240 px, ten images.
SimulationOptions smallCamera() {
  SimulationOptions options;
  options.vehicle = readVehicle(kRov);
  CameraModel& model = options.vehicle.camera->model;
  model.width_px /= 2;
  model.height_px /= 2;
  for (double* value : {&model.fx_px, &model.fy_px, &model.cx_px, &model.cy_px}) *value /= 2;
  options.begin_s = 5;
  options.duration_s = 9;
  return options;
}

RecordingTarget target(const fs::path& folder) {
  return {folder, "r", kRov, kDexrovMap, "a test", readEnvironment(kSource / "config/water_moderate.yaml")};
}

void expectSameFiles(const fs::path& a, const fs::path& b) {
  const auto files_a = test::contentsOf(a), files_b = test::contentsOf(b);
  ASSERT_EQ(files_a.size(), files_b.size());
  for (const auto& [name, bytes] : files_a) {
    ASSERT_TRUE(files_b.contains(name)) << name;
    EXPECT_TRUE(files_b.at(name) == bytes) << name;
  }
}

/// ArUco's corners of each marker it finds, refined.
std::map<int, std::array<Vector2d, 4>> detected(const fs::path& file) {
  const cv::Mat image = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  EXPECT_FALSE(image.empty()) << file;
  cv::Mat brighter;
  image.convertTo(brighter, CV_8U, 2.0);
  auto parameters = cv::aruco::DetectorParameters::create();
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_SUBPIX;
  parameters->cornerRefinementWinSize = 3;
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
  cv::aruco::detectMarkers(brighter, cv::aruco::getPredefinedDictionary(cv::aruco::DICT_ARUCO_ORIGINAL),
                           corners, ids, parameters);
  std::map<int, std::array<Vector2d, 4>> result;
  for (std::size_t i = 0; i < ids.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) result[ids[i]][k] = {corners[i][k].x, corners[i][k].y};
  return result;
}

struct Contents {
  RecordingHeader header;
  std::map<Time, Pose> truth;
  std::vector<std::pair<Time, ImageSample>> images;
  std::vector<std::pair<Time, StereoSample>> pairs;
};

Contents read(const fs::path& rawlog) {
  Contents contents;
  RawlogReader reader(rawlog);
  contents.header = reader.header();
  Time last{};
  while (const auto sample = reader.next()) {
    EXPECT_GE(sample->time, last);
    last = sample->time;
    if (sample->label == labels::kTruth)
      contents.truth[sample->time] = std::get<PoseSample>(sample->reading).T_odom_robot.mean;
    if (const auto* image = std::get_if<ImageSample>(&sample->reading))
      contents.images.emplace_back(sample->time, *image);
    if (const auto* pair = std::get_if<StereoSample>(&sample->reading))
      contents.pairs.emplace_back(sample->time, *pair);
  }
  EXPECT_FALSE(reader.loss());
  return contents;
}

// Another detector than ours finds the markers where truth, mounting and intrinsics in the rawlog say.
TEST(SimulatedImages, MarkersAreWhereTruthSaysTheyAre) {
  const auto folder = test::scratchFolder();
  simulateRecording(smallCamera(), station(folder), target(folder / "here"));
  fs::rename(folder / "here", folder / "moved");  // what the rawlog names is beside it
  const Contents contents = read(folder / "moved/r.rawlog");
  ASSERT_EQ(contents.images.size(), 10U);
  EXPECT_EQ(contents.images[7].second.file, "CAMERA_0007.png");
  const PanelMap map = readPanelMap(folder / "moved" / contents.header.panel_map);
  EXPECT_NO_THROW(readVehicle(folder / "moved" / contents.header.vehicle));
  int corners = 0;
  double squares = 0, largest = 0;
  Vector2d sum(0, 0);
  for (const auto& [time, image] : contents.images) {
    const auto found = detected(folder / "moved/r_Images" / image.file);
    const Pose T_camera_panel = (contents.truth.at(time) * image.T_robot_camera).inverse() * map.T_odom_panel;
    for (const Marker& marker : map.markers) {
      if (!found.contains(marker.id)) continue;
      const auto corners_panel = marker.corners_panel();
      for (std::size_t k = 0; k < 4; ++k) {
        const Vector3d point = T_camera_panel * corners_panel[k];
        const Vector2d error_px = image.intrinsics.model.project(point) - found.at(marker.id)[k];
        sum += error_px;
        squares += error_px.squaredNorm();
        largest = std::max(largest, error_px.norm());
        ++corners;
      }
    }
  }
  EXPECT_GE(corners, 10 * 6 * 4);  // half of the markers, 20 px and smaller
  // A wrong convention of pixels, half a pixel, would show in the mean. Single corners of 20 px markers with
  // 3 px cells are what this detector's refinement makes of them.
  EXPECT_LT((sum / corners).norm(), 0.05);
  EXPECT_LT(std::sqrt(squares / corners), 0.35);
  EXPECT_LT(largest, 2.0);
}

TEST(SimulatedImages, StereoDisparityIsFocalLengthTimesBaselineOverDepth) {
  const auto folder = test::scratchFolder();
  SimulationOptions options = smallCamera();
  const double baseline_m = 0.12;
  CameraSheet& sheet = *options.vehicle.camera;
  sheet.model.k1 = sheet.model.k2 = sheet.model.p1 = sheet.model.p2 = 0;
  sheet.T_left_right = Pose{Matrix3d::Identity(), {baseline_m, 0, 0}};
  options.duration_s = 2;
  const auto files = simulateRecording(options, station(folder), target(folder));
  const Contents contents = read(files.rawlog);
  EXPECT_TRUE(contents.images.empty());
  ASSERT_EQ(contents.pairs.size(), 3U);
  const PanelMap map = readPanelMap(kDexrovMap);
  int corners = 0;
  for (const auto& [time, pair] : contents.pairs) {
    EXPECT_LT((pair.T_left_right.position - Vector3d(baseline_m, 0, 0)).norm(), 1e-9);
    const auto left = detected(files.images / pair.left_file),
               right = detected(files.images / pair.right_file);
    const Pose T_camera_panel = (contents.truth.at(time) * pair.T_robot_left).inverse() * map.T_odom_panel;
    for (const Marker& marker : map.markers) {
      if (!left.contains(marker.id) || !right.contains(marker.id)) continue;
      const auto corners_panel = marker.corners_panel();
      for (std::size_t k = 0; k < 4; ++k, ++corners) {
        const double z_m = (T_camera_panel * corners_panel[k]).z();
        const Vector2d shift = left.at(marker.id)[k] - right.at(marker.id)[k];
        EXPECT_NEAR(shift.x(), sheet.model.fx_px * baseline_m / z_m, 1.0);  // of 18 px
        EXPECT_NEAR(shift.y(), 0, 1.0);
      }
    }
  }
  EXPECT_GE(corners, 40);
}

TEST(SimulatedImages, AreTheSameOnOneThreadAndOnMany) {
  const auto folder = test::scratchFolder();
  SimulationOptions options = smallCamera();
  options.duration_s = 4;
  const Trajectory trajectory = station(folder);
  simulateRecording(options, trajectory, target(folder / "many"));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  simulateRecording(options, trajectory, target(folder / "one"));
  expectSameFiles(folder / "many", folder / "one");
}

TEST(SimulatedImages, WhatIsMissingOrDamagedIsMadeAgainAndNothingElse) {
  const auto folder = test::scratchFolder();
  const Trajectory trajectory = station(folder);
  simulateRecording(smallCamera(), trajectory, target(folder / "whole"));
  const auto files = simulateRecording(smallCamera(), trajectory, target(folder / "again"));
  const auto image = [&](int k) { return files.images / ("CAMERA_000" + std::to_string(k) + ".png"); };
  fs::remove(files.rawlog);
  fs::remove(image(0));
  fs::remove(image(5));
  fs::resize_file(image(6), fs::file_size(image(6)) / 2);
  std::string damaged = readTextFile(image(8));
  damaged[damaged.size() / 2] ^= 1;
  writeTextFile(image(8), damaged);
  writeTextFile(image(9).string() + ".part", "half an image");
  const auto untouched = fs::last_write_time(image(7));
  simulateRecording(smallCamera(), trajectory, target(folder / "again"));
  EXPECT_EQ(fs::last_write_time(image(7)), untouched);
  expectSameFiles(folder / "whole", folder / "again");
}

TEST(SimulatedImages, OtherInputsBeginAnew) {
  const auto folder = test::scratchFolder();
  const Trajectory trajectory = station(folder);
  SimulationOptions other = smallCamera();
  other.seed = 2;
  other.duration_s = 3;  // fewer images: none may be left over
  simulateRecording(smallCamera(), trajectory, target(folder / "again"));
  writeTextFile(folder / "again/r_Images/notes.txt", "mine");
  simulateRecording(other, trajectory, target(folder / "again"));
  EXPECT_EQ(readTextFile(folder / "again/r_Images/notes.txt"), "mine");
  fs::remove(folder / "again/r_Images/notes.txt");
  simulateRecording(other, trajectory, target(folder / "fresh"));
  expectSameFiles(folder / "fresh", folder / "again");

  RecordingTarget clearer = target(folder / "again");
  clearer.environment->water.attenuation_per_m *= 0.5;
  simulateRecording(other, trajectory, clearer);
  EXPECT_NE(readTextFile(folder / "fresh/r_Images/CAMERA_0001.png"),
            readTextFile(folder / "again/r_Images/CAMERA_0001.png"));
}

// Lamps add light where the water file says so, and nothing where it does not.
TEST(SimulatedImages, JpegsThatAreCutAreMadeAgain) {
  const auto folder = test::scratchFolder();
  SimulationOptions options = smallCamera();
  options.duration_s = 3;
  options.image_format = {ImageFormat::Kind::jpeg, 80};
  const Trajectory trajectory = station(folder);
  simulateRecording(options, trajectory, target(folder / "whole"));
  const auto files = simulateRecording(options, trajectory, target(folder / "cut"));
  fs::resize_file(files.images / "CAMERA_0001.jpg", 2000);
  fs::resize_file(files.images / "CAMERA_0002.jpg", 0);
  const auto kept = fs::last_write_time(files.images / "CAMERA_0000.jpg");
  simulateRecording(options, trajectory, target(folder / "cut"));
  expectSameFiles(folder / "whole", folder / "cut");
  EXPECT_EQ(fs::last_write_time(files.images / "CAMERA_0000.jpg"), kept);

  options.image_format.jpeg_quality = 40;
  simulateRecording(options, trajectory, target(folder / "cut"));
  EXPECT_LT(fs::file_size(files.images / "CAMERA_0000.jpg"),
            fs::file_size(folder / "whole/r_Images/CAMERA_0000.jpg"));
  options.image_format = {};
  simulateRecording(options, trajectory, target(folder / "cut"));
  EXPECT_FALSE(fs::exists(files.images / "CAMERA_0000.jpg")) << "of other inputs";
  EXPECT_TRUE(fs::exists(files.images / "CAMERA_0000.png"));
}

TEST(SimulatedImages, LampsLightThePanel) {
  const auto folder = test::scratchFolder();
  SimulationOptions options = smallCamera();
  options.duration_s = 0.5;
  RecordingTarget lit = target(folder / "lit");
  lit.environment->lamps_irradiance_1m = Vector3d(2, 2, 2);
  const Trajectory trajectory = station(folder);
  const auto mean = [&](const RecordingTarget& t) {
    const auto files = simulateRecording(options, trajectory, t);
    return cv::mean(cv::imread((files.images / "CAMERA_0000.png").string()))[1];
  };
  EXPECT_GT(mean(lit), mean(target(folder / "dark")) + 5);
}

TEST(SimulatedImages, ThereAreNoneWithoutCameraMapOrWater) {
  const auto folder = test::scratchFolder();
  const Trajectory trajectory = station(folder);
  const auto entries = [&](const SimulationOptions& options, const RecordingTarget& t) {
    const auto files = simulateRecording(options, trajectory, t);
    EXPECT_TRUE(files.images.empty());
    EXPECT_FALSE(fs::exists(t.folder / "r_Images"));
    return read(files.rawlog).images.size();
  };
  SimulationOptions blind = smallCamera();
  blind.vehicle.camera.reset();
  RecordingTarget no_map = target(folder / "no_map"), no_water = target(folder / "no_water");
  no_map.panel_map.clear();
  no_water.environment.reset();
  EXPECT_EQ(entries(blind, target(folder / "blind")), 0U);
  EXPECT_EQ(entries(smallCamera(), no_map), 0U);
  EXPECT_EQ(entries(smallCamera(), no_water), 0U);
}

TEST(SimulatedImages, AMeshElsewhereCannotTravel) {
  const auto folder = test::scratchFolder();
  std::string map = readTextFile(kDexrovMap);
  map.replace(map.find("panel.obj"), 9, (kDexrovMap.parent_path() / "panel.obj").string());
  writeTextFile(folder / "panel.yaml", map);
  EXPECT_THROW(copyPanelMap(folder / "panel.yaml", folder / "copy"), Error);
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto at = text.find(what);
  EXPECT_NE(at, std::string::npos) << what;
  return text.replace(at, what.size(), by);
}

/// `fathom simulate` of 100 small images into a folder.
std::string simulateCommand(const fs::path& folder, const std::string& out) {
  std::string vehicle = readTextFile(kRov);
  for (const auto& [what, by] : {std::pair{"rate_hz: 1\n", "rate_hz: 5\n"},
                                 {"width_px: 640", "width_px: 160"},
                                 {"height_px: 480", "height_px: 120"},
                                 {"555.1962", "138.8"},
                                 {"555.2854", "138.8"},
                                 {"321.1975", "80.1"},
                                 {"244.7355", "61.2"}})
    vehicle = replaced(vehicle, what, by);
  writeTextFile(folder / "vehicle.yaml", vehicle);
  writeTextFile(folder / "r.yaml", kStation);
  return test::shellQuoted(test::fathomProgram()) + " simulate --trajectory " + (folder / "r.yaml").string() +
         " --vehicle " + (folder / "vehicle.yaml").string() + " --map " + kDexrovMap.string() + " --water " +
         (kSource / "config/water_turbid.yaml").string() + " --seed 3 --out " + (folder / out).string();
}

TEST(SimulateCommand, GoesOnWhereItWasInterrupted) {
  const auto folder = test::scratchFolder();
  ASSERT_EQ(test::runShell(simulateCommand(folder, "whole")).status, 0);
  const std::string images = (folder / "cut/r_Images").string();
  const auto cut =
      test::runShell(simulateCommand(folder, "cut") + " & pid=$!; until [[ $(ls " + images +
                     "/*.png 2>/dev/null | wc -l) -ge 5 ]]; do sleep 0.01; done; kill -TERM $pid; "
                     "wait $pid");
  EXPECT_EQ(cut.status, 130) << cut.err;
  EXPECT_FALSE(fs::exists(folder / "cut/r.rawlog"));
  for (const auto& [name, bytes] : test::contentsOf(folder / "cut"))
    EXPECT_FALSE(name.ends_with(".part")) << name;
  const auto made = test::contentsOf(folder / "cut").size();
  EXPECT_LT(made, 90U);

  ASSERT_EQ(test::runShell(simulateCommand(folder, "cut")).status, 0);
  fs::remove(folder / "whole/r_simulation.json");  // says where it was written
  fs::remove(folder / "cut/r_simulation.json");
  expectSameFiles(folder / "whole", folder / "cut");
}

TEST(SimulateCommand, SaysWhyThereAreNoImages) {
  const auto folder = test::scratchFolder();
  const std::string whole = simulateCommand(folder, "out") + " --duration 1";
  const auto without = [&](const std::string& option) {
    const auto at = whole.find(option);
    const auto end = whole.find(" --", at + 1);
    return test::runShell(whole.substr(0, at) + whole.substr(end)).out;
  };
  EXPECT_NE(without(" --water").find("no images: they need --water"), std::string::npos);
  EXPECT_NE(without(" --map").find("no images: they need --map"), std::string::npos);
  EXPECT_NE(test::runShell(whole + " --without camera").out.find("no images: the vehicle has no camera"),
            std::string::npos);
  EXPECT_EQ(test::runShell(whole).out.find("no images"), std::string::npos);
}

/// The shipped vehicle, its lens and focal length others.
fs::path vehicleWith(const fs::path& folder, const std::string& distortion) {
  std::string rov = readTextFile(kRov);
  const std::size_t from = rov.find("distortion: {"), to = rov.find('}', from);
  rov.replace(from, to + 1 - from, "distortion: {" + distortion + "}");
  for (const char* key : {"fx_px: 555.1962", "fy_px: 555.2854"})
    rov.replace(rov.find(key), std::string(key).size(), std::string(key, 5) + ": 380");
  const fs::path file = folder / "vehicle.yaml";
  writeTextFile(file, rov);
  return file;
}

test::ProgramResult simulateWith(const fs::path& folder, const fs::path& vehicle) {
  writeTextFile(folder / "station.yaml", kStation);
  return test::runFathom("simulate --trajectory " + test::shellQuoted((folder / "station.yaml").string()) +
                         " --vehicle " + test::shellQuoted(vehicle.string()) + " --map " +
                         test::shellQuoted(kDexrovMap.string()) +
                         " --water config/water_clear.yaml --duration 10 --name r --out " +
                         test::shellQuoted((folder / "r").string()));
}

/// Images drawn through a fisheye tell where the robot is: rays, corners and the filter agree on the lens.
TEST(SimulatedImages, AreSeenThroughAFisheye) {
  const fs::path folder = test::scratchFolder();
  const auto simulated = simulateWith(
      folder, vehicleWith(folder, "model: fisheye, k1: -0.029, k2: 0.021, k3: -0.032, k4: 0.017"));
  ASSERT_EQ(simulated.status, 0) << simulated.err;
  const auto localized = test::runFathom("localize " + test::shellQuoted((folder / "r/r.rawlog").string()) +
                                         " --tasks TL5 --paper-only --start reference --out " +
                                         test::shellQuoted((folder / "l").string()));
  EXPECT_EQ(localized.status, 0) << localized.err;
  // Of a pinhole of that focal length 0.010 m: markers of 0.16 m at 2 m, corners to 0.15 px.
  EXPECT_NE(localized.out.find("position error 0.0"), std::string::npos) << localized.out;
}

TEST(SimulatedImages, AreNotDrawnThroughALensThatFoldsThemOver) {
  const fs::path folder = test::scratchFolder();
  const auto refused = simulateWith(folder, vehicleWith(folder, "k1: -0.9, k2: 0, p1: 0, p2: 0, k3: 0"));
  EXPECT_EQ(refused.status, 2);
  EXPECT_NE(refused.err.find("camera.distortion: turns back"), std::string::npos) << refused.err;
}

}  // namespace
}  // namespace fathom
