#include "handles/contour.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/linear_algebra.h"

namespace fathom {
namespace {

constexpr double kLeastSigma = 0.003;                 // of a colour, share of full scale: rounding and noise
constexpr double kMostEvidence = 4;                   // nats a pixel: one in fifty may be anything
constexpr double kLeastContrast = 0.5;                // nats
constexpr double kLeastArea = 0.02, kMostArea = 0.9;  // of the box
constexpr double kTooLarge = 1.8;                     // times what the handle covers
constexpr std::size_t kMostParts = 5;
constexpr double kNovel = 0.02;  // of what is beyond the handle's reach is as improbable
constexpr int kFewest = 12;      // pixels of a distribution
constexpr int kColourRounds = 5;

using Colours = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// A normal distribution of colours, and its share.
class Normal {
 public:
  Normal(const Colours& colours, double share) : mean_(colours.colwise().mean()) {
    const Colours off = colours.rowwise() - mean_.transpose();
    Matrix3d covariance = off.transpose() * off / static_cast<double>(colours.rows());
    covariance.diagonal().array() += kLeastSigma * kLeastSigma;
    whiten_ = *lowerWhitener(covariance);
    constant_ =
        std::log(share) + whiten_.diagonal().array().log().sum() - 1.5 * std::log(2 * std::numbers::pi);
  }
  double logDensity(const Vector3d& colour) const {
    return constant_ - 0.5 * (whiten_ * (colour - mean_)).squaredNorm();
  }

 private:
  Vector3d mean_;
  Matrix3d whiten_;
  double constant_ = 0;
};

/// Some normal distributions: the widest is split along its longest axis until they are as many, then each
/// colour goes to the nearest mean (Lloyd 1982).
class ColourModel {
 public:
  ColourModel(const Colours& colours, std::size_t parts) {
    means_ = {colours.colwise().mean()};
    std::vector<std::vector<Eigen::Index>> nearest = assigned(colours, means_);
    while (means_.size() < parts) {
      split(colours, nearest, means_);
      for (int round = 0; round < kColourRounds; ++round) {
        nearest = assigned(colours, means_);
        for (std::size_t k = 0; k < means_.size(); ++k)
          if (!nearest[k].empty()) means_[k] = colours(nearest[k], Eigen::all).colwise().mean();
      }
    }
    for (const auto& own : nearest)
      if (std::ssize(own) >= kFewest)
        parts_.emplace_back(colours(own, Eigen::all),
                            static_cast<double>(own.size()) / static_cast<double>(colours.rows()));
    if (parts_.empty()) parts_.emplace_back(colours, 1.0);
  }
  /// The colours that are nearest to the mean that most are nearest to.
  Colours largestOf(const Colours& colours) const {
    const auto nearest = assigned(colours, means_);
    return colours(*std::max_element(nearest.begin(), nearest.end(),
                                     [](const auto& a, const auto& b) { return a.size() < b.size(); }),
                   Eigen::all);
  }
  double logDensity(const Vector3d& colour) const {
    double largest = -1e300, sum = 0;
    for (const Normal& part : parts_) largest = std::max(largest, part.logDensity(colour));
    for (const Normal& part : parts_) sum += std::exp(part.logDensity(colour) - largest);
    return largest + std::log(sum);
  }

 private:
  static std::vector<std::vector<Eigen::Index>> assigned(const Colours& colours,
                                                         const std::vector<Vector3d>& means) {
    std::vector<std::vector<Eigen::Index>> nearest(means.size());
    for (Eigen::Index i = 0; i < colours.rows(); ++i) {
      const Vector3d colour = colours.row(i);
      const auto best =
          std::min_element(means.begin(), means.end(), [&](const Vector3d& a, const Vector3d& b) {
            return (colour - a).squaredNorm() < (colour - b).squaredNorm();
          });
      nearest[static_cast<std::size_t>(best - means.begin())].push_back(i);
    }
    return nearest;
  }

  static void split(const Colours& colours, const std::vector<std::vector<Eigen::Index>>& nearest,
                    std::vector<Vector3d>& means) {
    std::size_t widest = 0;
    double most = -1;
    Vector3d step = Vector3d::Zero();
    for (std::size_t k = 0; k < means.size(); ++k) {
      if (nearest[k].empty()) continue;
      const Colours off = colours(nearest[k], Eigen::all).rowwise() - means[k].transpose();
      const SymmetricEigen axes = eigenOf(off.transpose() * off);
      if (axes.values[2] <= most) continue;
      most = axes.values[2];
      widest = k;
      step = axes.vectors.col(2) * std::sqrt(most / static_cast<double>(nearest[k].size()));
    }
    means.emplace_back(means[widest] + step);
    means[widest] -= step;
  }

  std::vector<Vector3d> means_;
  std::vector<Normal> parts_;
};

Vector3d colourAt(const cv::Mat& light, int row, int column) {
  const auto& value = light.at<cv::Vec3f>(row, column);
  return {value[0], value[1], value[2]};
}

Colours coloursIn(const cv::Mat& light, const cv::Mat& mask) {
  Colours colours(cv::countNonZero(mask), 3);
  Eigen::Index next = 0;
  for (int row = 0; row < light.rows; ++row)
    for (int column = 0; column < light.cols; ++column)
      if (mask.at<uchar>(row, column) != 0) colours.row(next++) = colourAt(light, row, column).transpose();
  return colours;
}

cv::Mat evidenceOf(const cv::Mat& light, const ColourModel& inside, const ColourModel& outside) {
  cv::Mat evidence(light.size(), CV_32FC1);
  evidence.forEach<float>([&](float& value, const int* at) {
    const Vector3d colour = colourAt(light, at[0], at[1]);
    value = static_cast<float>(
        std::clamp(inside.logDensity(colour) - outside.logDensity(colour), -kMostEvidence, kMostEvidence));
  });
  return evidence;
}

/// The piece with the most pixels.
cv::Mat largestPiece(const cv::Mat& mask) {
  cv::Mat labels, statistics, centres;
  const int count = cv::connectedComponentsWithStats(mask, labels, statistics, centres, 8, CV_32S);
  int best = 0;
  for (int i = 1; i < count; ++i)
    if (best == 0 || statistics.at<int>(i, cv::CC_STAT_AREA) > statistics.at<int>(best, cv::CC_STAT_AREA))
      best = i;
  return best == 0 ? cv::Mat(cv::Mat::zeros(mask.size(), CV_8UC1)) : cv::Mat(labels == best);
}

/// What is within reach and hardly any of what is outside is as improbable.
cv::Mat novelMask(const FrontView& view, const Colours& known, const ColourModel& outside) {
  std::vector<double> densities;
  for (const auto& colour : known.rowwise()) densities.push_back(outside.logDensity(colour.transpose()));
  const auto least =
      densities.begin() + static_cast<std::ptrdiff_t>(kNovel * static_cast<double>(densities.size() - 1));
  std::nth_element(densities.begin(), least, densities.end());
  cv::Mat mask(view.light.size(), CV_8UC1);
  mask.forEach<uchar>([&](uchar& value, const int* at) {
    value = outside.logDensity(colourAt(view.light, at[0], at[1])) < *least ? 255 : 0;
  });
  return mask & view.in_reach;
}

/// How outside looks, and what is inside at first.
std::pair<ColourModel, cv::Mat> outsideAndFirst(const FrontView& view, const cv::Mat& beyond) {
  Colours known = coloursIn(view.light, beyond);
  for (std::size_t parts = 3;; ++parts) {
    const ColourModel outside(known, parts);
    const cv::Mat mask = novelMask(view, known, outside);
    if (cv::countNonZero(mask) <= kTooLarge * view.silhouette_px || parts == kMostParts)
      return {outside, largestPiece(mask)};
    // A plate that carries the handle, say: what there is most of.
    const Colours novel = coloursIn(view.light, mask);
    const Colours most = ColourModel(novel, 3).largestOf(novel);
    Colours more(known.rows() + most.rows(), 3);
    more << known, most;
    known = more;
  }
}

}  // namespace

Contour contourOf(const FrontView& view, const ContourOptions& options) {
  Contour contour;
  contour.mask = cv::Mat::zeros(view.light.size(), CV_8UC1);
  const cv::Mat beyond = ~view.in_reach;
  const int reach_px = cv::countNonZero(view.in_reach);
  if (reach_px < kFewest || cv::countNonZero(beyond) < kFewest) return contour;
  const double sigma_px = std::max(1.0, options.smooth_px / std::max(1e-9, view.image_px));
  const auto isLikely = [&](const cv::Mat& mask) {
    const double area = cv::countNonZero(mask);
    return area >= std::max<double>(kFewest, kLeastArea * reach_px) && area <= kMostArea * reach_px;
  };
  const auto [outside, first] = outsideAndFirst(view, beyond);
  cv::Mat next = first;
  std::optional<Superellipse> shape;
  for (int round = 0; round < options.rounds && isLikely(next); ++round) {
    const bool is_same = cv::countNonZero(next != contour.mask) == 0;
    contour.mask = next;
    if (is_same) break;
    contour.evidence = evidenceOf(view.light, ColourModel(coloursIn(view.light, contour.mask), 2), outside);
    shape = superellipseOf(contour.mask, shape);
    cv::Mat smooth;
    contour.mask.convertTo(smooth, CV_32F, 1.0 / 255);
    cv::GaussianBlur(smooth, smooth, {}, sigma_px);
    const cv::Mat field = smooth - 0.5 + options.region / kMostEvidence * contour.evidence +
                          options.shape * (shape->drawn(view.light.size()) - 0.5);
    next = largestPiece(cv::Mat(field > 0) & view.in_reach);
  }
  if (!isLikely(next)) return contour;
  contour.shape = superellipseOf(contour.mask, shape);
  contour.contrast = cv::mean(contour.evidence, contour.mask)[0];
  contour.found = contour.contrast >= kLeastContrast;
  return contour;
}

}  // namespace fathom
