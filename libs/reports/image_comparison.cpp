#include "reports/image_comparison.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/stable_sort.h"
#include "effects/drawn.h"
#include "imaging/exposure_time.h"
#include "sil/pair_maker.h"
#include "similarity/measures.h"

namespace fathom {
namespace {

std::string png(const cv::Mat& image) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", image, bytes);
  return {bytes.begin(), bytes.end()};
}

/// Recorded less simulated, mean over the colours, a pixel's noise smoothed away; zero where nothing is
/// compared.
cv::Mat differenceOf(const ImagePair& pair, const cv::Mat& region) {
  constexpr int kSmooth_px = 5;
  cv::Mat recorded, simulated, difference;
  pair.recorded.convertTo(recorded, CV_32FC3);
  pair.simulated.convertTo(simulated, CV_32FC3);
  cv::transform(recorded - simulated, difference, cv::Matx13f(1 / 3.f, 1 / 3.f, 1 / 3.f));
  difference.setTo(0, region == 0);
  cv::blur(difference, difference, {kSmooth_px, kSmooth_px});
  return difference;
}

/// What all but one in a hundred of the pixels compared stay under; at least one digital number.
double scaleOf(const cv::Mat& difference, const cv::Mat& region) {
  std::vector<float> sizes;
  for (int row = 0; row < difference.rows; ++row)
    for (int column = 0; column < difference.cols; ++column)
      if (region.at<std::uint8_t>(row, column) != 0)
        sizes.push_back(std::abs(difference.at<float>(row, column)));
  if (sizes.empty()) return 1;
  const auto rank = sizes.begin() + std::ssize(sizes) * 99 / 100;
  std::nth_element(sizes.begin(), rank, sizes.end());
  return std::max(1.0, static_cast<double>(*rank));
}

/// White for no difference, gray where nothing is compared.
cv::Mat coloured(const cv::Mat& difference, const cv::Mat& region, double scale) {
  cv::Mat picture(difference.size(), CV_8UC3, cv::Scalar(160, 160, 160));
  for (int row = 0; row < picture.rows; ++row)
    for (int column = 0; column < picture.cols; ++column) {
      if (region.at<std::uint8_t>(row, column) == 0) continue;
      const double size = std::clamp(difference.at<float>(row, column) / scale, -1.0, 1.0);
      const auto faded = cv::saturate_cast<std::uint8_t>(255 * (1 - std::abs(size)));
      picture.at<cv::Vec3b>(row, column) =
          size > 0 ? cv::Vec3b(faded, faded, 255) : cv::Vec3b(255, faded, faded);
    }
  return picture;
}

/// Effects with what the estimate has found drawn for an image.
EffectParameters<double> withDraws(const EffectParameters<double>& effects, const BatchState& state,
                                   std::size_t image) {
  EffectParameters<double> own = withoutDraws(effects);
  for (const auto& [draw, value] : state.draws)
    if (draw.image == image) own.values[draw.scalar] = value;
  return own;
}

/// A model of the world, and each image as its markers pose it there.
class Simulated {
 public:
  Simulated(const BatchRecording& recording, const BatchEstimate& estimate,
            const EffectParameters<double>& effects)
      : maker_({recording.input.data.vehicle,
                recording.input.data.panels,
                environmentOf(estimate.state.water),
                effects,
                {}},
               {}, settingsFor(recording.input.data.panels, Backend::apriltag)) {
    const BatchData& data = recording.input.data;
    const LandmarkCalibration calibration{effects, data.time_zero};
    const FoundMarkers& found = recording.found;
    images_ = posedImages(found.entries, found.detections,
                          solveSightings(found.entries, found.detections, data.panels, calibration),
                          data.panels, calibration);
    for (PosedImage& image : images_.posed) image.effects = withDraws(effects, estimate.state, image.entry);
  }

  const std::vector<PosedImage>& posed() const { return images_.posed; }
  /// Nothing where the image's pose is not its own, or it cannot be rendered.
  std::optional<SilPair> pairOf(std::size_t number) const {
    const auto at = std::find_if(posed().begin(), posed().end(),
                                 [&](const PosedImage& image) { return image.number == number; });
    if (at == posed().end()) return {};
    try {
      return maker_.make(*at);
    } catch (const Error&) {
      return {};
    }
  }

  cv::Mat regionOf(const SilPair& pair) const { return maker_.comparedRegion(pair.images); }

  SimulatedImage describe(const SilPair& pair, double scale) const {
    constexpr double kFullScale_dn = 255;
    const cv::Mat region = regionOf(pair);
    SimulatedImage result;
    result.png = png(pair.images.simulated);
    result.difference_png = png(coloured(differenceOf(pair.images, region), region, scale));
    const std::vector<Measurement> measured =
        PairMeasurer({"fsim", "rmse-linear"}).measure(maker_.compared(pair.images));
    const auto first = [](const Measurement& m) {
      return m.outcome.values.empty() ? std::optional<double>() : m.outcome.values[0];
    };
    result.fsim = first(measured[0]);
    if (const auto rmse = first(measured[1])) result.rmse_dn = kFullScale_dn * *rmse;
    return result;
  }

 private:
  PairMaker maker_;
  PosedImages images_;
};

/// Of images in the order of their ranges the first that can be simulated, the last, and one between.
std::vector<std::size_t> chosenOf(const Simulated& simulated, const std::vector<PanelMap>& panels) {
  std::vector<const PosedImage*> order;
  for (const PosedImage& image : simulated.posed()) order.push_back(&image);
  stableSort(order, [&](const PosedImage* a, const PosedImage* b) {
    return range_m(*a, panels) < range_m(*b, panels);
  });
  std::vector<std::size_t> chosen;
  const auto choose = [&](auto first, auto last) {
    const auto at =
        std::find_if(first, last, [&](const PosedImage* image) { return simulated.pairOf(image->number); });
    if (at != last && std::find(chosen.begin(), chosen.end(), (*at)->number) == chosen.end())
      chosen.push_back((*at)->number);
  };
  choose(order.begin(), order.end());
  choose(order.begin() + std::ssize(order) / 2, order.end());
  choose(order.rbegin(), order.rend());
  return chosen;
}

}  // namespace

std::vector<ComparedImage> compareImages(const BatchRecording& recording, const Diagnosis& diagnosis,
                                         const EffectParameters<double>& known) {
  const BatchData& data = recording.input.data;
  if (data.patches.empty() || !diagnosis.before.succeeded) return {};
  const Simulated before(recording, diagnosis.before, known);
  const EffectParameters<double> found =
      wholeOf(diagnosis.after.state.effects, statedExposure_s(data.vehicle));
  std::optional<Simulated> after;
  if (found.on != known.on) after.emplace(recording, diagnosis.after, found);
  std::vector<ComparedImage> compared;
  for (const std::size_t number : chosenOf(before, data.panels)) {
    const auto pair = before.pairOf(number);
    const cv::Mat region = before.regionOf(*pair);
    ComparedImage image;
    image.range_m = pair->range_m;
    for (const PosedImage& posed : before.posed())
      if (posed.number == number) image.name = posed.image.file.filename().string();
    image.recorded_png = png(pair->images.recorded);
    image.scale_dn = scaleOf(differenceOf(pair->images, region), region);
    image.before = before.describe(*pair, image.scale_dn);
    if (const auto again = after ? after->pairOf(number) : std::nullopt)
      image.after = after->describe(*again, image.scale_dn);
    compared.push_back(std::move(image));
  }
  return compared;
}

}  // namespace fathom
