#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/progress.h"
#include "handles/handle_reader.h"
#include "sil/pair_maker.h"

/// Task T_H over a recording: the handles of the panel in each of its images.
namespace fathom {

/// One handle in one image.
struct HandleSight {
  std::size_t image = 0;  ///< in PosedImages::posed
  std::size_t panel = 0, handle = 0;
  bool confident = false;
  std::string why_not;  ///< where it is not
  double angle_rad = std::numeric_limits<double>::quiet_NaN();
  double sigma_rad = std::numeric_limits<double>::quiet_NaN();
  double chain_angle_rad = std::numeric_limits<double>::quiet_NaN();  ///< the paper's chain
  double chain_symmetry_rad = std::numeric_limits<double>::quiet_NaN();
  double disagreement_rad = std::numeric_limits<double>::quiet_NaN();
  // The moving average of this handle's confident angles up to here; NaN before the first.
  double average_rad = std::numeric_limits<double>::quiet_NaN();
  double average_sigma_rad = std::numeric_limits<double>::quiet_NaN();
};

/// What a handle's angles come to over all of a recording.
struct HandleState {
  std::size_t panel = 0, handle = 0;
  std::size_t images = 0;     ///< in which its panel is
  std::size_t confident = 0;  ///< angles
  std::size_t contradicted =
      0;  ///< confident ones that the paper's chain contradicts by more than 15 degrees
  double angle_rad =
      std::numeric_limits<double>::quiet_NaN();  ///< within its range; NaN where none is confident
  double sigma_rad = std::numeric_limits<double>::quiet_NaN();
};

/// An image and what it looks like, by whom wants to draw it. Called from several threads.
using SeeHandles = std::function<void(const PosedImage& posed, const cv::Mat& image_bgr,
                                      const std::vector<HandleReading>& readings)>;

/// Reads every handle of the panel by which an image was posed, all cores at once; in the order of images and
/// handles, averages over the last `window` confident angles included. `world`: its panels' handles' angles
/// do not matter. Images that cannot be read are left out. Throws Interrupted.
std::vector<HandleSight> recordedHandles(const PosedImages& images, const KnownWorld& world,
                                         std::size_t window, const SeeHandles& see = {});
/// The same in images that are simulated from where these were taken, of the world as it is.
std::vector<HandleSight> simulatedHandles(const PosedImages& images, const PairMaker& maker,
                                          std::size_t window);

std::vector<HandleState> statesOf(const std::vector<HandleSight>& sights,
                                  const std::vector<PanelMap>& panels);

/// The panel before the camera of an image.
UncertainPose T_camera_panelOf(const PosedImage& posed, const PanelMap& panel);

}  // namespace fathom
