#pragma once

#include <vector>

#include "calibration/camera_fit.h"

/// How far two calibrations of a camera differ, and how well one is known, as it matters: by where in the
/// image a point is seen (mrcal: Kogan 2021, "projection uncertainty" and "implied transformation"). A
/// camera's own frame is nobody's to know, so the turn and shift between two are fitted away first.
namespace fathom {

/// Where it is asked: pixels all over the image, and points so far away along their lines of sight.
struct ProjectionGrid {
  std::vector<Vector2d> pixels;
  int columns = 0, rows = 0;
  double range_m = 1;
  bool in_water = false;
};
ProjectionGrid gridOver(const CameraSetting& setting, double range_m, bool in_water);

/// What `other` sees of the points that `camera` has on the grid, less the grid's pixels, px: once the turn
/// and shift of one camera's frame against the other's is what fits best.
std::vector<Vector2d> projectionDifference(const CameraFit& camera, const CameraFit& other,
                                           const ProjectionGrid& grid);

/// Sigma of each coordinate at each pixel of the grid, px: by draws of the camera's unknowns from their
/// covariance.
std::vector<double> projectionSigma(const CameraFit& camera, const ProjectionGrid& grid, Random& random);

}  // namespace fathom
