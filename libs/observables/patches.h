#pragma once

#include <cstddef>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "core/camera_model.h"
#include "imaging/image_patch.h"
#include "render/renderer.h"
#include "sensors/vehicle.h"

/// Synchronized pixels: what the camera read where the rendering knows albedo and distance.
namespace fathom {

/// A few neighbouring pixels of one albedo, away from every edge. Colours are linear red, green, blue.
/// Its albedo_around is there where wanted.
struct Patch : PatchSurface {
  std::size_t image = 0;  ///< which of the images of the fit
  int label = 0;          ///< its own, of those that the pixels were given
  int pixels = 0;         ///< how many
  /// What stands for all pixels: light dies away exponentially, so z is a little less than their mean.
  double z_m = 0;
  double range_m = 0;
  Vector2d pixel = Vector2d::Zero();                           ///< its centre
  Eigen::Matrix2d pixel_covariance = Eigen::Matrix2d::Zero();  ///< of its pixels about that
  Vector3d radiance = Vector3d::Zero();                        ///< mean, as the camera read it
  /// Of that mean, by the sensor's noise, rounding, and what varies within the patch but goes neither with
  /// place nor with albedo. Infinite for a channel that does not count: some pixel is saturated, or it is
  /// black up to its noise.
  Vector3d sigma = Vector3d::Constant(std::numeric_limits<double>::infinity());
  PatchOnRobot<double> on_robot{};  ///< where lamps shine: its place before them
  SightInScene<double> sight{};     ///< to its middle
  Pose T_robot_camera;              ///< likewise: where the camera truly is
};

struct PatchOptions {
  int margin_px = 3;       ///< that pose, blur and JPEG may shift or smear an edge
  int least_pixels = 12;   ///< of a patch
  double flatness = 0.01;  ///< largest difference of albedo within the margin
  bool around = false;     ///< whether albedo_around is wanted
};

struct PatchSet {
  std::vector<Patch> patches;
  std::size_t saturated = 0, dark = 0;  ///< patches with such a channel
  std::string why_not;                  ///< why there is none, or why they cannot be of this image; one line
};

/// CV_8UC1: not 0 where all within the margin is one trusted surface of one albedo.
cv::Mat flatInterior(const View& clean, const cv::Mat& mask, const PatchOptions& options);

/// Where not only is known what is seen, but what forward scattering would mix with it: CV_8UC1, not 0 there.
cv::Mat knownAround(const View& clean, const CameraModel& camera);

/// Where lines of sight about a patch's middle meet its surface, which faces as the panel does: two to either
/// side, one standard deviation of the patch's two directions times the root of two. Panel frame.
std::array<Vector3d, 4> placesAround(const Patch& patch, const CameraModel& camera,
                                     const Pose& T_panel_camera);

/// Their middle, right and up: where light that changes evenly is as its mean over the patch.
Eigen::Vector2d middleOnPanel_m(const std::array<Vector3d, 4>& around_panel);

/// A patch for each square of this side, by default on the grid of JPEG's blocks of colour. CV_32SC1.
cv::Mat squareLabels(const cv::Size& size, int side_px = 16);

/// A patch for each label of `labels` (CV_32SC1) from 0 on. `image` (BGR, 8 or 16 bits) and `clean`, rendered
/// at its pose under ambient light 1; `mask` (CV_8UC1) is not 0 where the rendering is to be trusted;
/// `z_per_range` as cosinesOf(). Takes no patch where the image does not get brighter with the rendering:
/// then it was taken from another pose, or shows another panel.
PatchSet patchesOf(const cv::Mat& image, const View& clean, const cv::Mat& mask, const cv::Mat& z_per_range,
                   const cv::Mat& labels, const CameraSheet& sheet, const PatchOptions& options = {});

}  // namespace fathom
