#pragma once

#include <vector>

#include "core/random.h"
#include "fiducials/predicted_search.h"
#include "imaging/water.h"
#include "observables/views.h"
#include "sensors/vehicle.h"
#include "support/shipped.h"

/// Rendered views of the shipped panel, and where a filter would predict it.
namespace fathom::test {

/// A filter's: 1 cm, 0.3 degrees.
inline PanelPrediction predictionNear(const Pose& truth, Random& random) {
  PanelPrediction prediction;
  prediction.T_camera_panel = {truth.rotation * expSO3<double>(radians(0.3) * random.normal3()),
                               truth.position + 0.01 * random.normal3()};
  prediction.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 2.7e-5, 2.7e-5, 2.7e-5;
  prediction.margin_px = 4;
  return prediction;
}

struct PredictedViews {
  PanelMap map = readPanelMap(kDexrovMap);
  Vehicle vehicle = readVehicle(kConfig / "rov.yaml");
  std::vector<cv::Mat> images;
  std::vector<PanelPrediction> predictions;

  /// 1.6 to 3.5 m away. water: "clear", "turbid", … of config/.
  PredictedViews(const std::string& water, std::uint64_t count) {
    const ViewStudio studio(map, vehicle, readEnvironment(kConfig / ("water_" + water + ".yaml")));
    ViewRanges ranges;
    ranges.nearest_m = 1.6;
    ranges.farthest_m = 3.5;
    ranges.largest_tilt_rad = 0.5;
    Random random(1);
    for (std::uint64_t i = 0; i < count; ++i) {
      const CameraView view = drawView(ranges, 1, i);
      images.push_back(studio.image(view, 1));
      predictions.push_back(predictionNear(view.T_panel_camera().inverse(), random));
    }
  }
  std::unique_ptr<Detector> detector(Backend backend, const DetectorOptions& options = {}) const {
    std::vector<std::string> families;
    for (const Marker& marker : map.markers) families.push_back(marker.family);
    return makeDetector(backend, families, options);
  }
};

}  // namespace fathom::test
