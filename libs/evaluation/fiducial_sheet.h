#pragma once

#include <opencv2/core.hpp>

#include "evaluation/fiducial_comparison.h"

namespace fathom {

/// A contact sheet of the grid, CV_8UC3: a row for each family and reader; images near, farther and far, and
/// at the middle range most aslant, in the last water, most blurred and with all factors in the middle.
/// Throws as compareFiducials().
cv::Mat fiducialSheet(const FiducialGrid& grid, const PanelMap& map, const Vehicle& vehicle);

}  // namespace fathom
