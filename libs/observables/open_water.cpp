#include "observables/open_water.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

constexpr int kAcross = 4, kDown = 3;
// A marker's white has no more, and light in water is not so even that it should count for more.
constexpr int kPixelsOfCell = 400;

/// The cell of each pixel that counts; -1: it does not.
cv::Mat cellsOf(const cv::Size& size) {
  const int wide = (size.width + kAcross - 1) / kAcross, high = (size.height + kDown - 1) / kDown;
  const int step = std::max(1, static_cast<int>(std::sqrt(wide * high / kPixelsOfCell)));
  cv::Mat cells(size, CV_32SC1, cv::Scalar(-1));
  for (int v = 0; v < size.height; v += step)
    for (int u = 0; u < size.width; u += step) cells.at<int>(v, u) = v / high * kAcross + u / wide;
  return cells;
}

}  // namespace

std::vector<Patch> openWaterOf(const CleanPair& pair, const cv::Mat& rays, const Matrix3d& R_odom_camera,
                               const CameraSheet& sheet, int margin_px) {
  const cv::Size size = pair.recorded.size();
  const Vector3d up_camera = R_odom_camera.transpose() * Vector3d::UnitZ();
  cv::Mat cosines, open(size, CV_8UC1, cv::Scalar(0));
  cv::extractChannel(rays, cosines, 2);
  for (int v = 0; v < size.height; ++v)
    for (int u = 0; u < size.width; ++u) {
      const cv::Vec3f& ray = rays.at<cv::Vec3f>(v, u);
      const bool rises = up_camera.dot(Vector3d(ray[0], ray[1], ray[2])) > kOpenWaterSteepness;
      if (rises && std::isinf(pair.clean.range_m.at<float>(v, u))) open.at<std::uint8_t>(v, u) = 255;
    }
  View water;
  water.radiance = cv::Mat(size, CV_32FC3, cv::Scalar::all(0));
  water.range_m = kOpenWater_m / cosines;
  return patchesOf(pair.recorded, water, open, cosines, cellsOf(size), sheet, {.margin_px = margin_px})
      .patches;
}

}  // namespace fathom
