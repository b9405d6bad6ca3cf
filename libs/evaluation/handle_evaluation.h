#pragma once

#include <limits>
#include <string>
#include <vector>

#include "evaluation/statistics.h"
#include "handles/handle_reader.h"
#include "observables/views.h"

/// Task T_H: how far the handles' angles are from truth, by the paper's chain (Mueller et al. 2018) and by
/// matching renders, on the same images.
namespace fathom {

struct HandleEvaluationOptions {
  std::size_t views = 1000;  ///< one handle each, in turn
  std::uint64_t seed = 1;
  ViewRanges ranges{.largest_tilt_rad = radians(50), .largest_aim_m = 0};  ///< to the handle, not the panel
};

/// What came of one view of one handle.
struct HandleViewResult {
  CameraView view;  ///< before the handle instead of the panel's centre
  std::size_t handle = 0;
  double true_angle_rad = 0;
  bool posed = false;  ///< the panel's pose was found, by its markers
  bool confident = false;
  std::string why_not;

  // Without sign, rad; NaN where there is no angle.
  double error_rad = std::numeric_limits<double>::quiet_NaN();  ///< of what was stated, or would have been
  double sigma_rad = std::numeric_limits<double>::quiet_NaN();  ///< as stated
  double signed_error_rad = std::numeric_limits<double>::quiet_NaN();
  double chain_error_rad = std::numeric_limits<double>::quiet_NaN();  ///< as far as the chain's symmetry goes
  double chain_prominence = 0;
  double disagreement_rad = std::numeric_limits<double>::quiet_NaN();
  double support = 0, evidence = 0, misfit = 0;  ///< see HandleMatch
  /// Of the contour with what the renderer says is the handle; NaN where there is no contour.
  double overlap = std::numeric_limits<double>::quiet_NaN();
};

/// The image of a view with all handles turned at random, which one is looked at, and the truth.
struct HandleViewImage {
  PanelMap map;  ///< with the handles' true angles
  cv::Mat image_bgr;
  cv::Mat mask;  ///< CV_8UC1: 255 where the handle is seen
  CameraView view;
  std::size_t handle = 0;
};

/// Makes the images; from one thread at a time.
class HandleViews {
 public:
  /// Throws std::invalid_argument where the vehicle has no camera or the map no handles.
  HandleViews(PanelMap map, const Vehicle& vehicle, const Environment& environment,
              const HandleEvaluationOptions& options);
  HandleViewImage make(std::uint64_t number);

 private:
  PanelMap map_;
  CameraSheet sheet_;
  Environment environment_;
  HandleEvaluationOptions options_;
  Renderer renderer_;
  ImageModel model_;
};

/// Draws views, makes their images, finds the panel by its markers and reads the handle, all cores at once;
/// results in the order of views, the same on however many cores. Readers know daylight and water. Throws as
/// HandleViews does; Interrupted.
std::vector<HandleViewResult> evaluateHandles(const PanelMap& map, const Vehicle& vehicle,
                                              const Environment& environment,
                                              const HandleEvaluationOptions& options,
                                              const std::string& name = "views");

}  // namespace fathom
