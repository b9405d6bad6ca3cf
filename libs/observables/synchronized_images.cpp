#include "observables/synchronized_images.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/core.hpp>

#include "core/error.h"
#include "core/for_each.h"
#include "image_files/one_opencv_thread.h"
#include "imaging/fingerprints.h"

namespace fathom {
namespace {

/// Pixels by which pose and blur may move or smear an edge, and one or two for JPEG and rounding.
int margin_px(const PosedImage& image, double range) {
  double blur_px = 0;
  for (const Detection& detection : image.detections)
    if (std::isfinite(detection.blur_sigma_px)) blur_px = std::max(blur_px, detection.blur_sigma_px);
  const double position_m = std::sqrt(image.T_odom_robot.covariance.topLeftCorner<3, 3>().trace());
  const double pose_px = image.image.camera.fx_px * position_m / range;
  return std::clamp(static_cast<int>(std::ceil(1.5 + 2 * blur_px + 3 * pose_px)), 2, 8);
}

struct OneImage {
  PatchSet set;
  std::string why_not;
};

/// Squares; where light is bent, only where it is known what it comes from.
cv::Mat squaresOf(const View& clean, const CameraModel& camera, bool scatters) {
  cv::Mat labels = squareLabels(clean.range_m.size());
  if (scatters) labels.setTo(-1, knownAround(clean, camera) == 0);
  return labels;
}

/// When it was seen, where on the panel, and where lamps have it.
void place(const PosedImage& posed, const std::vector<PanelMap>& panels, Patch& patch) {
  const Pose T_panel_camera = panels[posed.panel].T_odom_panel.inverse() * posed.T_odom_camera();
  patch.t_s = posed.t_s;
  patch.T_robot_camera = posed.camera.T_robot_camera;
  const Pose T_robot_panel = patch.T_robot_camera * T_panel_camera.inverse();
  patch.on_robot.around_robot = placesAround(patch, posed.camera.lens, T_panel_camera);
  patch.at_panel_m = middleOnPanel_m(patch.on_robot.around_robot);
  for (Vector3d& point : patch.on_robot.around_robot) point = T_robot_panel * point;
  const Pose T_odom_camera = posed.T_odom_camera();
  patch.sight = {T_odom_camera.position - panels.front().T_odom_panel.position,
                 T_odom_camera.rotation * posed.camera.lens.rayAt(patch.pixel)};
  patch.on_robot.normal_robot = T_robot_panel.rotation.col(2);
}

OneImage patchesFrom(const PosedImage& posed, const CleanPairMaker& maker, const cv::Mat& z_per_range,
                     const Labelling& labelsOf, std::size_t number, const Look& look) {
  OneImage one;
  try {
    const CleanPair pair = maker.clean(posed);
    const bool scatters = maker.world().effects.isActive(kEffectIndex<ForwardScatter>, posed.t_s);
    PatchOptions options;
    options.margin_px = margin_px(posed, range_m(posed, maker.world().panels));
    options.around = scatters || labelsOf;  // a diagnosis asks what forward scattering would mix in
    CameraSheet sheet = maker.camera();
    sheet.bits = 8;
    sheet.model = posed.camera.lens;
    const cv::Mat labels =
        labelsOf ? labelsOf(posed, pair.clean) : squaresOf(pair.clean, sheet.model, scatters);
    one.set = patchesOf(pair.recorded, pair.clean, pair.panel_mask, z_per_range, labels, sheet, options);
    for (Patch& patch : one.set.patches) place(posed, maker.world().panels, patch);
    one.why_not = one.set.why_not;
    if (look && one.why_not.empty()) look(number, pair, labels, options);
  } catch (const Error& problem) {
    one.why_not = problem.why;
  }
  return one;
}

}  // namespace

SynchronizedImages synchronize(const std::vector<PosedImage>& posed, const std::vector<std::size_t>& images,
                               const CleanPairMaker& maker, const Labelling& labelsOf, const Look& look) {
  const OneOpenCvThread one_thread;
  std::map<std::string, cv::Mat> z_per_range;
  for (const std::size_t i : images) {
    cv::Mat& cosines = z_per_range[fingerprintOf(posed[i].camera.lens)];
    if (cosines.empty()) cv::extractChannel(maker.studio().rays(posed[i].camera.lens), cosines, 2);
  }
  std::vector<OneImage> each(images.size());
  forEachIndex(
      images.size(), "rendering where images were taken",
      [&](std::size_t k) {
        const PosedImage& image = posed[images[k]];
        each[k] = patchesFrom(image, maker, z_per_range.at(fingerprintOf(image.camera.lens)), labelsOf,
                              images[k], look);
      },
      imagesAtOnce(maker.camera().model.width_px, maker.camera().model.height_px));
  SynchronizedImages result;
  for (std::size_t k = 0; k < images.size(); ++k) {
    if (!each[k].why_not.empty()) {
      result.rejected.push_back({posed[images[k]].image.file, each[k].why_not});
      continue;
    }
    for (Patch& patch : each[k].set.patches) {
      patch.image = result.images.size();
      result.patches.push_back(patch);
    }
    result.saturated += each[k].set.saturated;
    result.dark += each[k].set.dark;
    result.images.push_back(images[k]);
  }
  return result;
}

}  // namespace fathom
