// Calibrations as other programs write them: the same camera, whoever wrote it.
#include "imaging/camera_files.h"

#include <gtest/gtest.h>

#include <numbers>
#include <opencv2/core/persistence.hpp>
#include <regex>

#include "core/error.h"
#include "core/files.h"
#include "imaging/camera_check.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

CameraModel expectedCamera() {
  CameraModel camera;
  camera.width_px = 1440;
  camera.height_px = 1080;
  camera.fx_px = 1101.5;
  camera.fy_px = 1102.25;
  camera.cx_px = 710.125;
  camera.cy_px = 545.5;
  camera.k1 = -0.125;
  camera.k2 = 0.0625;
  camera.p1 = 0.001;
  camera.p2 = -0.002;
  return camera;
}

fs::path written(const std::string& text) {
  const fs::path file = test::scratchFolder() / "camera.yaml";
  writeTextFile(file, text);
  return file;
}

std::string complaint(const std::string& text, const std::string& camera = "") {
  try {
    readCameraFile(written(text), {camera, {}});
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

// By OpenCV itself, directive and tags and all.
TEST(CameraFiles, ReadsWhatOpenCvWrites) {
  const CameraModel expected = expectedCamera();
  const fs::path file = test::scratchFolder() / "opencv.yaml";
  {
    cv::FileStorage storage(file.string(), cv::FileStorage::WRITE);
    storage << "image_width" << expected.width_px << "image_height" << expected.height_px;
    storage << "camera_matrix"
            << cv::Mat(cv::Matx33d(expected.fx_px, 0, expected.cx_px, 0, expected.fy_px, expected.cy_px, 0, 0,
                                   1));
    storage << "distortion_coefficients"
            << cv::Mat(cv::Matx<double, 5, 1>(expected.k1, expected.k2, expected.p1, expected.p2, 0));
    storage << "avg_reprojection_error" << 0.21;
  }
  EXPECT_EQ(readCameraFile(file).camera, expected);
}

const char* const kRos = R"(image_width: 1440
image_height: 1080
camera_name: narrow_stereo
camera_matrix:
  rows: 3
  cols: 3
  data: [1101.5, 0, 710.125, 0, 1102.25, 545.5, 0, 0, 1]
distortion_model: plumb_bob
distortion_coefficients:
  rows: 1
  cols: 5
  data: [-0.125, 0.0625, 0.001, -0.002, 0]
)";

TEST(CameraFiles, ReadsCameraInfo) { EXPECT_EQ(readCameraFile(written(kRos)).camera, expectedCamera()); }

const char* const kKalibr = R"(cam0:
  camera_model: pinhole
  intrinsics: [500.0, 500.0, 319.5, 239.5]
  distortion_model: radtan
  distortion_coeffs: [0.0, 0.0, 0.0, 0.0]
  resolution: [640, 480]
  rostopic: /left
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.12]
  - [0.0, 1.0, 0.0, 0.0]
  - [0.0, 0.0, 1.0, 0.0]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  intrinsics: [1101.5, 1102.25, 710.125, 545.5]
  distortion_model: radtan
  distortion_coeffs: [-0.125, 0.0625, 0.001, -0.002]
  resolution: [1440, 1080]
)";

TEST(CameraFiles, ReadsOneOfACamchain) {
  EXPECT_EQ(readCameraFile(written(kKalibr), {"cam1", {}}).camera, expectedCamera());
  EXPECT_EQ(readCameraFile(written(kKalibr)).camera.width_px, 640);
  EXPECT_NE(complaint(kKalibr, "cam2").find("cam0, cam1"), std::string::npos);
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

/// kRos that says to have so many coefficients.
std::string ros(int coefficients) {
  return changed(kRos, "cols: 5", "cols: " + std::to_string(coefficients));
}

TEST(CameraFiles, OtherLensesAreReadAsWhatTheyAre) {
  const std::string fisheye =
      changed(kKalibr, "radtan\n  distortion_coeffs: [-0.125", "equidistant\n  distortion_coeffs: [-0.125");
  const CameraModel camera = readCameraFile(written(fisheye), {"cam1", {}}).camera;
  EXPECT_EQ(camera.lens, LensModel::fisheye);
  EXPECT_EQ((std::array{camera.k1, camera.k2, camera.k3, camera.k4, camera.p1, camera.p2}),
            (std::array{-0.125, 0.0625, 0.001, -0.002, 0.0, 0.0}));
  EXPECT_NE(complaint(changed(kRos, "plumb_bob", "equidistant")).find("k1, k2, k3, k4"), std::string::npos);
  const CameraModel rational =
      readCameraFile(written(changed(ros(8), "-0.002, 0]", "-0.002, 0, 0.1, 0, 0]"))).camera;
  EXPECT_EQ(rational.lens, LensModel::rational);
  EXPECT_EQ(rational.k4, 0.1);
  EXPECT_EQ(readCameraFile(written(changed(ros(8), "-0.002, 0]", "-0.002, 0, 0, 0, 0]"))).camera,
            expectedCamera());
  EXPECT_NE(complaint(changed(ros(12), "-0.002, 0]", "-0.002, 0, 0, 0, 0, 0.1, 0, 0, 0]"))
                .find("eight coefficients"),
            std::string::npos);
  EXPECT_NE(complaint(changed(kKalibr, "pinhole", "omni")).find("omni is neither"), std::string::npos);
}

TEST(CameraFiles, ComplaintsNameTheKey) {
  EXPECT_NE(complaint(changed(kRos, "[1101.5", "[-1101.5")).find("camera_matrix"), std::string::npos);
  EXPECT_NE(complaint(changed(kRos, "image_width: 1440", "image_width: 0")).find("image_width"),
            std::string::npos);
  EXPECT_NE(complaint(changed(kRos, "image_height: 1080\n", "")).find("image_width"), std::string::npos);
  EXPECT_NE(complaint("focal: 3\n").find("camera_matrix"), std::string::npos);
}

// The message itself, as `rostopic echo` and `ros2 topic echo` print it; the dashes end it.
TEST(CameraFiles, ReadsAPrintedMessage) {
  const std::string
      numbers = "[-0.125, 0.0625, 0.001, -0.002, 0.0]\n",
      matrix = "[1101.5, 0.0, 710.125, 0.0, 1102.25, 545.5, 0.0, 0.0, 1.0]\n",
      rest = "header:\n  frame_id: camera\nheight: 1080\nwidth: 1440\ndistortion_model: \"plumb_bob\"\n";
  EXPECT_EQ(readCameraFile(written(rest + "D: " + numbers + "K: " + matrix + "---\n")).camera,
            expectedCamera());
  const std::string twice = rest + "d: " + numbers + "k: " + matrix + "---\n";
  EXPECT_EQ(readCameraFile(written(twice + twice)).camera, expectedCamera());
}

TEST(CameraFiles, SeveralCamerasStandUnderTheirNames) {
  std::string indented = "  " + std::regex_replace(std::string(kRos), std::regex("\n(.)"), "\n  $1");
  const std::string both = "front:\n" + indented + "down:\n" + changed(indented, "1440", "640");
  EXPECT_EQ(readCameraFile(written(both), {"front", {}}).camera, expectedCamera());
  EXPECT_EQ(readCameraFile(written(both), {"down", {}}).camera.width_px, 640);
  EXPECT_NE(complaint(both).find("front, down"), std::string::npos);
  EXPECT_NE(complaint(both, "up").find("no camera up; there are front, down"), std::string::npos);
  EXPECT_EQ(readCameraFile(written("front:\n" + indented)).camera, expectedCamera());  // the only one
}

TEST(CameraFiles, WordsForTheSameModelAreRead) {
  EXPECT_EQ(readCameraFile(written(changed(kKalibr, "radtan\n  distortion_coeffs: [-0.125",
                                           "radial-tangential\n  distortion_coeffs: [-0.125")),
                           {"cam1", {}})
                .camera,
            expectedCamera());
  const std::string plain =
      changed(changed(kRos, "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: ", "dist_coeffs: "),
              "image_width: 1440\nimage_height: 1080\n", "");
  EXPECT_NE(complaint(plain).find("--image-size"), std::string::npos);
  EXPECT_EQ(readCameraFile(written(plain), {"", {{1440, 1080}}}).camera, expectedCamera());
}

TEST(CameraFiles, WhatIsAnotherModelsIsNoPlumbBob) {
  EXPECT_NE(complaint("fisheye_model: 1\n" + std::string(kRos)).find("fisheye"), std::string::npos);
  EXPECT_EQ(complaint("fisheye_model: 0\n" + std::string(kRos)), "none");
  EXPECT_NE(
      complaint(changed(kRos, "distortion_coefficients", "distortion_coefficents")).find("no coefficients"),
      std::string::npos);
  EXPECT_NE(complaint(changed(kRos, "[1101.5, 0,", "[1101.5, 3,")).find("skew"), std::string::npos);
  EXPECT_NE(complaint(changed(kRos, "545.5, 0, 0, 1]", "545.5, 0, 0, 2]")).find("camera_matrix"),
            std::string::npos);
}

TEST(CameraFiles, RowsMayBeListsOfTheirOwn) {
  EXPECT_EQ(readCameraFile(written("image_width: 1440\nimage_height: 1080\n"
                                   "camera_matrix: [[1101.5, 0, 710.125], [0, 1102.25, 545.5], [0, 0, 1]]\n"
                                   "dist_coeff: [[-0.125, 0.0625, 0.001, -0.002, 0]]\n"))
                .camera,
            expectedCamera());
}

TEST(CameraFiles, ContradictionsAreSaid) {
  const auto contains = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  contains(complaint(ros(4)), "distortion_coefficients (line 9): says 1 x 4, and has 5 numbers");
  contains(complaint(changed(kRos, "plumb_bob", "none")),
           "distortion_model (line 8): says that there is none");
  contains(complaint(changed(kRos, "plumb_bob", "''")), "distortion_model (line 8): says that there is none");
  contains(complaint(std::string(kRos) + "D: [0.1, 0, 0, 0, 0]\n"), "D (line 13): has other numbers than");
  EXPECT_EQ(complaint(std::string(kRos) + "D: [-0.125, 0.0625, 0.001, -0.002, 0]\n"), "none");
  contains(
      complaint("height: 480\nwidth: 640\ndistortion_model: ''\nd: []\nk: [0, 0, 0, 0, 0, 0, 0, 0, 0]\n"),
      "not calibrated");
  contains(complaint(kRos, "nix"), "one camera, without a name");
  contains(complaint("focal: 3\n"), "camera.yaml: line 1: holds no camera");
}

std::string remarksOn(const std::string& text) {
  std::string all;
  for (const std::string& remark : readCameraFile(written(text)).remarks) all += remark + "\n";
  return all;
}

TEST(CameraFiles, WhatIsNotAppliedIsRemarked) {
  const std::string roi = "roi: {x_offset: 0, y_offset: 0, width: 0, height: 0}\n",
                    full = "roi: {x_offset: 0, y_offset: 0, width: 1440, height: 1080}\n",
                    part = "roi: {x_offset: 0, y_offset: 0, width: 300, height: 200}\n";
  const std::string message =
      "height: 1080\nwidth: 1440\ndistortion_model: plumb_bob\nd: [-0.1, 0, 0, 0, 0]\n"
      "k: [1101.5, 0, 710.125, 0, 1102.25, 545.5, 0, 0, 1]\nbinning_x: 0\nbinning_y: 0\n";
  EXPECT_EQ(remarksOn(message + roi) + remarksOn(message + full), "");
  EXPECT_NE(remarksOn(message + part).find("300 x 200 px at (0, 0), is not applied"), std::string::npos);
  EXPECT_NE(remarksOn(changed(message, "binning_x: 0", "binning_x: 2")).find("binning of 2 x 0"),
            std::string::npos);
  const std::string bare = changed(changed(message, "d: [-0.1, 0, 0, 0, 0]\n", ""), "plumb_bob", "none");
  EXPECT_NE(remarksOn(bare).find("no distortion coefficients"), std::string::npos);

  const std::string other = changed(message, "-0.1", "-0.2");
  EXPECT_EQ(remarksOn(message + "---\n" + message + "---\n" + message.substr(0, 60)), "");
  EXPECT_NE(remarksOn(message + "---\n" + message + "---\n" + other + "---\n").find("another camera"),
            std::string::npos);
}

TEST(CameraCheck, SaysWhatMakesNoSense) {
  const auto doubts = [](int width_px, int height_px, double f_px, double cx_px, double cy_px) {
    CameraModel camera;
    camera.width_px = width_px;
    camera.height_px = height_px;
    camera.fx_px = camera.fy_px = f_px;
    camera.cx_px = cx_px;
    camera.cy_px = cy_px;
    std::string all;
    for (const std::string& doubt : doubtsAbout(camera)) all += doubt + "\n";
    return all;
  };
  EXPECT_EQ(doubts(960, 540, 583, 480, 272), "");
  EXPECT_EQ(doubts(960, 540, 583, 300, 400), "");  // far off, but in it
  EXPECT_NE(doubts(540, 960, 583, 480, 272).find("swapped"), std::string::npos);
  for (const auto& [width, height] : {std::pair(640, 480), {1280, 1024}, {1280, 960}}) {
    EXPECT_NE(doubts(height, width, 900, 0.5 * width, 0.5 * height).find("swapped"), std::string::npos)
        << width;
    EXPECT_EQ(doubts(width, height, 900, 0.55 * width, 0.44 * height), "") << width;
  }
  EXPECT_NE(doubts(640, 480, 533, 235, 307).find("swapped"), std::string::npos);
  EXPECT_NE(doubts(400, 300, 2339, 903, 566).find("1806 x 1132"), std::string::npos);
}

// r (1 - 0.93 r² + 1.057 r⁴ - 0.659 r⁶): its derivative, 1 - 2.79 s + 5.285 s² - 4.613 s³ of s = r², is zero
// at s = 0.7239, where it is 0.5366; the farthest corner is hypot(497.5, 521) px off or so.
TEST(CameraCheck, DistortionThatTurnsBackInsideTheImageIsSeen) {
  CameraModel camera;
  camera.width_px = 992;
  camera.height_px = 1040;
  camera.fx_px = camera.fy_px = 440;
  camera.cx_px = 495;
  camera.cy_px = 519;
  camera.k1 = -0.93;
  camera.k2 = 1.057;
  camera.k3 = -0.659;
  const auto fold = foldOf(camera);
  ASSERT_TRUE(fold.has_value());
  EXPECT_NEAR(fold->ideal_radius, std::sqrt(0.7239), 1e-4);
  EXPECT_NEAR(fold->radius_px, 0.5366 * 440, 0.1);
  EXPECT_NEAR(fold->corner_px, 720, 5);
  EXPECT_NEAR(fold->blind_share, 1 - std::numbers::pi * fold->radius_px * fold->radius_px / (992 * 1040),
              2e-3);
  camera.width_px = camera.height_px = 200;
  camera.cx_px = camera.cy_px = 100;
  EXPECT_FALSE(foldOf(camera).has_value());  // it turns back outside
  EXPECT_FALSE(foldOf(expectedCamera()).has_value());
}

// r (1 + 0.1 r² + 0.1 r⁴) over 1 - 1.5 r² grows without end up to its pole at r = 0.816; every pixel is
// within.
TEST(CameraCheck, ARationalLensMayHaveAPole) {
  CameraModel camera{640, 480, 533, 530, 307, 235, 0.1, 0.1};
  camera.lens = LensModel::rational;
  camera.k4 = -1.5;
  EXPECT_FALSE(foldOf(camera).has_value());
}

// x + p2 (3 x² + y²) has no slope along y = 0 at x = -1 / (6 p2), where it is -1 / (12 p2).
TEST(CameraCheck, TangentialDistortionFoldsToo) {
  CameraModel camera{640, 480, 533, 533, 307, 235};
  camera.p2 = -0.4;
  const auto fold = foldOf(camera);
  ASSERT_TRUE(fold.has_value());
  EXPECT_NEAR(fold->ideal_radius, 1 / 2.4, 1e-3);
  EXPECT_NEAR(fold->radius_px, 533 / 4.8, 0.1);
  EXPECT_NEAR(fold->blind_share, (640 - 307 - fold->radius_px) / 640, 0.1);
  camera.p2 = -0.04;
  EXPECT_FALSE(foldOf(camera).has_value());
}

}  // namespace
}  // namespace fathom
