#pragma once

#include <optional>
#include <string>
#include <vector>

#include "calibration/camera_fit.h"
#include "calibration/projection.h"

/// Which kind of camera views are of: each kind is fitted to some of the views and judged on the others.
namespace fathom {

struct SelectionOptions {
  std::vector<std::string> kinds;  ///< ids; empty: all that the views can tell
  int folds = 5;
  double range_m = 0;  ///< where two calibrations are compared; 0: at the views' median distance
  std::uint64_t seed = 1;
};

/// What became of one kind.
struct KindResult {
  CameraFit fit;            ///< of all views that it explains
  double heldout_rms_px{};  ///< of points that were not fitted, in views that were not
  /// Mean square of the same less that of the best kind, px², and its sigma over views.
  double worse_px2{}, worse_sigma_px2{};
  /// By how far calibrations of every second view and of the others differ, rms over the image, px, and what
  /// their covariances say of that.
  double halves_px{}, halves_sigma_px{};
};

struct CameraSelection {
  std::vector<KindResult> kinds;                            ///< in the order of cameraKinds()
  std::vector<std::pair<std::string, std::string>> failed;  ///< a kind's id, and why
  /// The simplest that no other is clearly better than; without a port it takes a lens in air and one in
  /// water.
  std::size_t chosen = 0;
  ProjectionGrid grid;
  std::vector<double> sigma_px;          ///< of the chosen one, on the grid
  std::optional<CameraFit> by_opencv{};  ///< of the views that are judged on
  double opencv_heldout_rms_px{};
};

/// Kinds with a port are fitted to all views; those without to the views in water alone, or to those in air
/// where no others are. Judged on views in water, if there are any: a pose is found from every second point,
/// the others tell. Throws std::invalid_argument: too few views, a kind that does not exist, one with a port
/// without views in water; Interrupted.
CameraSelection selectCamera(const std::vector<BoardView>& views, const CameraSetting& setting,
                             const SelectionOptions& options);

}  // namespace fathom
