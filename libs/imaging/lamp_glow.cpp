#include "imaging/lamp_glow.h"

#include <algorithm>

namespace fathom {

/// Simpson's rule from each tabulated range to the next.
LampGlow::LampGlow(const CameraModel& camera, const Pose& T_robot_camera, const std::vector<LampSheet>& lamps,
                   const Environment& environment, double asymmetry)
    : rows_((camera.height_px - 1) / kCell_px + 2), columns_((camera.width_px - 1) / kCell_px + 2) {
  constexpr double kStep = 1.0 / kRanges;  // the last is short of infinity
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const Vector3d ray = camera.rayAt({kCell_px * column, kCell_px * row});
      const LitSight<double> sight{T_robot_camera.position, T_robot_camera.rotation * ray, ray.z(),
                                   environment.water,       environment.ambient,           asymmetry};
      const auto slope = [&](double w) {
        return Vector3d(sight.gain(lamps, w / (1 - w)) / ((1 - w) * (1 - w)));
      };
      Vector3d sum = Vector3d::Zero(), low = slope(0);
      for (int k = 0; k < kRanges; ++k) {
        table_.emplace_back(cv::Vec3d(sum[0], sum[1], sum[2]));
        if (k + 1 == kRanges) break;
        const Vector3d middle = slope((k + 0.5) * kStep), high = slope((k + 1) * kStep);
        sum += kStep / 6 * (low + 4 * middle + high);
        low = high;
      }
    }
}

cv::Mat LampGlow::upTo(const cv::Mat& range_m) const {
  cv::Mat glow(range_m.size(), CV_32FC3);
  for (int v = 0; v < glow.rows; ++v)
    for (int u = 0; u < glow.cols; ++u) {
      const float range = range_m.at<float>(v, u);
      const float share = std::isfinite(range) ? rangeShare(range) * kRanges : kRanges;
      const int row = v / kCell_px, column = u / kCell_px, k = std::min(static_cast<int>(share), kRanges - 2);
      const float down = static_cast<float>(v % kCell_px) / kCell_px,
                  right = static_cast<float>(u % kCell_px) / kCell_px,
                  far = std::min(share - static_cast<float>(k), 1.0F);
      const auto along = [&](int r, int c) { return at(r, c, k) * (1 - far) + at(r, c, k + 1) * far; };
      glow.at<cv::Vec3f>(v, u) =
          (along(row, column) * (1 - right) + along(row, column + 1) * right) * (1 - down) +
          (along(row + 1, column) * (1 - right) + along(row + 1, column + 1) * right) * down;
    }
  return glow;
}

}  // namespace fathom
