#include "environment/water_scores.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "imaging/image_model.h"

namespace fathom {
namespace {

constexpr double kNormal95 = 1.96;

std::vector<double> valuesOf(const WaterCandidate& candidate, double WaterScore::*measure) {
  std::vector<double> values;
  for (const WaterScore& score : candidate.scores) values.push_back(score.*measure);
  return values;
}

/// The logarithm of the factor by which the simulated light on the panels is too small.
double logGainOf(const cv::Mat& recorded, const cv::Mat& simulated, const cv::Mat& mask) {
  const cv::Mat product = recorded.mul(simulated), square = simulated.mul(simulated);
  const cv::Scalar above = cv::mean(product, mask), below = cv::mean(square, mask);
  return std::log((above[0] + above[1] + above[2]) / (below[0] + below[1] + below[2]));
}

}  // namespace

MeanScore meanOf(const std::vector<double>& values) {
  double sum = 0, squares = 0;
  std::size_t count = 0;
  for (const double value : values)
    if (std::isfinite(value)) sum += value, squares += value * value, ++count;
  if (count == 0) return {};
  const double n = static_cast<double>(count), mean = sum / n;
  const double variance = count > 1 ? std::max(0.0, squares / n - mean * mean) * n / (n - 1) : 0;
  return {count, mean, kNormal95 * std::sqrt(variance / n)};
}

MeanScore meanScore(const WaterCandidate& candidate, double WaterScore::*measure) {
  return meanOf(valuesOf(candidate, measure));
}

MeanScore meanDifference(const WaterCandidate& a, const WaterCandidate& b, double WaterScore::*measure) {
  std::vector<double> differences = valuesOf(a, measure);
  const std::vector<double> others = valuesOf(b, measure);
  for (std::size_t i = 0; i < differences.size(); ++i) differences[i] -= others[i];
  return meanOf(differences);
}

ImagePair comparedPair(const PairMaker& maker, const CleanPair& pair, const cv::Mat& simulated) {
  ImagePair images;
  images.recorded = pair.recorded;
  images.simulated = simulated;
  images.panel_mask = pair.panel_mask;
  images.camera = &maker.camera();
  return maker.compared(images);
}

std::vector<WaterScore> scoreImage(const PairMaker& maker, const WaterCamera& camera,
                                   const FsimComparer& fsim, const PosedImage& posed, const CleanPair& pair,
                                   const std::vector<Environment>& waters, bool fit_gain) {
  std::vector<WaterScore> scores;
  const cv::Mat recorded_light = radianceOf(pair.recorded, camera.sheet());
  const double panel_pixels = cv::countNonZero(pair.panel_mask);
  for (const Environment& water : waters) {
    cv::Mat simulated = camera.image(posed, pair.clean, water);
    if (fit_gain) {
      const double log_gain =
          logGainOf(recorded_light, radianceOf(simulated, camera.sheet()), pair.panel_mask);
      simulated = camera.image(posed, pair.clean, water, log_gain);
    }
    WaterScore score;
    const double distance =
        cv::norm(recorded_light, radianceOf(simulated, camera.sheet()), cv::NORM_L2, pair.panel_mask);
    score.rmse = distance / std::sqrt(3 * panel_pixels);
    const ImagePair compared = comparedPair(maker, pair, simulated);
    if (const auto alike = fsim.compare(compared.recorded, compared.simulated)) {
      score.fsim = alike->fsim;
      score.fsimc = alike->fsimc;
    }
    scores.push_back(score);
  }
  return scores;
}

std::size_t recommended(const std::vector<WaterCandidate>& candidates, std::size_t eligible) {
  std::size_t best = 0;
  const auto mean = [&](std::size_t i, double WaterScore::*measure) {
    return meanScore(candidates[i], measure).mean;
  };
  for (std::size_t i = 1; i < eligible; ++i)
    if (mean(i, &WaterScore::rmse) < mean(best, &WaterScore::rmse)) best = i;
  std::size_t choice = best;
  for (std::size_t i = 0; i < eligible; ++i) {
    const MeanScore behind = meanDifference(candidates[i], candidates[best], &WaterScore::rmse);
    const bool not_told = behind.mean <= behind.half_width;
    if (not_told && mean(i, &WaterScore::fsim) > mean(choice, &WaterScore::fsim)) choice = i;
  }
  return choice;
}

}  // namespace fathom
