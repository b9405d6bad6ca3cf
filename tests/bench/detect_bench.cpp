// Search of the whole image beside search where a predicted panel must show, in one run: time, ratio, markers
// found. Rendered views of the shipped dexrov panel, through clear and through turbid water.
#include <cstdio>

#include "predicted_views.h"
#include "support/stopwatch.h"

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
    const double took_s = test::seconds([&] {
      for (std::size_t i = 0; i < images.size(); ++i) found += search(i).size();
    });
    tally = {std::min(tally.seconds, took_s), found};
  }
  return tally;
}

void compare(Backend backend, Preprocess preprocess, const std::string& water) {
  const test::PredictedViews views(water, kViews);
  DetectorOptions options;
  options.preprocess = preprocess;
  const auto detector = views.detector(backend, options);
  const Tally whole = timed(views.images, [&](std::size_t i) { return detector->detect(views.images[i]); });
  const Tally predicted = timed(views.images, [&](std::size_t i) {
    return detectPredicted(*detector, views.images[i], views.map, views.vehicle.camera->model,
                           views.predictions[i]);
  });
  std::printf("%-8s %-7s %-6s  whole image %6.2f ms (%3zu markers)  predicted %6.2f ms (%3zu)  ratio %5.2f\n",
              std::string(nameOf(backend)).c_str(), std::string(nameOf(preprocess)).c_str(), water.c_str(),
              1e3 * whole.seconds / kViews, whole.found, 1e3 * predicted.seconds / kViews, predicted.found,
              whole.seconds / predicted.seconds);
}

}  // namespace

int main() {
  cv::setNumThreads(1);  // images, not parts of one, go to threads
  for (const Backend backend : {Backend::aruco, Backend::apriltag})
    for (const Preprocess preprocess : {Preprocess::none, Preprocess::clahe})
      for (const char* water : {"clear", "turbid"}) compare(backend, preprocess, water);
  return 0;
}
