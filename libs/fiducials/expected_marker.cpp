#include "fiducials/expected_marker.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom {
namespace {

/// Cells this wide suffice to tell how far a marker is off; larger ones are scaled down to it.
constexpr double kComparableCell_px = 3.0;
constexpr double kSmallestCorrelation = 0.5;
constexpr double kReachSigmas = 3.0;

std::array<cv::Point2f, 4> toPoints(const std::array<Vector2d, 4>& corners) {
  std::array<cv::Point2f, 4> points;
  for (std::size_t k = 0; k < 4; ++k)
    points[k] = {static_cast<float>(corners[k].x()), static_cast<float>(corners[k].y())};
  return points;
}

/// From the border square's cells (x right, y down, 0 at its top left corner) to where its corners are.
cv::Matx33d cellsToPixels(const MarkerPattern& pattern, const std::array<Vector2d, 4>& corners) {
  const auto n = static_cast<float>(pattern.border_cells);
  const std::array<cv::Point2f, 4> square{cv::Point2f(0, 0), {n, 0}, {n, n}, {0, n}};
  return cv::getPerspectiveTransform(square.data(), toPoints(corners).data());
}

cv::Point2d transformed(const cv::Matx33d& H, double x, double y) {
  const cv::Vec3d p = H * cv::Vec3d(x, y, 1);
  return {p[0] / p[2], p[1] / p[2]};
}

/// Row and column count from the border square's top left cell; outside it all is white.
bool isWhite(const MarkerPattern& pattern, int row, int column) {
  const int n = pattern.border_cells, origin = (pattern.cells - n) / 2;
  if (std::min(row, column) < 0 || std::max(row, column) >= n) return true;
  return pattern.whiteAt(origin + row, origin + column);
}

/// The border square and a ring of white cells around it, a pixel each.
cv::Mat drawnCells(const MarkerPattern& pattern) {
  cv::Mat cells(pattern.border_cells + 2, pattern.border_cells + 2, CV_8UC1);
  for (int row = 0; row < cells.rows; ++row)
    for (int column = 0; column < cells.cols; ++column)
      cells.at<std::uint8_t>(row, column) = isWhite(pattern, row - 1, column - 1) ? 255 : 0;
  return cells;
}

/// What encloses the quadrangle, in whole pixels.
cv::Rect boundingBox(const std::array<cv::Point2d, 4>& corners) {
  cv::Point2d low = corners[0], high = corners[0];
  for (const auto& corner : corners) {
    low = {std::min(low.x, corner.x), std::min(low.y, corner.y)};
    high = {std::max(high.x, corner.x), std::max(high.y, corner.y)};
  }
  return {cv::Point(cvFloor(low.x), cvFloor(low.y)), cv::Point(cvCeil(high.x) + 1, cvCeil(high.y) + 1)};
}

/// Between pixels, linearly; the image goes on beyond its border as it is there.
double brightnessAt(const cv::Mat& gray, const cv::Point2d& place) {
  const double x = std::clamp(place.x, 0.0, gray.cols - 1.001);
  const double y = std::clamp(place.y, 0.0, gray.rows - 1.001);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double fx = x - column, fy = y - row;
  const auto* upper = gray.ptr<std::uint8_t>(row) + column;
  const auto* lower = gray.ptr<std::uint8_t>(row + 1) + column;
  return (1 - fy) * ((1 - fx) * upper[0] + fx * upper[1]) + fy * ((1 - fx) * lower[0] + fx * lower[1]);
}

/// The mean of four places about the centre of a cell.
double cellBrightness(const cv::Mat& gray, const cv::Matx33d& H, int row, int column) {
  double sum = 0;
  for (const double y : {row + 0.3, row + 0.7})
    for (const double x : {column + 0.3, column + 0.7}) sum += brightnessAt(gray, transformed(H, x, y));
  return 0.25 * sum;
}

/// Least squares plane through the values of a square ring of cells: its symmetry decouples the equations.
class RingPlane {
 public:
  /// x and y count from the ring's centre.
  void add(double x, double y, double value) {
    sum_ += Vector3d(value, value * x, value * y);
    weight_ += Vector3d(1, x * x, y * y);
  }
  double at(double x, double y) const { return sum_.cwiseQuotient(weight_).dot(Vector3d(1, x, y)); }

 private:
  Vector3d sum_ = Vector3d::Zero(), weight_ = Vector3d::Zero();
};

/// 0: around the border square, 1: the border, 2 and more: within.
int ringOf(int row, int column, int border_cells) {
  return 1 + std::min({row, column, border_cells - 1 - row, border_cells - 1 - column});
}

}  // namespace

std::optional<std::array<Vector2d, 4>> locateMarker(const cv::Mat& gray, const MarkerPattern& pattern,
                                                    const ExpectedMarker& expected) {
  const cv::Matx33d H = cellsToPixels(pattern, expected.corners_px);
  const auto sides = sides_px(expected.corners_px);
  const double cell_px = *std::min_element(sides.begin(), sides.end()) / pattern.border_cells;
  const int scale = std::max(1, static_cast<int>(cell_px / kComparableCell_px));

  // Both the marker's place and the area around it are whole pixels of the image scaled down.
  const int n = pattern.border_cells;
  const cv::Rect box = boundingBox({transformed(H, -1, -1), transformed(H, n + 1, -1),
                                    transformed(H, n + 1, n + 1), transformed(H, -1, n + 1)});
  const cv::Size size((box.width + scale - 1) / scale, (box.height + scale - 1) / scale);
  const int reach = cvCeil(kReachSigmas * expected.sigma_px / scale);
  const cv::Rect wanted(box.x - reach * scale, box.y - reach * scale, (size.width + 2 * reach) * scale,
                        (size.height + 2 * reach) * scale);
  cv::Rect area = wanted & cv::Rect(0, 0, gray.cols, gray.rows);
  area.width = area.width / scale * scale;
  area.height = area.height / scale * scale;
  if (area.width / scale < size.width || area.height / scale < size.height) return std::nullopt;

  // A drawn cell's centre is a whole number, as a pixel's; the cell's corner is half before it.
  const cv::Matx33d to_cells(1, 0, -0.5, 0, 1, -0.5, 0, 0, 1);
  const double s = 1.0 / scale;
  const cv::Matx33d to_box(s, 0, s * (0.5 - box.x) - 0.5, 0, s, s * (0.5 - box.y) - 0.5, 0, 0, 1);
  const cv::Mat cells = drawnCells(pattern);
  cv::Mat drawn, seen, correlation;
  cv::warpPerspective(cells, drawn, to_box * H * to_cells, size, cv::INTER_LINEAR, cv::BORDER_CONSTANT,
                      cv::mean(cells));
  cv::resize(gray(area), seen, area.size() / scale, 0, 0, cv::INTER_AREA);
  cv::matchTemplate(seen, drawn, correlation, cv::TM_CCOEFF_NORMED);
  double best = 0;
  cv::Point place;
  cv::minMaxLoc(correlation, nullptr, &best, nullptr, &place);
  if (best < kSmallestCorrelation) return std::nullopt;

  const Vector2d shift(area.x + place.x * scale - box.x, area.y + place.y * scale - box.y);
  auto corners = expected.corners_px;
  for (Vector2d& corner : corners) corner += shift;
  return corners;
}

CellReading readCells(const cv::Mat& gray, const MarkerPattern& pattern,
                      const std::array<Vector2d, 4>& corners_px) {
  const cv::Matx33d H = cellsToPixels(pattern, corners_px);
  const int n = pattern.border_cells, side = n + 2;
  const double middle = 0.5 * (n - 1);
  const auto index = [&](int row, int column) {
    return static_cast<std::size_t>(row + 1) * static_cast<std::size_t>(side) +
           static_cast<std::size_t>(column + 1);
  };
  std::vector<double> brightness(index(n, n) + 1);
  RingPlane white, black;
  for (int row = -1; row <= n; ++row)
    for (int column = -1; column <= n; ++column) {
      const double value = brightness[index(row, column)] = cellBrightness(gray, H, row, column);
      const int ring = ringOf(row, column, n);
      if (ring < 2) (ring == 0 ? white : black).add(column - middle, row - middle, value);
    }

  CellReading reading;
  reading.border_is_whole = true;
  std::array<double, 2> distance{}, count{};
  for (int row = -1; row <= n; ++row)
    for (int column = -1; column <= n; ++column) {
      const double x = column - middle, y = row - middle;
      const double above = brightness[index(row, column)] - 0.5 * (white.at(x, y) + black.at(x, y));
      const bool should_be_white = isWhite(pattern, row, column), is_white = above > 0;
      distance[should_be_white ? 1 : 0] += should_be_white ? above : -above;
      count[should_be_white ? 1 : 0] += 1;
      if (is_white == should_be_white) continue;
      if (ringOf(row, column, n) < 2)
        reading.border_is_whole = false;
      else
        ++reading.wrong_bits;
    }
  reading.margin = std::min(distance[0] / count[0], distance[1] / count[1]);
  return reading;
}

}  // namespace fathom
