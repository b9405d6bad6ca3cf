#include "handles/evidence_picture.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "imaging/eight_bits.h"

namespace fathom {
namespace {

constexpr int kTile_px = 240, kTitle_px = 28;
const cv::Scalar kContour(255, 0, 255), kShape(255, 255, 255), kEdge(0, 0, 255);

cv::Mat enlarged(const cv::Mat& picture, int interpolation = cv::INTER_NEAREST) {
  cv::Mat tile(kTile_px, kTile_px, CV_8UC3, cv::Scalar(40, 40, 40));
  if (!picture.empty()) cv::resize(picture, tile, tile.size(), 0, 0, interpolation);
  return tile;
}

/// The darkest and the brightest of some light: through turbid water they are close to each other.
struct Exposure {
  double darkest = 0, brightest = 1;

  static Exposure of(const cv::Mat& light) {
    Exposure exposure;
    if (!light.empty()) cv::minMaxLoc(light.reshape(1), &exposure.darkest, &exposure.brightest);
    return exposure;
  }
  /// Linear light for the eye.
  cv::Mat shown(const cv::Mat& light) const {
    if (light.empty()) return {};
    cv::Mat picture = (light - cv::Scalar::all(darkest)) / std::max(1e-6, brightest - darkest);
    cv::pow(cv::max(picture, 0), 1 / 2.2, picture);
    picture.convertTo(picture, CV_8UC3, 255);
    cv::cvtColor(picture, picture, cv::COLOR_RGB2BGR);
    return picture;
  }
};

cv::Mat wholeImage(const cv::Mat& image_bgr, const cv::Rect& region) {
  cv::Mat picture = inEightBits(image_bgr).clone();
  if (picture.channels() == 1) cv::cvtColor(picture, picture, cv::COLOR_GRAY2BGR);
  if (!region.empty()) cv::rectangle(picture, region, kContour, 2);
  cv::Mat tile;
  cv::resize(picture, tile, {kTile_px * picture.cols / picture.rows, kTile_px}, 0, 0, cv::INTER_AREA);
  return tile;
}

cv::Point onTile(const Vector2d& pixel, double scale) {
  return {cvRound((pixel.x() + 0.5) * scale), cvRound((pixel.y() + 0.5) * scale)};
}

void drawOutline(const cv::Mat& mask, const cv::Scalar& colour, cv::Mat& tile) {
  cv::Mat large;
  cv::resize(mask, large, tile.size(), 0, 0, cv::INTER_NEAREST);
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(large, outlines, cv::RETR_LIST, cv::CHAIN_APPROX_NONE);
  cv::drawContours(tile, outlines, -1, colour, 1);
}

cv::Mat contourTile(const HandleReading& reading, const Exposure& exposure) {
  cv::Mat tile = enlarged(exposure.shown(reading.view.light));
  if (!reading.contour.found) return tile;
  drawOutline(reading.contour.shape.drawn(reading.view.light.size()) > 0.5, kShape, tile);
  drawOutline(reading.contour.mask, kContour, tile);
  return tile;
}

cv::Mat edgeTile(const HandleReading& reading) {
  cv::Mat edges;
  if (!reading.edge.edges.empty()) cv::cvtColor(reading.edge.edges, edges, cv::COLOR_GRAY2BGR);
  cv::Mat tile = enlarged(edges);
  if (!reading.edge.found) return tile;
  const double scale = static_cast<double>(kTile_px) / reading.view.light.rows;
  cv::line(tile, onTile(reading.edge.edge.from_px, scale), onTile(reading.edge.edge.to_px, scale), kEdge, 2);
  return tile;
}

}  // namespace

cv::Mat evidencePicture(const cv::Mat& image_bgr, const HandleReading& reading, const std::string& title) {
  const Exposure front = Exposure::of(reading.view.light), close = Exposure::of(reading.match.seen);
  cv::Mat row;
  cv::hconcat(std::vector<cv::Mat>{wholeImage(image_bgr, reading.view.region_px),
                                   enlarged(front.shown(reading.view.light)), contourTile(reading, front),
                                   edgeTile(reading), enlarged(close.shown(reading.match.seen)),
                                   enlarged(close.shown(reading.match.simulated))},
              row);
  cv::Mat picture;
  cv::copyMakeBorder(row, picture, kTitle_px, 0, 0, 0, cv::BORDER_CONSTANT, cv::Scalar(255, 255, 255));
  cv::putText(picture, title, {8, kTitle_px - 9}, cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(0, 0, 0), 1,
              cv::LINE_AA);
  return picture;
}

}  // namespace fathom
