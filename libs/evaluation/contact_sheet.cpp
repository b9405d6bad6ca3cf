#include "evaluation/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "core/text.h"

namespace fathom {
namespace {

const cv::Scalar kPaper(255, 255, 255), kInk(30, 30, 30);
const cv::Scalar kFound(60, 220, 60), kWrong(40, 40, 255), kMissed(0, 165, 255), kSeen(255, 170, 60);  // BGR
constexpr int kLabelWidth_px = 250, kLineHeight_px = 26, kGap_px = 6;

void write(cv::Mat& image, const std::string& text, cv::Point baseline, double scale = 0.55) {
  cv::putText(image, text, baseline, cv::FONT_HERSHEY_SIMPLEX, scale, kInk, 1, cv::LINE_AA);
}

cv::Mat brightened(const cv::Mat& image) {
  cv::Mat table(1, 256, CV_8U), result;
  for (int i = 0; i < 256; ++i)
    table.at<unsigned char>(i) = cv::saturate_cast<unsigned char>(255.0 * std::pow(i / 255.0, 1 / 2.2));
  cv::LUT(image, table, result);
  if (result.channels() == 1) cv::cvtColor(result, result, cv::COLOR_GRAY2BGR);
  return result;
}

void outline(cv::Mat& image, const std::array<Vector2d, 4>& corners_px, double scale,
             const cv::Scalar& colour) {
  constexpr int kFraction = 4;  // bits of a pixel
  std::vector<cv::Point> points;
  for (const Vector2d& corner : corners_px) {
    const Vector2d scaled = (scale * (corner.array() + 0.5) - 0.5) * (1 << kFraction);
    points.emplace_back(static_cast<int>(std::lround(scaled.x())), static_cast<int>(std::lround(scaled.y())));
  }
  const bool small = scale * (corners_px[0] - corners_px[2]).norm() < 30;
  cv::polylines(image, points, true, colour, small ? 1 : 2, cv::LINE_AA, kFraction);
}

/// Whether a detection is one of those that show a marker in its place.
bool isRight(const Detection& detection, const std::vector<MarkerPlace>& places, double tolerance_px) {
  return std::any_of(places.begin(), places.end(), [&](MarkerPlace place) {
    place.visible = true;
    return scoreDetections({detection}, {place}, tolerance_px).found == 1;
  });
}

bool isMissed(const MarkerPlace& place, const std::vector<Detection>& detections, double tolerance_px) {
  return place.visible && scoreDetections(detections, {place}, tolerance_px).found == 0;
}

}  // namespace

cv::Mat markedTile(const cv::Mat& image, const std::vector<Detection>& detections,
                   const std::vector<MarkerPlace>* places, double tolerance_px, int width_px) {
  const double scale = static_cast<double>(width_px) / image.cols;
  cv::Mat picture;
  cv::resize(brightened(image), picture, {width_px, static_cast<int>(std::lround(scale * image.rows))}, 0, 0,
             scale < 1 ? cv::INTER_AREA : cv::INTER_LINEAR);
  std::string caption = print("%zu detected", detections.size());
  if (places != nullptr) {
    for (const MarkerPlace& place : *places)
      if (isMissed(place, detections, tolerance_px)) outline(picture, place.corners_px, scale, kMissed);
    const ImageScore score = scoreDetections(detections, *places, tolerance_px);
    caption = print("%d of %d found", score.found, score.visible);
    if (score.wrong > 0) caption += print(", %d false", score.wrong);
  }
  for (const Detection& detection : detections) {
    const cv::Scalar& colour = places == nullptr                           ? kSeen
                               : isRight(detection, *places, tolerance_px) ? kFound
                                                                           : kWrong;
    outline(picture, detection.corners_px, scale, colour);
  }
  cv::Mat tile(picture.rows + kLineHeight_px, width_px, CV_8UC3, kPaper);
  picture.copyTo(tile.rowRange(0, picture.rows));
  write(tile, caption, {2, picture.rows + 19}, 0.5);
  return tile;
}

cv::Mat contactSheet(const std::string& title, const std::vector<std::string>& column_labels,
                     const std::vector<SheetRow>& rows) {
  cv::Size tile(0, 0);
  for (const SheetRow& row : rows)
    for (const cv::Mat& image : row.tiles)
      tile = {std::max(tile.width, image.cols), std::max(tile.height, image.rows)};
  const int columns = static_cast<int>(column_labels.size()), top = 2 * kLineHeight_px + kGap_px;
  cv::Mat sheet(top + static_cast<int>(rows.size()) * (tile.height + kGap_px),
                kLabelWidth_px + columns * (tile.width + kGap_px), CV_8UC3, kPaper);
  write(sheet, title, {kGap_px, 19}, 0.6);
  const auto left = [&](std::size_t column) {
    return kLabelWidth_px + static_cast<int>(column) * (tile.width + kGap_px);
  };
  for (std::size_t c = 0; c < column_labels.size(); ++c)
    write(sheet, column_labels[c], {left(c) + 2, kLineHeight_px + 19});
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const int y = top + static_cast<int>(r) * (tile.height + kGap_px);
    for (std::size_t i = 0; i < rows[r].label.size(); ++i)
      write(sheet, rows[r].label[i], {kGap_px, y + 19 + static_cast<int>(i) * kLineHeight_px});
    for (std::size_t c = 0; c < rows[r].tiles.size(); ++c)
      rows[r].tiles[c].copyTo(sheet(cv::Rect({left(c), y}, rows[r].tiles[c].size())));
  }
  return sheet;
}

}  // namespace fathom
