#include "observables/image_texture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "imaging/image_model.h"

namespace fathom {
namespace {

constexpr int kTextureSquare_px = 32;                  // a multiple of the blocks
constexpr double kDarkestGreen = 8, kBrightest = 245;  // means of squares, DN: nothing is clipped
constexpr double kFarOff = 10;                         // sigmas by the camera's sheet
constexpr double kFewestDifferences = 16;  // of an image: the logarithm of their mean is off by 1/16
constexpr double kLeastSpread_px2 = 5000;  // sum of squares about a square's middle for which it has a slope
constexpr double kLevelsPerOctave = 2;     // of noise variances
constexpr double kOtherChessboard = 5;     // sigmas

/// Squared differences of one kind.
struct SquareSum {
  double sum = 0, count = 0;

  void add(double difference) {
    sum += difference * difference;
    ++count;
  }
  double mean() const { return count > 0 ? sum / count : 0; }
};

/// Of the pixels of one label in a square of the image.
struct TextureSquare {
  double count = 0;
  std::array<double, 3> colour{};               ///< sums: blue, green, red
  double u = 0, v = 0, uu = 0, uv = 0, vv = 0;  ///< sums of the pixels' places in the square
  double luma = 0, u_luma = 0, v_luma = 0;      ///< and with brightness
  double green_dn2 = 0, luma_dn2 = 0;           ///< noise variance
  std::array<SquareSum, 2> chessboard, steps;   ///< odd, even; across, within

  bool isWellExposed() const {
    return colour[1] > kDarkestGreen * count &&
           std::all_of(colour.begin(), colour.end(), [&](double sum) { return sum < kBrightest * count; });
  }
  void addPlace(const cv::Point& in_square, double brightness) {
    const double x = in_square.x, y = in_square.y;
    u += x, v += y, uu += x * x, uv += x * y, vv += y * y;
    luma += brightness, u_luma += x * brightness, v_luma += y * brightness;
  }
  /// Mean square slope along an axis of the plane through its pixels; nothing where they are too near each
  /// other.
  std::optional<double> slope_dn2() const {
    const double xx = uu - u * u / count, xy = uv - u * v / count, yy = vv - v * v / count;
    if (std::min(xx, yy) < kLeastSpread_px2) return std::nullopt;
    const double xl = u_luma - u * luma / count, yl = v_luma - v * luma / count;
    const double determinant = xx * yy - xy * xy;
    const double right = (yy * xl - xy * yl) / determinant, down = (xx * yl - xy * xl) / determinant;
    return 0.5 * (right * right + down * down);
  }
};

double lumaOf(const cv::Vec3b& bgr) {
  return kLumaWeights[0] * bgr[2] + kLumaWeights[1] * bgr[1] + kLumaWeights[2] * bgr[0];
}

class TextureMeasurement {
 public:
  TextureMeasurement(const cv::Mat& image, const cv::Mat& mask, const cv::Mat& labels,
                     const CameraSheet& sheet)
      : image_(image), mask_(mask), labels_(labels), sheet_(sheet), plain_blocks_(plainBlocks()) {
    forEachPixel([&](const Key& key) { return &squares_[key]; },
                 [&](const cv::Point& pixel, TextureSquare& square) { addPixel(pixel, square); });
    std::erase_if(squares_, [](const auto& entry) { return !entry.second.isWellExposed(); });
    for (auto& [key, square] : squares_) setNoise(square);
    forEachPixel(
        [&](const Key& key) {
          const auto found = squares_.find(key);
          return found == squares_.end() ? nullptr : &found->second;
        },
        [&](const cv::Point& pixel, TextureSquare& square) { addDifferences(pixel, square); });
  }

  std::optional<ImageTexture> texture() const {
    ImageTexture result;
    const auto chessboard = ratio(&TextureSquare::chessboard, kRoundedCurve_dn2, 1);
    // Where blocks differ they do so all along a border.
    const auto blocks = ratio(&TextureSquare::steps, kRoundedStep_dn2, BlockTransform::kSide);
    if (!chessboard || !blocks) return std::nullopt;
    result.log_ratio = {chessboard->logarithm, blocks->logarithm};
    result.sigma = {chessboard->sigma, blocks->sigma};
    result.noise = noise();
    return result;
  }

 private:
  using Key = std::tuple<int, int, int>;  ///< row, column and label of a square
  struct LogRatio {
    double logarithm = 0, sigma = 0;
  };

  bool counts(const cv::Point& pixel) const {
    return mask_.at<std::uint8_t>(pixel) != 0 && labels_.at<int>(pixel) >= 0;
  }
  bool isOneSurface(const cv::Point& a, const cv::Point& b) const {
    return counts(b) && labels_.at<int>(a) == labels_.at<int>(b);
  }

  /// CV_8UC1, of each block whether all of it counts, so that no edge is in it. Of others compression leaves
  /// rims about the edge all over the block, which are steps within it.
  cv::Mat plainBlocks() const {
    constexpr int kSide = BlockTransform::kSide;
    cv::Mat plain(image_.rows / kSide, image_.cols / kSide, CV_8UC1);
    for (int row = 0; row < plain.rows; ++row)
      for (int column = 0; column < plain.cols; ++column) {
        const cv::Point first(column * kSide, row * kSide);
        bool is_plain = true;
        for (int i = 0; is_plain && i < kSide * kSide; ++i)
          is_plain = counts(first + cv::Point(i % kSide, i / kSide));
        plain.at<std::uint8_t>(row, column) = is_plain ? 1 : 0;
      }
    return plain;
  }
  bool isInPlainBlock(const cv::Point& pixel) const {
    const cv::Point block = pixel / BlockTransform::kSide;
    return block.x < plain_blocks_.cols && block.y < plain_blocks_.rows &&
           plain_blocks_.at<std::uint8_t>(block) != 0;
  }

  /// Those that count and have a square, with it. Neighbours mostly have the same.
  template <class SquareOf, class F>
  void forEachPixel(const SquareOf& squareOf, const F& f) const {
    Key last(-1, -1, -1);
    TextureSquare* square = nullptr;
    for (int v = 0; v < image_.rows; ++v)
      for (int u = 0; u < image_.cols; ++u) {
        const cv::Point pixel(u, v);
        if (!counts(pixel)) continue;
        const Key key(v / kTextureSquare_px, u / kTextureSquare_px, labels_.at<int>(pixel));
        if (key != last) square = squareOf(key);
        last = key;
        if (square != nullptr) f(pixel, *square);
      }
  }

  void addPixel(const cv::Point& pixel, TextureSquare& square) const {
    const cv::Vec3b& bgr = image_.at<cv::Vec3b>(pixel);
    ++square.count;
    for (int c = 0; c < 3; ++c) square.colour[static_cast<std::size_t>(c)] += bgr[c];
    square.addPlace({pixel.x % kTextureSquare_px, pixel.y % kTextureSquare_px}, lumaOf(bgr));
  }

  void setNoise(TextureSquare& square) const {
    for (std::size_t c = 0; c < 3; ++c) {  // blue, green, red
      const int number = static_cast<int>(std::lround(square.colour[c] / square.count));
      const double radiance = radianceOf(number, sheet_);
      const double variance_dn2 =
          std::pow(radianceSigma(radiance, sheet_) / radianceStep(radiance, sheet_), 2);
      square.luma_dn2 += kLumaWeights[2 - c] * kLumaWeights[2 - c] * variance_dn2;
      if (c == 1) square.green_dn2 = variance_dn2;
    }
  }

  /// Of a pixel: its second difference, and its steps to the right and downwards.
  void addDifferences(const cv::Point& pixel, TextureSquare& square) const {
    const cv::Point right(1, 0), down(0, 1);
    const bool inside = pixel.x > 0 && pixel.y > 0 && pixel.x + 1 < image_.cols && pixel.y + 1 < image_.rows;
    if (inside && isOneSurface(pixel, pixel + right) && isOneSurface(pixel, pixel - right) &&
        isOneSurface(pixel, pixel + down) && isOneSurface(pixel, pixel - down)) {
      const double curve = green(pixel + right) + green(pixel - right) + green(pixel + down) +
                           green(pixel - down) - 4 * green(pixel);
      if (curve * curve < kFarOff * kFarOff * 20 * (square.green_dn2 + kRounding_dn2))
        square.chessboard[(pixel.x + pixel.y) % 2 == 1 ? 0 : 1].add(curve);
    }
    const auto addStep = [&](const cv::Point& next, bool is_last) {
      if (!isOneSurface(pixel, next) || !isInPlainBlock(pixel) || !isInPlainBlock(next)) return;
      const double step = lumaOf(image_.at<cv::Vec3b>(next)) - lumaOf(image_.at<cv::Vec3b>(pixel));
      if (step * step < kFarOff * kFarOff * 2 * (square.luma_dn2 + kRounding_dn2))
        square.steps[is_last ? 0 : 1].add(step);
    };
    if (pixel.x + 1 < image_.cols) addStep(pixel + right, (pixel.x + 1) % BlockTransform::kSide == 0);
    if (pixel.y + 1 < image_.rows) addStep(pixel + down, (pixel.y + 1) % BlockTransform::kSide == 0);
  }

  double green(const cv::Point& pixel) const { return image_.at<cv::Vec3b>(pixel)[1]; }

  /// Logarithm of the first's mean over the second's, each with what rounding makes of it. Of the first so
  /// many say the same.
  std::optional<LogRatio> ratio(std::array<SquareSum, 2> TextureSquare::*kind, double rounded_dn2,
                                double together) const {
    SquareSum first, second;
    std::size_t used = 0;
    for (const auto& [key, square] : squares_) {
      const auto& own = square.*kind;
      first.sum += own[0].sum, first.count += own[0].count;
      second.sum += own[1].sum, second.count += own[1].count;
      used += own[0].count > 0 && own[1].count > 0 ? 1U : 0U;
    }
    if (used < 2 || std::min(first.count, second.count) < kFewestDifferences) return std::nullopt;
    double square_sum = 0;
    for (const auto& [key, square] : squares_) {
      const auto part = [&](const SquareSum& own, const SquareSum& all) {
        return (own.sum - all.mean() * own.count) / (all.count * (all.mean() + rounded_dn2));
      };
      square_sum += std::pow(part((square.*kind)[0], first) - part((square.*kind)[1], second), 2);
    }
    const double squares = static_cast<double>(used);
    return LogRatio{std::log((first.mean() + rounded_dn2) / (second.mean() + rounded_dn2)),
                    std::sqrt(std::max(square_sum * squares / (squares - 1),
                                       2 * together / first.count + 2 / second.count))};
  }

  std::vector<NoiseLevel> noise() const {
    struct Level {
      double steps = 0, green = 0, luma = 0, slope = 0, sloping = 0;
    };
    std::map<int, Level> levels;
    double all = 0;
    for (const auto& [key, square] : squares_) {
      const double steps = square.steps[0].count + square.steps[1].count;
      Level& level = levels[static_cast<int>(std::floor(kLevelsPerOctave * std::log2(square.luma_dn2)))];
      all += steps;
      level.steps += steps;
      level.green += steps * square.green_dn2;
      level.luma += steps * square.luma_dn2;
      if (const auto slope = square.slope_dn2()) {
        level.slope += steps * *slope;
        level.sloping += steps;
      }
    }
    std::vector<NoiseLevel> result;
    for (const auto& [octave, level] : levels)
      if (level.steps > 0)
        result.push_back({level.steps / all, level.green / level.steps, level.luma / level.steps,
                          level.sloping > 0 ? level.slope / level.sloping : 0});
    return result;
  }

  const cv::Mat& image_;
  const cv::Mat& mask_;
  const cv::Mat& labels_;
  const CameraSheet& sheet_;
  const cv::Mat plain_blocks_;
  std::map<Key, TextureSquare> squares_;
};

}  // namespace

std::optional<ImageTexture> measureTexture(const cv::Mat& image, const cv::Mat& mask, const cv::Mat& labels,
                                           const CameraSheet& sheet) {
  return TextureMeasurement(image, mask, labels, sheet).texture();
}

void setChessboard(std::vector<ImageTexture>& textures) {
  double sum = 0, information = 0;
  for (const ImageTexture& texture : textures) {
    const double weight = 1 / (texture.sigma[0] * texture.sigma[0]);
    sum += weight * texture.log_ratio[0];
    information += weight;
  }
  if (information == 0 || sum > -kOtherChessboard * std::sqrt(information)) return;
  for (ImageTexture& texture : textures) texture.log_ratio[0] *= -1;
}

}  // namespace fathom
