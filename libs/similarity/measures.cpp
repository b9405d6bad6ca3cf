#include "similarity/measures.h"

#include <cstdint>

#include "core/error.h"

namespace fathom {
namespace {

constexpr double kLeastUnsaturated = 0.01;  // of an image's pixels

bool isSaturated(const cv::Mat& bgr) {
  const auto atAnEnd = [](std::uint8_t value) { return value == 0 || value == 255; };
  std::int64_t inside = 0;
  for (int v = 0; v < bgr.rows; ++v) {
    const auto* row = bgr.ptr<cv::Vec3b>(v);
    for (int u = 0; u < bgr.cols; ++u)
      inside += !(atAnEnd(row[u][0]) && atAnEnd(row[u][1]) && atAnEnd(row[u][2]));
  }
  return static_cast<double>(inside) < kLeastUnsaturated * static_cast<double>(bgr.total());
}

std::string whyUnusable(const cv::Mat& image, const std::string& name) {
  if (image.empty()) return "the " + name + " image is empty";
  if (image.type() != CV_8UC3) return "the " + name + " image is not of three channels of 8 bits";
  if (isSaturated(image)) return "the " + name + " image is saturated: nearly all of it is black or white";
  return "";
}

std::string pixelSize(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows);
}

const RegisteredMeasure& measureNamed(const std::string& id) {
  std::string known;
  for (const auto& measure : kMeasures) {
    if (measure.id == id) return measure;
    known += (known.empty() ? "" : ", ") + std::string(measure.id);
  }
  throw Error("measures", id, "no such measure; there are " + known);
}

}  // namespace

std::string whyNotComparable(const ImagePair& pair) {
  if (auto why = whyUnusable(pair.recorded, "recorded"); !why.empty()) return why;
  if (auto why = whyUnusable(pair.simulated, "simulated"); !why.empty()) return why;
  if (pair.recorded.size() != pair.simulated.size())
    return "the recorded image is of " + pixelSize(pair.recorded) + " pixels, the simulated one of " +
           pixelSize(pair.simulated);
  return "";
}

PairMeasurer::PairMeasurer() {
  for (const auto& measure : kMeasures) measures_.push_back(&measure);
}

PairMeasurer::PairMeasurer(const std::vector<std::string>& ids) {
  for (const auto& id : ids) {
    const auto* measure = &measureNamed(id);
    for (const auto* other : measures_)
      if (other == measure) throw Error("measures", id, "this measure is there twice");
    measures_.push_back(measure);
  }
}

std::vector<Measurement> PairMeasurer::measure(const ImagePair& pair) const {
  const std::string why_not = whyNotComparable(pair);
  const PairView view(pair, comparer_);
  std::vector<Measurement> measurements;
  for (const auto* measure : measures_)
    measurements.push_back({measure, why_not.empty() ? measure->measure(view) : notMeasured(why_not)});
  return measurements;
}

}  // namespace fathom
