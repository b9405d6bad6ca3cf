// Search of the whole image beside search where a predicted panel must show, in one run: time, ratio, markers
// found. Rendered views of the shipped dexrov panel, through clear and through turbid water.
#include <cstdio>
#include <vector>

#include "core/random.h"
#include "evaluation/views.h"
#include "fiducials/predicted_search.h"
#include "panel/panel_map.h"
#include "sensors/vehicle.h"
#include "sensors/water.h"
#include "support/stopwatch.h"

using namespace fathom;

namespace {

constexpr int kViews = 12, kRounds = 9;
const std::string kSource = FATHOM_SOURCE_DIR;

struct Tally {
  double seconds = 0;
  std::size_t found = 0;
};

template <class Search>
Tally timed(const std::vector<cv::Mat>& images, Search&& search) {
  Tally tally{1e9, 0};
  for (int round = 0; round < kRounds; ++round) {
    std::size_t found = 0;
    const double took_s = test::seconds([&] {
      for (std::size_t i = 0; i < images.size(); ++i) found += search(i).size();
    });
    tally = {std::min(tally.seconds, took_s), found};
  }
  return tally;
}

/// A filter's: 1 cm, 0.3 degrees.
PanelPrediction predictionNear(const Pose& truth, Random& random) {
  PanelPrediction prediction;
  prediction.T_camera_panel = {truth.rotation * expSO3<double>(radians(0.3) * random.normal3()),
                               truth.position + 0.01 * random.normal3()};
  prediction.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 2.7e-5, 2.7e-5, 2.7e-5;
  prediction.margin_px = 4;
  return prediction;
}

void compare(Backend backend, Preprocess preprocess, const std::string& water, const PanelMap& map,
             const Vehicle& vehicle) {
  const CameraModel& camera = vehicle.camera->model;
  const ViewStudio studio(map, vehicle, readEnvironment(kSource + "/config/water_" + water + ".yaml"));
  ViewRanges ranges;
  ranges.nearest_m = 1.6;
  ranges.farthest_m = 3.5;
  ranges.largest_tilt_rad = 0.5;
  Random random(1);
  std::vector<cv::Mat> images;
  std::vector<PanelPrediction> predictions;
  for (std::uint64_t i = 0; i < kViews; ++i) {
    const CameraView view = drawView(ranges, 1, i);
    images.push_back(studio.image(view, 1));
    predictions.push_back(predictionNear(view.T_panel_camera().inverse(), random));
  }
  std::vector<std::string> families;
  for (const Marker& marker : map.markers) families.push_back(marker.family);
  DetectorOptions options;
  options.preprocess = preprocess;
  const auto detector = makeDetector(backend, families, options);
  const Tally whole = timed(images, [&](std::size_t i) { return detector->detect(images[i]); });
  const Tally predicted = timed(images, [&](std::size_t i) {
    return detectPredicted(*detector, images[i], map, camera, predictions[i]);
  });
  std::printf("%-8s %-7s %-6s  whole image %6.2f ms (%3zu markers)  predicted %6.2f ms (%3zu)  ratio %5.2f\n",
              std::string(nameOf(backend)).c_str(), std::string(nameOf(preprocess)).c_str(), water.c_str(),
              1e3 * whole.seconds / kViews, whole.found, 1e3 * predicted.seconds / kViews, predicted.found,
              whole.seconds / predicted.seconds);
}

}  // namespace

int main() {
  cv::setNumThreads(1);  // images, not parts of one, go to threads
  const PanelMap map = readPanelMap(kSource + "/maps/dexrov/panel.yaml");
  const Vehicle vehicle = readVehicle(kSource + "/config/rov.yaml");
  for (const Backend backend : {Backend::aruco, Backend::apriltag})
    for (const Preprocess preprocess : {Preprocess::none, Preprocess::clahe})
      for (const char* water : {"clear", "turbid"}) compare(backend, preprocess, water, map, vehicle);
  return 0;
}
