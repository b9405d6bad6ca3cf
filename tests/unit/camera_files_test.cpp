// Calibrations as other programs write them: the same camera, whoever wrote it.
#include "imaging/camera_files.h"

#include <gtest/gtest.h>

#include <opencv2/core/persistence.hpp>

#include "core/error.h"
#include "core/files.h"
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

std::string complaint(const std::string& text, const std::string& camera = "cam0") {
  try {
    readCameraFile(written(text), camera);
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
  EXPECT_EQ(readCameraFile(file), expected);
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

TEST(CameraFiles, ReadsCameraInfo) { EXPECT_EQ(readCameraFile(written(kRos)), expectedCamera()); }

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
  EXPECT_EQ(readCameraFile(written(kKalibr), "cam1"), expectedCamera());
  EXPECT_EQ(readCameraFile(written(kKalibr)).width_px, 640);
  EXPECT_NE(complaint(kKalibr, "cam2").find("neither cam2"), std::string::npos);
}

std::string changed(std::string text, const std::string& from, const std::string& to) {
  return text.replace(text.find(from), from.size(), to);
}

TEST(CameraFiles, OtherModelsAreErrors) {
  EXPECT_NE(complaint(changed(kRos, "plumb_bob", "equidistant")).find("distortion_model"), std::string::npos);
  EXPECT_NE(complaint(changed(kKalibr, "radtan", "equidistant")).find("equidistant"), std::string::npos);
  EXPECT_NE(complaint(changed(kKalibr, "pinhole", "omni")).find("omni"), std::string::npos);
  EXPECT_NE(complaint(changed(kRos, "-0.002, 0]", "-0.002, 0, 0.1, 0, 0]")).find("five coefficients"),
            std::string::npos);
  EXPECT_EQ(complaint(changed(kRos, "-0.002, 0]", "-0.002, 0, 0, 0, 0]")), "none");
}

TEST(CameraFiles, ComplaintsNameTheKey) {
  EXPECT_NE(complaint(changed(kRos, "[1101.5", "[-1101.5")).find("camera_matrix"), std::string::npos);
  EXPECT_NE(complaint(changed(kRos, "image_width: 1440", "image_width: 0")).find("image_width"),
            std::string::npos);
  EXPECT_NE(complaint(changed(kRos, "image_height: 1080\n", "")).find("image_width"), std::string::npos);
  EXPECT_NE(complaint("focal: 3\n").find("camera_matrix"), std::string::npos);
}

}  // namespace
}  // namespace fathom
