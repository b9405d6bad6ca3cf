#include "observables/specks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>
#include <vector>

#include "core/linear_algebra.h"
#include "imaging/image_model.h"

namespace fathom {
namespace {

constexpr std::size_t kFewestOfLabel = 60;    // pixels, for ten times as many as the polynomial has terms
constexpr std::size_t kEnoughOfLabel = 1000;  // more are left out of its fit
constexpr double kFullScale = 0.98;           // brighter ones may be clipped
constexpr int kCell_px = 16;                  // over which volumes a pixel are taken for one

using Terms = Eigen::Matrix<double, 6, 1>;
using Fit = Eigen::Matrix<double, 6, 3>;  // red, green, blue

/// Of the pixel's place in a label, from about -1 to 1.
struct Frame {
  Vector2d middle = Vector2d::Zero();
  double reach = 1;

  Terms terms(const cv::Point& pixel) const {
    const Vector2d p = (Vector2d(pixel.x, pixel.y) - middle) / reach;
    Terms terms;
    terms << 1, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
    return terms;
  }
};

Frame frameOf(const std::vector<cv::Point>& pixels) {
  const cv::Rect box = cv::boundingRect(pixels);
  return {Vector2d(box.x + 0.5 * (box.width - 1), box.y + 0.5 * (box.height - 1)),
          std::max(1.0, 0.5 * std::max(box.width, box.height))};
}

/// A pixel's noise, of what may be estimated darker or brighter than there is.
double speckNoise(double radiance, const CameraSheet& sheet) {
  return pixelSigma(std::clamp(radiance, 1e-3, 1.0), sheet);
}

/// The value that a share of them is below.
double quantile(std::vector<double> values, double share) {
  const auto place =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// What a label shows without specks, and by how many times its noise its pixels scatter, at least 1.
struct Plain {
  Frame frame;
  Fit fit = Fit::Zero();
  Vector3d scatter = Vector3d::Ones();

  Vector3d light(const cv::Point& pixel) const { return fit.transpose() * frame.terms(pixel); }
  /// Infinite for a colour that does not count.
  Vector3d sigma(const Vector3d& light, const CameraSheet& sheet) const {
    Vector3d sigma;
    for (int c = 0; c < 3; ++c)
      sigma[c] = light[c] > kFullScale ? std::numeric_limits<double>::infinity()
                                       : scatter[c] * speckNoise(light[c], sheet);
    return sigma;
  }
};

/// One colour of some pixels.
class PlainFit {
 public:
  PlainFit(const Eigen::Matrix<double, 6, Eigen::Dynamic>& terms, const Eigen::VectorXd& light)
      : terms_(terms), light_(light) {}

  /// From the median on, each time with Tukey's weights (Beaton & Tukey 1974).
  Terms solve() const {
    constexpr int kRounds = 6;
    constexpr double kTukey = 4.685;
    Terms solution = Terms::Zero();
    solution[0] = quantile({light_.begin(), light_.end()}, 0.5);
    for (int round = 0; round < kRounds; ++round) {
      const Eigen::VectorXd off = offFrom(solution);
      const double reach = kTukey * std::max(1e-6, scatterOf(off));
      const Eigen::VectorXd weight = (1 - (off / reach).array().square()).max(0).square().matrix();
      const Eigen::Matrix<double, 6, Eigen::Dynamic> weighted = terms_ * weight.asDiagonal();
      const Eigen::Matrix<double, 6, 6> normal = weighted * terms_.transpose();
      const double damping = 1e-9 * normal.trace();
      solution =
          solveSymmetric(normal + damping * Eigen::Matrix<double, 6, 6>::Identity(), weighted * light_);
    }
    return solution;
  }

  Eigen::VectorXd offFrom(const Terms& solution) const { return light_ - terms_.transpose() * solution; }

  /// Standard deviation of most: 68.3 % of a normal curve are within one.
  static double scatterOf(const Eigen::VectorXd& off) {
    const Eigen::VectorXd size = off.cwiseAbs();
    return quantile({size.begin(), size.end()}, 0.683);
  }

 private:
  const Eigen::Matrix<double, 6, Eigen::Dynamic>& terms_;
  const Eigen::VectorXd& light_;
};

Plain plainOf(const std::vector<cv::Point>& pixels, const cv::Mat& light, const CameraSheet& sheet) {
  Plain plain{frameOf(pixels)};
  const std::size_t stride = std::max<std::size_t>(1, pixels.size() / kEnoughOfLabel);
  const auto count = static_cast<Eigen::Index>((pixels.size() + stride - 1) / stride);
  Eigen::Matrix<double, 6, Eigen::Dynamic> terms(6, count);
  for (Eigen::Index i = 0; i < count; ++i)
    terms.col(i) = plain.frame.terms(pixels[static_cast<std::size_t>(i) * stride]);
  for (int c = 0; c < 3; ++c) {
    Eigen::VectorXd colour(count);
    for (Eigen::Index i = 0; i < count; ++i)
      colour[i] = light.at<cv::Vec3f>(pixels[static_cast<std::size_t>(i) * stride])[c];
    const PlainFit robust(terms, colour);
    plain.fit.col(c) = robust.solve();
    Eigen::VectorXd off = robust.offFrom(plain.fit.col(c));
    for (Eigen::Index i = 0; i < count; ++i) off[i] /= speckNoise(terms.col(i).dot(plain.fit.col(c)), sheet);
    plain.scatter[c] = std::max(1.0, PlainFit::scatterOf(off));
  }
  return plain;
}

std::map<int, std::vector<cv::Point>> pixelsByLabel(const SpeckImage& image) {
  std::map<int, std::vector<cv::Point>> by_label;
  for (int v = 0; v < image.mask.rows; ++v)
    for (int u = 0; u < image.mask.cols; ++u)
      if (const int label = image.labels.at<int>(v, u); image.mask.at<std::uint8_t>(v, u) != 0 && label >= 0)
        by_label[label].emplace_back(u, v);
  std::erase_if(by_label, [](const auto& entry) { return entry.second.size() < kFewestOfLabel; });
  return by_label;
}

/// From each pixel to the nearest that does not count, from middle to middle; beyond the image none does.
cv::Mat insideBy_px(const cv::Mat& counts) {
  cv::Mat framed, distance;
  cv::copyMakeBorder(counts, framed, 1, 1, 1, 1, cv::BORDER_CONSTANT, cv::Scalar(0));
  cv::distanceTransform(framed, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance({1, 1, counts.cols, counts.rows});
}

/// How far inside a speck's middle must be. One of 3 pixels reaches 2 from its middle, one of 15 reaches 3,
/// and none more than the nearest flake and the pixels that it touches.
BySpeckClass depthsInside_px(const CameraModel& lens) {
  const double largest = 0.5 * kFlakeDiameter_m / kNearestFlake_m * std::max(lens.fx_px, lens.fy_px);
  return {3, 4, std::max(5.0, std::ceil(largest + 1.5))};
}

/// Sums over the pixels of a cell.
struct CellSums {
  Vector2d pixel = Vector2d::Zero();
  Vector3d light = Vector3d::Zero();
  double z_m = 0, count = 0;
  BySpeckClass inside = BySpeckClass::Zero();
};

class SpeckSearch {
 public:
  SpeckSearch(const SpeckImage& image, const CameraSheet& sheet, const CameraModel& lens)
      : image_(image),
        sheet_(sheet),
        lens_(lens),
        depths_px_(depthsInside_px(lens)),
        by_label_(pixelsByLabel(image)) {
    cv::Mat counts(image.light.size(), CV_8UC1, cv::Scalar(0));
    for (const auto& [label, pixels] : by_label_)
      for (const cv::Point& pixel : pixels) counts.at<std::uint8_t>(pixel) = 255;
    inside_px_ = insideBy_px(counts);
    off_ = cv::Mat(counts.size(), CV_8UC1, cv::Scalar(0));
  }

  SpeckCount count() {
    SpeckCount result;
    for (const auto& [label, pixels] : by_label_) {
      const Plain plain = plainOf(pixels, image_.light, sheet_);
      mark(pixels, plain);
      addCells(pixels, plain, result.cells);
    }
    result.specks = specks();
    return result;
  }

 private:
  void mark(const std::vector<cv::Point>& pixels, const Plain& plain) {
    for (const cv::Point& pixel : pixels) {
      const Vector3d light = plain.light(pixel), sigma = plain.sigma(light, sheet_);
      const cv::Vec3f& seen = image_.light.at<cv::Vec3f>(pixel);
      for (int c = 0; c < 3; ++c)
        if (std::abs(seen[c] - light[c]) > kSpeckSigmas * sigma[c]) off_.at<std::uint8_t>(pixel) = 255;
    }
  }

  void addCells(const std::vector<cv::Point>& pixels, const Plain& plain, std::vector<SpeckCell>& all) const {
    std::map<std::tuple<int, int>, CellSums> cells;
    for (const cv::Point& pixel : pixels) {
      CellSums& cell = cells[{pixel.x / kCell_px, pixel.y / kCell_px}];
      cell.pixel += Vector2d(pixel.x, pixel.y);
      cell.light += plain.light(pixel);
      cell.z_m += image_.z_m.at<float>(pixel);
      ++cell.count;
      cell.inside += (inside_px_.at<float>(pixel) >= depths_px_).cast<double>();
    }
    for (const auto& [place, cell] : cells) {
      if (cell.inside.maxCoeff() <= 0) continue;
      const Vector3d light = cell.light / cell.count;
      all.push_back({{light, plain.sigma(light, sheet_), cell.z_m / cell.count,
                      focalAt(lens_.idealAt(cell.pixel / cell.count), lens_)},
                     cell.inside});
    }
  }

  BySpeckClass specks() const {
    cv::Mat numbers, boxes, middles;
    const int count = cv::connectedComponentsWithStats(off_, numbers, boxes, middles, 8);
    BySpeckClass specks = BySpeckClass::Zero();
    for (int i = 1; i < count; ++i) {  // the first is what is not off
      const int k = speckClass(boxes.at<int>(i, cv::CC_STAT_AREA));
      const cv::Point middle(cvRound(middles.at<double>(i, 0)), cvRound(middles.at<double>(i, 1)));
      if (inside_px_.at<float>(middle) >= depths_px_[k]) ++specks[k];
    }
    return specks;
  }

  const SpeckImage& image_;
  const CameraSheet& sheet_;
  const CameraModel& lens_;
  BySpeckClass depths_px_;
  std::map<int, std::vector<cv::Point>> by_label_;
  cv::Mat inside_px_;  ///< CV_32FC1
  cv::Mat off_;        ///< CV_8UC1, not 0 where a pixel belongs to a speck
};

}  // namespace

SpeckVolumes volumesOf(const std::vector<SpeckCell>& cells, const Environment& environment) {
  SpeckVolumes volumes;
  for (const SpeckCell& cell : cells) volumes.add(visibleVolume(cell.backdrop, environment), cell.inside);
  return volumes;
}

SpeckCount countSpecks(const SpeckImage& image, const CameraSheet& sheet, const CameraModel& lens) {
  return SpeckSearch(image, sheet, lens).count();
}

}  // namespace fathom
