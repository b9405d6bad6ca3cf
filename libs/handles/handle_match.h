#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "handles/close_up.h"
#include "imaging/image_model.h"

/// A handle's angle by analysis by synthesis: rendered at candidate angles through the water, and compared
/// with the image.
namespace fathom {

/// What is known of the scene beside the image.
struct HandleScene {
  PanelMap map;
  CameraSheet sheet;        ///< the sensor; lens and mounting do not matter
  Environment environment;  ///< daylight and water, lamps off
};

/// How well a rendered angle fits.
struct AngleFit {
  double angle_rad = 0;
  double chi_square = 0;  ///< of what the image differs by, in its own noise
};

struct HandleMatch {
  bool found = false;
  std::string why_not;   ///< where it is not
  double angle_rad = 0;  ///< within the handle's range
  /// Of the fit's curvature, the noise as large as what is left shows it to be.
  double sigma_rad = 0;
  /// ln of how much likelier it is than the best angle that is more than 15 degrees off.
  double support = 0;
  double evidence = 0;         ///< by how much chi-square is less than with a panel that has no handle there
  double misfit = 0;           ///< share of that which the best angle leaves beyond noise
  std::vector<AngleFit> fits;  ///< all that were tried, in the order of angles
  cv::Mat seen, simulated;     ///< CV_32FC3, linear: the close-up, and it at the best angle in the same light
  cv::Mat in_reach;            ///< CV_8UC1: what was compared
};

/// Matches handles of one map. From one thread at a time; keeps renderers.
class HandleMatcher {
 public:
  explicit HandleMatcher(HandleScene scene);
  ~HandleMatcher();
  HandleMatcher(HandleMatcher&&) noexcept;

  /// `handle` is its place in the map's list. Each colour's gain and veil are fitted to the image at each
  /// angle: light need not be known, what water does over the handle's depth must be. The handle must be in
  /// view (FrontView).
  HandleMatch match(const PosedPanelImage& image, std::size_t handle);

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace fathom
