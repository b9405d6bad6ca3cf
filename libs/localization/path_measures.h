#pragma once

#include <optional>
#include <vector>

#include "localization/evaluation.h"

/// The measures of the paper's table, of a path with poses in time order.
namespace fathom {

/// d(reference, path) at the reference's times that the path covers: Euclidean and geodesic distance.
struct PathErrors {
  std::size_t count = 0;
  MeanAndSigma position_m, angle_rad;
};
/// Nothing where the path covers none of the reference's times.
std::optional<PathErrors> errorsAgainst(const std::vector<StampedPose>& reference,
                                        const std::vector<StampedPose>& path);

/// m_A, the lag-one autocorrelation of a path's poses: near 1 where the path is smooth, low where it jerks.
struct PathSmoothness {
  /// Of the increments from one time to the next: Pearson's r between an increment and the one after, the
  /// mean over the axes that move (three of position, in odom, and three of rotation, Log(R_k^T R_k+1)).
  double increments_r = 0;
  /// The paper's own formula, sum over t of F(t) F(t-1), of the positions, divided by the number of terms:
  /// m².
  double mean_product_m2 = 0;
};
/// Sampled at `times` (those of the images), which increase; a time that the path does not cover ends a run
/// of increments. Nothing with fewer than three increments in a row.
std::optional<PathSmoothness> smoothnessOf(const std::vector<StampedPose>& path,
                                           const std::vector<Time>& times);

}  // namespace fathom
