#include "fiducials/corner_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace fathom {
namespace {

/// What least squares does not see: the pixel's square shape, and with much blur the cells beyond the border.
/// The second term was measured, see tests/unit/corner_refinement_test.cpp. The first is what makes poses
/// from the sample images in tests/interop/panel_pose_sample_test.cpp honest: with 0.010 their median NEES
/// is 4.6, with 0.006 6.6, where 5.35 is expected. The fit itself errs by 0.003 where a pixel is drawn from
/// 144 samples.
double modelSigma_px(double cell_px, double blur_sigma_px) {
  return 0.008 + 1.0 * blur_sigma_px * std::exp(-0.9 * cell_px / blur_sigma_px);
}

using Vector8f = Eigen::Matrix<float, 8, 1>;
using Matrix8f = Eigen::Matrix<float, 8, 8>;

constexpr std::size_t kFewestPixels = 28;                    ///< four times the parameters
constexpr int kRoughColumns = 20, kFinalColumns = 64;        ///< at least, where there are as many
constexpr double kRoughStep_px = 0.1, kFinalStep_px = 0.02;  ///< settled; the next step is about its square
constexpr double kShortestReach_px = 1.3, kFinalReach_px = 3.5;
constexpr double kLargestEdgeSigma_px = 1.0;
constexpr int kLargestIterationCount = 12;
constexpr double kSettledLogSigma = 0.1;
constexpr double kSmallestBlur_px = 0.08;
constexpr double kCentred_px = 0.3;    ///< pixels are gathered anew about an edge farther off
constexpr double kSmallestStep = 0.5;  ///< half a digital number on each side of the mean

/// erf, tabulated with its derivative: the fit spends its time here. Linear interpolation errs by 1e-5.
class ErrorFunction {
 public:
  ErrorFunction() {
    const auto slope = [](double u) { return 2.0 * std::numbers::inv_sqrtpi * std::exp(-u * u); };
    for (std::size_t i = 0; i <= kSteps; ++i) {
      const double u = -kLimit + static_cast<double>(i) * kStep;
      knots_[i] = {std::erf(u), std::erf(u + kStep) - std::erf(u), slope(u), slope(u + kStep) - slope(u)};
    }
  }
  struct Sample {
    double value, slope, integral;
  };
  Sample at(double u) const {
    const double position = (std::clamp(u, -kLimit, kLimit) + kLimit) * (1.0 / kStep);
    const int i = static_cast<int>(position);
    const double f = position - i;
    const Knot& knot = knots_[static_cast<std::size_t>(i)];
    const double value = knot.value + f * knot.value_rise, slope = knot.slope + f * knot.slope_rise;
    return {value, slope, u * value + 0.5 * slope};
  }

 private:
  static constexpr std::size_t kSteps = 1024;
  static constexpr double kLimit = 4.0, kStep = 2.0 * kLimit / kSteps;
  struct Knot {
    double value, value_rise, slope, slope_rise;
  };
  std::array<Knot, kSteps + 1> knots_{};
};

/// A side of the square: along runs from its first corner to its second, across points out of the square.
struct Side {
  Vector2d middle, along, across;
  double half_length = 0;
  /// How far it bulges outward from the chord at s, px: (1 - s²) (bulge[0] + bulge[1] s + bulge[2] s²).
  Vector3d bulge = Vector3d::Zero();

  Side(const Vector2d& first, const Vector2d& second) {
    middle = 0.5 * (first + second);
    half_length = 0.5 * (second - first).norm();
    along = (second - first) / (2.0 * half_length);
    across = {along.y(), -along.x()};  // corners run clockwise in an image whose y points down
  }

  double bulgeAt(double s) const { return (1.0 - s * s) * (bulge[0] + s * (bulge[1] + s * bulge[2])); }
  /// Of the pixel's square, projected on `across`: a box of this width, somewhat rounded.
  double boxWidth() const { return std::max(std::abs(across.x()), std::abs(across.y())); }
};

/// The chord against the image of the straight line, at three points.
Vector3d bulgeOf(const Vector2d& first, const Vector2d& second, const Side& side, const CameraModel& camera) {
  const Vector2d ideal_first = camera.idealAt(first), ideal_second = camera.idealAt(second);
  const auto outward = [&](double s) {
    const Vector2d ideal = 0.5 * ((1.0 - s) * ideal_first + (1.0 + s) * ideal_second);
    const Vector3d ray = ideal.homogeneous();
    return side.across.dot(camera.project(ray) - side.middle);
  };
  const double before = outward(-0.5), middle = outward(0.0), after = outward(0.5);
  return {middle, (after - before) / 0.75, 4.0 * ((after + before) / 1.5 - middle)};
}

struct Pixel {
  double s;  ///< along the side, -1 to 1 between the corners
  double d;  ///< outward from the side as drawn, bulge taken off
  double value;
};

/// Pixels within `reach` of the side, its ends left out: there the neighbouring sides show.
void gatherPixels(const cv::Mat& gray, const Side& side, double reach, int columns,
                  std::vector<Pixel>& pixels) {
  pixels.clear();
  const double largest_s =
      1.0 - std::min(std::min(reach, kFinalReach_px) + 0.5, 0.4 * side.half_length) / side.half_length;
  const bool steep = std::abs(side.along.y()) > std::abs(side.along.x());
  const int u = steep ? 1 : 0, v = 1 - u;  // columns step along u, each column runs along v
  const int limit_u = steep ? gray.rows : gray.cols, limit_v = steep ? gray.cols : gray.rows;

  const double extent_u = std::abs(side.along[u]) * side.half_length + reach * std::abs(side.across[u]);
  const double half_column = (reach + std::abs(side.bulge[0])) / std::abs(side.across[v]);
  const int first_u = std::max(0, static_cast<int>(std::ceil(side.middle[u] - extent_u)));
  const int last_u = std::min(limit_u - 1, static_cast<int>(std::floor(side.middle[u] + extent_u)));
  const int stride = std::max(1, (last_u - first_u + columns) / columns);
  const int stride_v = std::max(1, static_cast<int>(reach / kFinalReach_px));
  for (int i = first_u; i <= last_u; i += stride) {
    const double centre_v = side.middle[v] + (i - side.middle[u]) * side.along[v] / side.along[u];
    const int first_v = std::max(0, static_cast<int>(std::ceil(centre_v - half_column)));
    const int last_v = std::min(limit_v - 1, static_cast<int>(std::floor(centre_v + half_column)));
    for (int j = first_v; j <= last_v; j += stride_v) {
      const Vector2d p = steep ? Vector2d(j, i) : Vector2d(i, j);
      const double s = side.along.dot(p - side.middle) / side.half_length;
      const double d = side.across.dot(p - side.middle) - side.bulgeAt(s);
      if (std::abs(s) > largest_s || std::abs(d) > reach) continue;
      pixels.push_back(
          {s, d, static_cast<double>(steep ? gray.at<std::uint8_t>(i, j) : gray.at<std::uint8_t>(j, i))});
    }
  }
}

/// value = level0 + level1 s + (step0 + step1 s) E(d - offset - turn s), where E is erf(x / (sqrt2 sigma))
/// averaged over the pixel's width.
struct EdgeFit {
  enum Parameter { offset, turn, level0, level1, step0, step1, log_sigma, kCount };
  using Vector = Eigen::Matrix<double, kCount, 1>;
  using Matrix = Eigen::Matrix<double, kCount, kCount>;

  Vector p = Vector::Zero();
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< of offset and turn, px²

  /// The outward position of the edge at s and its variance.
  double position(double s) const { return p[offset] + p[turn] * s; }
};

void startLevels(const std::vector<Pixel>& pixels, EdgeFit& fit) {
  double outside = 0, inside = 0, count_outside = 0, count_inside = 0;
  for (const Pixel& pixel : pixels) {
    (pixel.d > 0 ? outside : inside) += pixel.value;
    (pixel.d > 0 ? count_outside : count_inside) += 1;
  }
  outside /= std::max(1.0, count_outside);
  inside /= std::max(1.0, count_inside);
  fit.p[EdgeFit::level0] = 0.5 * (outside + inside);
  fit.p[EdgeFit::step0] = 0.5 * (outside - inside);
}

/// Gauss-Newton with bounded steps. False where the normal equations are singular or the fit runs away.
bool fitEdge(const std::vector<Pixel>& pixels, double width, double reach, double settled_px, EdgeFit& fit) {
  static const ErrorFunction kErf;
  if (pixels.size() < kFewestPixels) return false;
  // The derivatives and, last, the residual. Single precision is twice as fast; what it rounds moves the edge
  // by less than 1e-4 px.
  std::vector<Vector8f> rows(pixels.size());
  for (int iteration = 0; iteration < kLargestIterationCount; ++iteration) {
    const double scale = 1.0 / (std::numbers::sqrt2 * std::exp(fit.p[EdgeFit::log_sigma]));
    const double average = 1.0 / (width * scale), half_width = 0.5 * width * scale,
                 inverse_width = 1.0 / width;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const Pixel& pixel = pixels[i];
      const double d = pixel.d - fit.p[EdgeFit::offset] - fit.p[EdgeFit::turn] * pixel.s;
      const auto near = kErf.at(scale * d - half_width), far = kErf.at(scale * d + half_width);
      const double value = (far.integral - near.integral) * average;
      const double step = fit.p[EdgeFit::step0] + fit.p[EdgeFit::step1] * pixel.s;
      const double residual =
          pixel.value - (fit.p[EdgeFit::level0] + fit.p[EdgeFit::level1] * pixel.s + step * value);
      const double by_offset = -step * (far.value - near.value) * inverse_width;
      const double by_log_sigma = step * 0.5 * (far.slope - near.slope) * average;
      const Vector8d derivatives{by_offset, by_offset * pixel.s, 1.0,          pixel.s,
                                 value,     value * pixel.s,     by_log_sigma, residual};
      rows[i] = derivatives.cast<float>();
    }
    Matrix8f normal = Matrix8f::Zero();  // summed apart: waiting for each row costs more than computing it
    for (const Vector8f& row : rows) normal.noalias() += row * row.transpose();
    EdgeFit::Matrix H = normal.topLeftCorner<EdgeFit::kCount, EdgeFit::kCount>().cast<double>();
    const EdgeFit::Vector g = normal.topRightCorner<EdgeFit::kCount, 1>().cast<double>();
    const double squares = normal(EdgeFit::kCount, EdgeFit::kCount);
    if (std::abs(fit.p[EdgeFit::step0]) < kSmallestStep) return false;
    H.diagonal() *= 1.0 + 1e-9;
    H(EdgeFit::log_sigma, EdgeFit::log_sigma) += 1e-3 * H(EdgeFit::step0, EdgeFit::step0);  // sigma near 0
    const Eigen::LDLT<EdgeFit::Matrix> solver(H);
    const EdgeFit::Vector step = solver.solve(g);
    if (solver.info() != Eigen::Success || !step.allFinite()) return false;
    const double largest = std::max({std::abs(step[EdgeFit::offset]) / (0.5 * reach),
                                     std::abs(step[EdgeFit::turn]) / (0.5 * reach),
                                     std::abs(step[EdgeFit::log_sigma]) / 0.5, 1.0});
    fit.p += step / largest;
    if (std::abs(fit.p[EdgeFit::offset]) + std::abs(fit.p[EdgeFit::turn]) > 1.5 * reach) return false;
    const double log_sigma = fit.p[EdgeFit::log_sigma] - step[EdgeFit::log_sigma] / largest;
    fit.p[EdgeFit::log_sigma] =
        std::clamp(fit.p[EdgeFit::log_sigma], std::log(kSmallestBlur_px), std::log(reach));
    const bool settled = step.head<2>().cwiseAbs().maxCoeff() < settled_px &&
                         std::abs(fit.p[EdgeFit::log_sigma] - log_sigma) < kSettledLogSigma;
    if (settled || iteration + 1 == kLargestIterationCount) {
      // Rounding to whole numbers alone has a variance of 1/12.
      const double noise =
          std::max(1.0 / 12.0, squares / static_cast<double>(pixels.size() - EdgeFit::kCount));
      fit.covariance = noise * solver.solve(EdgeFit::Matrix::Identity()).topLeftCorner<2, 2>();
      return true;
    }
  }
  return false;
}

struct FittedSide {
  Side side;
  EdgeFit fit;
};

/// The wide blurred edge that finds its way from afar. False where there is none.
bool fitFromAfar(const cv::Mat& gray, const Side& side, double cell_px, std::vector<Pixel>& pixels,
                 EdgeFit& fit) {
  const double reach = std::max(0.65 * cell_px, std::min(2.2, cell_px));
  gatherPixels(gray, side, reach, kRoughColumns, pixels);
  fit.p[EdgeFit::log_sigma] = std::log(0.4 * reach);
  startLevels(pixels, fit);
  return fitEdge(pixels, side.boxWidth(), reach, kRoughStep_px, fit);
}

/// The edge from the pixels around the side, which is near it. False where there is none.
bool fitFromNear(const cv::Mat& gray, const Side& side, double cell_px, std::vector<Pixel>& pixels,
                 EdgeFit& fit) {
  // Blur carries the next cells over; 1.8 sigma away they have lost all but a thirtieth.
  const double sigma_px = std::exp(fit.p[EdgeFit::log_sigma]);
  const double reach = std::clamp(cell_px - 1.8 * sigma_px, kShortestReach_px, kFinalReach_px);
  gatherPixels(gray, side, reach, kFinalColumns, pixels);
  if (fit.p[EdgeFit::step0] == 0) startLevels(pixels, fit);
  return fitEdge(pixels, side.boxWidth(), reach, kFinalStep_px, fit);
}

/// Shifts the side to where the fit found the edge.
void moveToEdge(FittedSide& fitted) {
  auto& [side, fit] = fitted;
  const Vector3d bulge = side.bulge;
  const Vector2d first = side.middle - side.half_length * side.along + fit.position(-1.0) * side.across;
  const Vector2d second = side.middle + side.half_length * side.along + fit.position(1.0) * side.across;
  side = Side(first, second);
  side.bulge = bulge;
  fit.p[EdgeFit::offset] = fit.p[EdgeFit::turn] = 0;
}

std::optional<FittedSide> fitSide(const cv::Mat& gray, const Vector2d& first, const Vector2d& second,
                                  double cell_px, const CameraModel* camera,
                                  const std::optional<double>& blur_sigma_px, std::vector<Pixel>& pixels) {
  FittedSide result{Side(first, second), {}};
  auto& [side, fit] = result;
  if (side.half_length < 3.0) return std::nullopt;
  if (camera != nullptr) side.bulge = bulgeOf(first, second, side, *camera);

  if (blur_sigma_px) {
    fit.p[EdgeFit::log_sigma] = std::log(std::max(kSmallestBlur_px, *blur_sigma_px));
    if (!fitFromNear(gray, side, cell_px, pixels, fit)) return std::nullopt;
  } else {
    if (!fitFromAfar(gray, side, cell_px, pixels, fit)) return std::nullopt;
  }
  const double move_px = std::abs(fit.p[EdgeFit::offset]) + std::abs(fit.p[EdgeFit::turn]);
  if (!blur_sigma_px || move_px > kCentred_px) {
    moveToEdge(result);
    if (!fitFromNear(gray, side, cell_px, pixels, fit)) return std::nullopt;
  }
  if (std::sqrt(fit.covariance.trace()) > kLargestEdgeSigma_px) return std::nullopt;
  return result;
}

/// A straight line across . p = distance through the fitted side's ends, where the bulge is zero.
struct Line {
  Vector2d across;
  double distance;
};
Line lineOf(const FittedSide& fitted) {
  const auto& [side, fit] = fitted;
  const Vector2d first = side.middle - side.half_length * side.along + fit.position(-1.0) * side.across;
  const Vector2d second = side.middle + side.half_length * side.along + fit.position(1.0) * side.across;
  const Side line(first, second);
  return {line.across, line.across.dot(first)};
}

/// The fitted ends of the two sides lie near the corner, so there the bulge is small; it is added all the
/// same.
Vector2d intersect(const FittedSide& a, const FittedSide& b) {
  const Line line_a = lineOf(a), line_b = lineOf(b);
  Eigen::Matrix2d N;
  N << line_a.across.transpose(), line_b.across.transpose();
  const Eigen::Matrix2d inverse = N.inverse();
  const Vector2d corner = inverse * Vector2d(line_a.distance, line_b.distance);
  const auto bulge = [&](const FittedSide& f) {
    return f.side.bulgeAt(f.side.along.dot(corner - f.side.middle) / f.side.half_length);
  };
  return corner + inverse * Vector2d(bulge(a), bulge(b));
}

}  // namespace

std::array<double, 4> sides_px(const std::array<Vector2d, 4>& corners_px) {
  std::array<double, 4> sides{};
  for (std::size_t k = 0; k < 4; ++k) sides[k] = (corners_px[(k + 1) % 4] - corners_px[k]).norm();
  return sides;
}

double Detection::sigma_px() const { return std::sqrt(covariance_px2.trace() / 8.0); }

std::optional<RefinedCorners> refineCorners(const cv::Mat& gray, const std::array<Vector2d, 4>& rough_px,
                                            double cell_px, const CameraModel* camera,
                                            const std::optional<double>& blur_sigma_px) {
  std::vector<FittedSide> sides;
  std::vector<Pixel> pixels;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto fitted =
        fitSide(gray, rough_px[k], rough_px[(k + 1) % 4], cell_px, camera, blur_sigma_px, pixels);
    if (!fitted) return std::nullopt;
    sides.push_back(*fitted);
  }

  // Corner k joins sides k-1 and k. J: d(corners) / d(offset and turn of side 0, of side 1, …).
  RefinedCorners result{};
  Matrix8d J = Matrix8d::Zero(), edges = Matrix8d::Zero();
  for (std::size_t k = 0; k < 4; ++k) {
    const FittedSide &before = sides[(k + 3) % 4], &after = sides[k];
    const auto row = static_cast<Eigen::Index>(2 * k);
    Eigen::Matrix2d N;
    N << before.side.across.transpose(), after.side.across.transpose();
    if (std::abs(N.determinant()) < 0.05) return std::nullopt;
    result.corners_px[k] = intersect(before, after);
    const Eigen::Matrix2d inverse = N.inverse();
    const auto column_before = static_cast<Eigen::Index>(2 * ((k + 3) % 4));
    J.block<2, 1>(row, column_before) = inverse.col(0);
    J.block<2, 1>(row, column_before + 1) = inverse.col(0);  // the corner is at its s = 1
    J.block<2, 1>(row, row) = inverse.col(1);
    J.block<2, 1>(row, row + 1) = -inverse.col(1);  // and at s = -1 of the next
    edges.block<2, 2>(row, row) = after.fit.covariance;
    result.contrast += 0.25 * std::abs(2.0 * after.fit.p[EdgeFit::step0]);
    result.blur_sigma_px += 0.25 * std::exp(after.fit.p[EdgeFit::log_sigma]);
  }
  const double model_sigma_px = modelSigma_px(cell_px, result.blur_sigma_px);
  result.covariance_px2 = J * edges * J.transpose() + model_sigma_px * model_sigma_px * Matrix8d::Identity();
  return result;
}

}  // namespace fathom
