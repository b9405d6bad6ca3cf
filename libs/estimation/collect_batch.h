#pragma once

#include <vector>

#include "estimation/batch_data.h"
#include "landmarks/detection_cache.h"
#include "landmarks/tie_points.h"
#include "recording/sample_source.h"

namespace fathom {

struct BatchDataOptions {
  double knot_s = 0.2;
  TiePoints tie_points;  ///< of the recording's pairs of images
};

/// Reads a source to its end. What is not a number, impossible or there twice is left out and counted; there
/// is no gate beyond that but for tie points (estimation/tie_point_gate.h): what does not fit is what a
/// diagnosis looks for. Markers are those of the images' files that the panels' maps have. Attitude is taken
/// where the vehicle has a sigma for it. Throws Error where nothing is left. Windows before the cameras are
/// where the vehicle has them.
BatchData collectBatch(SampleSource& source, const Detections& detections, const Vehicle& vehicle,
                       const std::vector<PanelMap>& panels, const BatchDataOptions& options = {});

}  // namespace fathom
