#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/camera_model.h"

/// What of a camera cannot be, or hardly: wherever a calibration comes from.
namespace fathom {

/// Where distortion turns back: beyond, no pixel has a line of sight of its own, and what is seen there would
/// be given an arbitrary one.
struct Fold {
  double ideal_radius = 0;  ///< tangent of the angle to the optical axis
  double radius_px = 0;     ///< from the principal point, where it is nearest to that
  double corner_px = 0;     ///< from there to the image's farthest corner
  double blind_share = 0;   ///< of the image's pixels, those that lie beyond
};

/// Along each direction distort() spreads what is seen up to there, radial and tangential parts together;
/// where a rational lens has a pole, without end. Nothing where the whole image lies within.
std::optional<Fold> foldOf(const CameraModel& camera);

/// One line each; none of a camera that makes sense. A principal point outside the image, sides that look
/// swapped, distortion that folds inside the image.
std::vector<std::string> doubtsAbout(const CameraModel& camera);

}  // namespace fathom
