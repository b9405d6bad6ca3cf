// Search of the whole image beside search where a predicted panel must show, in one run: time, ratio, markers
// found. Views of the shipped dexrov panel through clear water, drawn marker by marker.
#include <chrono>
#include <cstdio>
#include <vector>

#include "fiducials/predicted_search.h"
#include "panel/panel_map.h"
#include "support/marker_images.h"

using namespace fathom;

namespace {

constexpr int kViews = 12, kRounds = 9;

struct Tally {
  double seconds = 0;
  std::size_t found = 0;
};

template <class Search>
Tally timed(const std::vector<cv::Mat>& images, Search&& search) {
  Tally tally{1e9, 0};
  for (int round = 0; round < kRounds; ++round) {
    std::size_t found = 0;
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t i = 0; i < images.size(); ++i) found += search(i).size();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    tally = {std::min(tally.seconds, seconds), found};
  }
  return tally;
}

void compare(Backend backend, Preprocess preprocess, double noise_sigma, const PanelMap& map) {
  const CameraModel camera;
  Random random(1);
  test::Look look;
  look.noise_sigma = noise_sigma;
  look.black = 60;
  look.white = 150;
  look.background = 130;
  std::vector<cv::Mat> images;
  std::vector<PanelPrediction> predictions;
  for (int i = 0; i < kViews; ++i) {
    const Pose truth = test::lookingAtPanel(random.uniform(1.6, 3.5), random.uniform(0, 0.5),
                                            random.uniform(0, 6.28), random.uniform(-0.2, 0.2));
    images.push_back(test::drawMarkers(map.markers, camera, truth, look, random));
    PanelPrediction prediction;  // a filter's: 1 cm, 0.3 degrees
    prediction.T_camera_panel = {truth.rotation * expSO3<double>(radians(0.3) * random.normal3()),
                                 truth.position + 0.01 * random.normal3()};
    prediction.covariance.diagonal() << 1e-4, 1e-4, 1e-4, 2.7e-5, 2.7e-5, 2.7e-5;
    prediction.margin_px = 4;
    predictions.push_back(prediction);
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
  std::printf(
      "%-8s %-7s noise %.0f  whole image %6.2f ms (%3zu markers)  predicted %6.2f ms (%3zu)  ratio %5.2f\n",
      std::string(nameOf(backend)).c_str(), std::string(nameOf(preprocess)).c_str(), noise_sigma,
      1e3 * whole.seconds / kViews, whole.found, 1e3 * predicted.seconds / kViews, predicted.found,
      whole.seconds / predicted.seconds);
}

}  // namespace

int main() {
  cv::setNumThreads(1);  // images, not parts of one, go to threads
  const PanelMap map = readPanelMap(std::string(FATHOM_SOURCE_DIR) + "/maps/dexrov/panel.yaml");
  for (const Backend backend : {Backend::aruco, Backend::apriltag})
    for (const Preprocess preprocess : {Preprocess::none, Preprocess::clahe})
      for (const double noise_sigma : {1.0, 4.0}) compare(backend, preprocess, noise_sigma, map);
  return 0;
}
