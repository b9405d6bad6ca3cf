#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <opencv2/aruco.hpp>

#include "fiducials/marker_reader.h"
#include "panel/marker_family.h"

namespace fathom {
namespace {

/// OpenCV's error correction rate: the share of the correctable bits that it forgives.
constexpr double kCorrectionRate = 0.6;
/// Of a corner coordinate: whole pixels of a contour, which lies inside the edge.
constexpr double kArucoSigma_px = 0.7;

/// How likely a random word is taken for a code: a square of something else should not often be.
constexpr double kLargestChance = 0.01;

/// Cells that carry the code; tag families name their number.
int codeBits(const std::string& family) {
  if (family.starts_with("tag")) {
    const auto first = family.find_first_of("0123456789");
    return std::stoi(family.substr(first, family.find('h') - first));
  }
  const int side = markerPattern(family, 0).border_cells - 2;
  return side * side;
}

double chanceOfCode(const std::string& family, int corrected_bits) {
  const double n = codeBits(family);
  double neighbours = 1, words = 1;
  for (int k = 1; k <= corrected_bits; ++k) words += neighbours *= (n - k + 1) / k;
  return 4.0 * markerCount(family) * words * std::exp2(-n);
}

/// The family's code words as OpenCV keeps them. Made from the patterns, so that ids and what is upright are
/// the panel's, whatever either library thinks.
cv::Ptr<cv::aruco::Dictionary> dictionaryOf(const std::string& family, int corrected_bits) {
  const int bits = markerPattern(family, 0).border_cells - 2;
  cv::Mat codes;
  for (int id = 0; id < markerCount(family); ++id) {
    const MarkerPattern pattern = markerPattern(family, id);
    const int origin = (pattern.cells - bits) / 2;
    cv::Mat cells(bits, bits, CV_8UC1);
    for (int row = 0; row < bits; ++row)
      for (int column = 0; column < bits; ++column)
        cells.at<std::uint8_t>(row, column) = pattern.whiteAt(origin + row, origin + column) ? 1 : 0;
    codes.push_back(cv::aruco::Dictionary::getByteListFromBits(cells));
  }
  return cv::makePtr<cv::aruco::Dictionary>(codes, bits, corrected_bits);
}

class ArucoReader : public MarkerReader {
 public:
  ArucoReader(const std::vector<std::string>& families, int largest_corrected_bits, int border_width)
      : border_width_(border_width) {
    for (const auto& family : families)
      dictionaries_[family] = dictionaryOf(family, correctableBits(family, largest_corrected_bits));
  }

  std::vector<Detection> read(const cv::Mat& gray, double smallest_side_px) override {
    std::vector<Detection> detections;
    for (const auto& [family, dictionary] : dictionaries_) {
      std::vector<std::vector<cv::Point2f>> corners;
      std::vector<int> ids;
      cv::aruco::detectMarkers(gray, dictionary, corners, ids, parametersFor(gray, smallest_side_px));
      for (std::size_t i = 0; i < ids.size(); ++i)
        detections.push_back(detection(family, ids[i], corners[i]));
    }
    return detections;
  }

 private:
  /// Where sizes are known, one threshold window suffices and small contours need no look.
  cv::Ptr<cv::aruco::DetectorParameters> parametersFor(const cv::Mat& gray, double smallest_side_px) const {
    auto parameters = cv::aruco::DetectorParameters::create();
    parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
    parameters->markerBorderBits = border_width_;
    parameters->errorCorrectionRate = 1.0;  // the caution is in correctableBits()
    // The default takes the outline of a narrow quiet zone for the marker's own, and the larger one wins.
    parameters->minMarkerDistanceRate = 0.02;
    const double largest_side = std::max(gray.cols, gray.rows);
    const double smallest_perimeter = smallest_side_px > 0 ? 4.0 * 0.5 * smallest_side_px : 40.0;
    parameters->minMarkerPerimeterRate = smallest_perimeter / largest_side;
    if (smallest_side_px > 0)
      parameters->adaptiveThreshWinSizeMin = parameters->adaptiveThreshWinSizeMax = 15;
    return parameters;
  }

  static Detection detection(const std::string& family, int id, const std::vector<cv::Point2f>& corners) {
    Detection result;
    result.family = family;
    result.id = id;
    result.covariance_px2 *= kArucoSigma_px * kArucoSigma_px;
    for (std::size_t k = 0; k < 4; ++k) result.corners_px[k] = {corners[k].x, corners[k].y};
    return result;
  }

  int border_width_;
  std::map<std::string, cv::Ptr<cv::aruco::Dictionary>> dictionaries_;
};

}  // namespace

std::unique_ptr<MarkerReader> makeArucoReader(const std::vector<std::string>& families,
                                              int largest_corrected_bits, int border_width) {
  return std::make_unique<ArucoReader>(families, largest_corrected_bits, border_width);
}

int hammingDistance(const std::string& family) {
  if (!family.starts_with("DICT_")) return std::stoi(family.substr(family.find('h') + 1));
  if (family.starts_with("DICT_APRILTAG_")) return std::stoi(family.substr(family.find('h') + 1));
  // cv::aruco::PREDEFINED_DICTIONARY_NAME's comments, OpenCV 4.6.
  static const std::map<std::string, int> distances{
      {"DICT_4X4_50", 4},        {"DICT_4X4_100", 3},  {"DICT_4X4_250", 3},  {"DICT_4X4_1000", 2},
      {"DICT_5X5_50", 8},        {"DICT_5X5_100", 7},  {"DICT_5X5_250", 6},  {"DICT_5X5_1000", 5},
      {"DICT_6X6_50", 13},       {"DICT_6X6_100", 12}, {"DICT_6X6_250", 11}, {"DICT_6X6_1000", 9},
      {"DICT_7X7_50", 19},       {"DICT_7X7_100", 18}, {"DICT_7X7_250", 17}, {"DICT_7X7_1000", 14},
      {"DICT_ARUCO_ORIGINAL", 1}};
  return distances.at(family);
}

int correctableBits(const std::string& family, int largest) {
  const int unambiguous = (hammingDistance(family) - 1) / 2;
  int bits = std::clamp(static_cast<int>(kCorrectionRate * unambiguous), 0, largest);
  while (bits > 0 && chanceOfCode(family, bits) > kLargestChance) --bits;
  return bits;
}

}  // namespace fathom
