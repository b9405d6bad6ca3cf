#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "estimation/batch_problem.h"
#include "estimation/collect_batch.h"
#include "localization/options.h"

/// Where the batch estimate starts from.
namespace fathom {

struct StartPath {
  std::vector<double> times_s;  ///< increasing
  std::vector<Pose> T_odom_robot;
  std::string source;              ///< what made it, or why there is none
  std::optional<StartPose> given;  ///< the start pose, where the user knows it

  /// What is known of the path's beginning besides the readings: the start pose given; where there is none,
  /// and nothing tells a position in odom (markers, USBL), that odom is what the filter began with (1 mm,
  /// 1 mrad); else next to nothing. A depth sensor tells the height.
  std::optional<PathPrior> prior(const BatchData& data) const;
};

/// The filter's path, smoothed, with all channels fused and the markers' joint panel poses. `samples` is a
/// source with sightings in it (LandmarkSource).
StartPath filterStart(const BatchData& data, SampleSource& samples,
                      const EffectParameters<double>& calibration, const std::optional<StartPose>& start);

/// Each image's own pose by the markers of the panel that most of them are on: for recordings without motion.
StartPath imageStart(const BatchData& data);

/// A recording as the batch estimate wants it.
struct BatchInput {
  BatchData data;
  StartPath start;
};
/// `open` gives the recording's samples anew each time. Throws Error as collectBatch(), Interrupted.
BatchInput batchInput(const std::function<std::unique_ptr<SampleSource>()>& open,
                      const Detections& detections, const Vehicle& vehicle,
                      const std::vector<PanelMap>& panels, const EffectParameters<double>& calibration = {},
                      const std::optional<StartPose>& start = {}, const BatchDataOptions& options = {});

}  // namespace fathom
