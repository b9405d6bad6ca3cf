#include "handles/handle_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

// What resampling and the renderer's samples leave, by the reach: as measured over 400 views, 1 to 4 m away.
constexpr double kLattice_px = 0.17;
constexpr double kLargestSigma_rad = radians(4);
constexpr double kFar_rad = radians(15);  // by which the two ways contradict each other
constexpr double kClearMatch = 25;        // support from which on the match needs no one else
// JPEG's blocks move edges in ways that a rendering knows nothing of: by so much, as measured on the trial
// (quality 60), where two blocks of colour go across a handle; where they do not, by anything.
constexpr double kJpegLattice_px = 0.8, kLeastOfJpeg_px = 32;
constexpr double kMostSaturated = 0.25;  // share of the box
constexpr double kSaturated = 0.995;

/// Empty where an image can be read at all.
std::string complaintAbout(const FrontView& view) {
  int saturated = 0, pixels = 0;
  double least = 1, most = 0;
  for (int row = 0; row < view.light.rows; ++row)
    for (int column = 0; column < view.light.cols; ++column) {
      if (view.in_reach.at<uchar>(row, column) == 0) continue;
      const auto& v = view.light.at<cv::Vec3f>(row, column);
      const double brightest = std::max({v[0], v[1], v[2]});
      ++pixels;
      if (brightest >= kSaturated) ++saturated;
      least = std::min(least, brightest);
      most = std::max(most, brightest);
    }
  if (saturated > kMostSaturated * pixels) return "saturated";
  if (most < 0.01) return "black";
  return {};
}

}  // namespace

HandleReader::HandleReader(HandleScene scene) : map_(scene.map), matcher_(std::move(scene)) {}

std::vector<HandleReading> HandleReader::read(const PosedPanelImage& image) {
  std::vector<HandleReading> readings;
  for (std::size_t handle = 0; handle < map_.handles.size(); ++handle)
    readings.push_back(read(image, handle));
  return readings;
}

HandleReading HandleReader::read(const PosedPanelImage& image, std::size_t index) {
  const Handle& handle = map_.handles.at(index);
  HandleReading reading;
  reading.handle = index;
  reading.disagreement_rad = std::numeric_limits<double>::quiet_NaN();
  reading.view = frontViewOf(image, handle);
  reading.why_not = reading.view.why_not;
  if (reading.why_not.empty()) reading.why_not = complaintAbout(reading.view);
  if (!reading.why_not.empty()) return reading;

  const double reach_px = sweptBoxOf(handle).reach_m / reading.view.m_per_px * reading.view.image_px;
  if (image.is_jpeg && 2 * reach_px < kLeastOfJpeg_px) reading.why_not = "too small for JPEG's blocks";
  if (!reading.why_not.empty()) return reading;

  reading.contour = contourOf(reading.view);
  reading.edge = readStraightEdge(reading.view, reading.contour, handle);
  reading.match = matcher_.match(image, index);
  reading.angle_rad = reading.match.angle_rad;
  reading.sigma_rad =
      std::hypot(reading.match.sigma_rad, (image.is_jpeg ? kJpegLattice_px : kLattice_px) / reach_px);
  if (reading.edge.found)
    reading.disagreement_rad =
        std::abs(angleDifference(reading.edge.angle_rad, reading.match.angle_rad, reading.edge.symmetry_rad));
  const bool agree = reading.disagreement_rad <= kFar_rad;
  reading.why_not = reading.match.why_not;
  if (reading.match.found && reading.sigma_rad > kLargestSigma_rad)
    reading.why_not = "not to be told to 4 degrees";
  if (reading.why_not.empty() && !agree && reading.match.support < kClearMatch)
    reading.why_not =
        reading.edge.found ? "edges and matching contradict each other" : "no straight edge bears it out";
  reading.confident = reading.why_not.empty();
  return reading;
}

}  // namespace fathom
