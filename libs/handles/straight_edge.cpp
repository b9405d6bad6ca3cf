#include "handles/straight_edge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "core/linear_algebra.h"

namespace fathom {
namespace {

constexpr double kStep_rad = radians(1);             // of Hough's table
constexpr double kNearLine_px = 1.5;                 // an edge's pixels are this near to its line
constexpr double kOtherDirection_rad = radians(20);  // from which on a direction is another one
constexpr double kShortest = 0.35;                   // of the box's reach
constexpr double kEdgeShare = 0.2;                   // of the inside pixels are edges, at most
constexpr double kCannySlope = 4000;                 // the steepest, as the whole numbers of Canny have it
constexpr double kClearlyMore = 1.3;                 // one end against the other

/// Canny on the colour that changes most at each pixel, the threshold such that the expected share of the
/// region's pixels is above it.
cv::Mat edgesOf(const cv::Mat& light, const cv::Mat& region, double sigma_px) {
  cv::Mat smooth, slopes_x, slopes_y;
  cv::GaussianBlur(light, smooth, {}, sigma_px);
  cv::Sobel(smooth, slopes_x, CV_32F, 1, 0);
  cv::Sobel(smooth, slopes_y, CV_32F, 0, 1);
  cv::Mat dx = cv::Mat::zeros(light.size(), CV_32FC1), dy = dx.clone();
  std::vector<double> slopes;
  double largest = 1e-9;
  for (int row = 0; row < light.rows; ++row)
    for (int column = 0; column < light.cols; ++column) {
      const auto &x = slopes_x.at<cv::Vec3f>(row, column), &y = slopes_y.at<cv::Vec3f>(row, column);
      int steepest = 0;
      for (int c = 1; c < 3; ++c)
        if (std::hypot(x[c], y[c]) > std::hypot(x[steepest], y[steepest])) steepest = c;
      dx.at<float>(row, column) = x[steepest];
      dy.at<float>(row, column) = y[steepest];
      if (region.at<uchar>(row, column) == 0) continue;
      slopes.push_back(std::hypot(x[steepest], y[steepest]));
      largest = std::max(largest, slopes.back());
    }
  const auto high =
      slopes.begin() + static_cast<std::ptrdiff_t>((1 - kEdgeShare) * static_cast<double>(slopes.size() - 1));
  std::nth_element(slopes.begin(), high, slopes.end());
  const double scale = kCannySlope / largest;
  dx.convertTo(dx, CV_16S, scale);
  dy.convertTo(dy, CV_16S, scale);
  cv::Mat edges;
  cv::Canny(dx, dy, edges, 0.5 * scale * *high, scale * *high, true);
  return edges & region;
}

struct Line {
  Vector2d normal;  // unit
  double offset_px = 0, votes = 0;

  double distance_px(const Vector2d& p) const { return normal.dot(p) - offset_px; }
  /// Of the line, from x towards y up.
  double direction_rad() const { return std::atan2(normal.x(), normal.y()); }
};

std::vector<Line> linesIn(const cv::Mat& edges, int fewest) {
  std::vector<cv::Vec3f> found;
  cv::HoughLines(edges, found, 1, kStep_rad, fewest);
  std::vector<Line> lines;
  for (const cv::Vec3f& line : found)
    lines.push_back({{std::cos(line[1]), std::sin(line[1])}, line[0], line[2]});
  return lines;
}

std::vector<Vector2d> pixelsAlong(const cv::Mat& edges, const Line& line) {
  std::vector<Vector2d> along;
  for (int row = 0; row < edges.rows; ++row)
    for (int column = 0; column < edges.cols; ++column)
      if (edges.at<uchar>(row, column) != 0 && std::abs(line.distance_px({column, row})) <= kNearLine_px)
        along.emplace_back(column, row);
  return along;
}

/// The line through the pixels by total least squares.
EdgeReading fitted(const std::vector<Vector2d>& pixels) {
  Vector2d mean = Vector2d::Zero();
  for (const Vector2d& p : pixels) mean += p / static_cast<double>(pixels.size());
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  for (const Vector2d& p : pixels) squares += (p - mean) * (p - mean).transpose();
  const SymmetricEigen axes = eigenOf(squares);
  const Vector2d along = axes.vectors.col(1);
  const double across = std::max(axes.values[0] / static_cast<double>(pixels.size()), 1.0 / 12);
  EdgeReading reading;
  reading.found = true;
  reading.angle_rad = std::atan2(-along.y(), along.x());
  reading.sigma_rad = std::sqrt(across / std::max(1e-9, axes.values[1]));
  double least = 0, most = 0;
  for (const Vector2d& p : pixels) {
    least = std::min(least, along.dot(p - mean));
    most = std::max(most, along.dot(p - mean));
  }
  reading.edge = {mean + least * along, mean + most * along};
  return reading;
}

/// Which end a lever points with: most of it is there.
void pointLever(const FrontView& view, const cv::Mat& mask, EdgeReading& reading) {
  const Vector2d along(std::cos(reading.angle_rad), -std::sin(reading.angle_rad));
  double ahead = 0, behind = 0;
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.cols; ++column) {
      const double at = along.dot(Vector2d(column, row) - view.axis_px);
      if (mask.at<uchar>(row, column) != 0) (at > 0 ? ahead : behind) += std::abs(at);
    }
  if (ahead < behind) reading.angle_rad += std::numbers::pi;
  if (std::max(ahead, behind) >= kClearlyMore * std::min(ahead, behind))
    reading.symmetry_rad = 2 * std::numbers::pi;
}

/// Which of the four directions is the marked spoke's: the colour along it is unlike the others'.
void pointWheel(const FrontView& view, const Handle& handle, EdgeReading& reading) {
  std::array<Vector3d, 4> colours;
  for (std::size_t k = 0; k < 4; ++k) {
    const double angle = reading.angle_rad + static_cast<double>(k) * std::numbers::pi / 2;
    colours[k] = Vector3d::Zero();
    int count = 0;
    for (double share = 0.45; share <= 0.8; share += 0.05, ++count) {
      const Vector2d p = view.pixelOf(share * handle.radius_m * Vector2d(std::cos(angle), std::sin(angle)));
      const int row = std::clamp(cvRound(p.y()), 0, view.light.rows - 1);
      const int column = std::clamp(cvRound(p.x()), 0, view.light.cols - 1);
      const auto& v = view.light.at<cv::Vec3f>(row, column);
      colours[k] += Vector3d(v[0], v[1], v[2]);
    }
    colours[k] /= count;
  }
  std::array<double, 4> unlike{};
  for (std::size_t k = 0; k < 4; ++k) {
    unlike[k] = std::numeric_limits<double>::infinity();
    for (std::size_t other = 0; other < 4; ++other)
      if (other != k) unlike[k] = std::min(unlike[k], (colours[k] - colours[other]).norm());
  }
  const auto best = std::max_element(unlike.begin(), unlike.end());
  double next = 0;
  for (auto it = unlike.begin(); it != unlike.end(); ++it)
    if (it != best) next = std::max(next, *it);
  if (*best < kClearlyMore * next) return;
  reading.angle_rad += static_cast<double>(best - unlike.begin()) * std::numbers::pi / 2;
  reading.symmetry_rad = 2 * std::numbers::pi;
}

}  // namespace

EdgeReading readStraightEdge(const FrontView& view, const Contour& contour, const Handle& handle) {
  EdgeReading none;
  none.why_not = "nothing to be told from the panel";
  if (!contour.found) return none;
  const double blur_px = std::max(0.7, 0.7 / std::max(1e-9, view.image_px));
  cv::Mat region;
  cv::dilate(contour.mask, region, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  const cv::Mat edges = edgesOf(view.light, region, blur_px);
  const double reach_px = sweptBoxOf(handle).reach_m / view.m_per_px;
  const std::vector<Line> lines = linesIn(edges, std::max(6, static_cast<int>(kShortest * reach_px)));
  none.edges = edges;
  none.why_not = "no straight edge";
  if (lines.empty()) return none;
  const double symmetry = symmetryOfEdges(handle.kind);
  const auto isOther = [&](const Line& line) {
    return std::abs(angleDifference(line.direction_rad(), lines.front().direction_rad(), symmetry)) >
           kOtherDirection_rad;
  };
  const auto next = std::find_if(lines.begin(), lines.end(), isOther);
  const std::vector<Vector2d> along = pixelsAlong(edges, lines.front());
  if (along.size() < 3) return none;
  EdgeReading reading = fitted(along);
  reading.edges = edges;
  reading.symmetry_rad = symmetry;
  reading.prominence = lines.front().votes / (lines.front().votes + (next == lines.end() ? 0 : next->votes));
  if (handle.kind == HandleKind::lever) pointLever(view, contour.mask, reading);
  if (handle.kind == HandleKind::wheel) pointWheel(view, handle, reading);
  return reading;
}

}  // namespace fathom
