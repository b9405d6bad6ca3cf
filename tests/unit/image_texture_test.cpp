// Texture of noise: nothing where noise is alike everywhere, and what an independent Bayer pattern and
// OpenCV's JPEG leave in it.
#include "observables/image_texture.h"

#include <gtest/gtest.h>

#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/random.h"
#include "effects/image_compression.h"
#include "imaging/image_model.h"

namespace fathom {
namespace {

const cv::Size kTextureSize_px(640, 480);

/// The default sheet's camera before plain surfaces: readings before they are rounded, blue green red.
struct PlainScene {
  double noise = 1;        ///< times what the sheet says
  double soft_px = 0;      ///< noise is blurred by so much
  double slope_dn = 0.04;  ///< largest, a pixel
  double bright_dn = 90;

  cv::Mat readings(std::uint64_t seed) const {
    Random random(seed);
    cv::Mat image(kTextureSize_px, CV_64FC3), errors(kTextureSize_px, CV_64FC3);
    const double phase = random.uniform(0, 8);
    for (int v = 0; v < kTextureSize_px.height; ++v)
      for (int u = 0; u < kTextureSize_px.width; ++u) {
        const double bright =
            bright_dn + phase + 20 * std::sin(u * slope_dn / 20) + 20 * std::sin(v * slope_dn / 20);
        image.at<cv::Vec3d>(v, u) = {0.9 * bright, bright, 0.8 * bright};
        for (int c = 0; c < 3; ++c) errors.at<cv::Vec3d>(v, u)[c] = noise * random.normal();
      }
    if (soft_px > 0) cv::GaussianBlur(errors, errors, {}, soft_px);
    const CameraSheet sheet;
    for (auto pixel = image.begin<cv::Vec3d>(); pixel != image.end<cv::Vec3d>(); ++pixel)
      for (int c = 0; c < 3; ++c) {
        const double electrons = (*pixel)[c] / 255 * sheet.full_well_e;
        const double sigma_e = std::sqrt(electrons + sheet.read_noise_e * sheet.read_noise_e);
        (*pixel)[c] += 255 / sheet.full_well_e * sigma_e * errors.at<cv::Vec3d>(pixel.pos())[c];
      }
    return image;
  }
};

cv::Mat inNumbers(const cv::Mat& readings) {
  cv::Mat image;
  readings.convertTo(image, CV_8U);
  return image;
}

/// Of some images, all of whose pixels are of one surface.
std::vector<ImageTexture> texturesOf(const PlainScene& scene,
                                     const std::function<cv::Mat(const cv::Mat&)>& camera, int images = 12) {
  const cv::Mat mask(kTextureSize_px, CV_8UC1, cv::Scalar(255)),
      labels(kTextureSize_px, CV_32SC1, cv::Scalar(3));
  std::vector<ImageTexture> textures;
  for (int i = 0; i < images; ++i)
    textures.push_back(
        measureTexture(camera(scene.readings(static_cast<std::uint64_t>(i + 1))), mask, labels, CameraSheet())
            .value());
  return textures;
}

Eigen::Vector2d meanTexture(const std::vector<ImageTexture>& textures) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const ImageTexture& texture : textures)
    mean += texture.log_ratio / static_cast<double>(textures.size());
  return mean;
}

struct NoiseCase {
  const char* name;
  PlainScene scene;
};
class NoiseAlikeEverywhere : public testing::TestWithParam<NoiseCase> {};

// Whatever its size and spectrum, and on a slope too: each mean is zero within 3 of its sigmas, and readings
// scatter as they say. Of 12 images a mean square is within a factor of 2.5 in 99.9 % of cases; where noise
// is correlated sigmas hold all the same, since they are from squares.
TEST_P(NoiseAlikeEverywhere, ShowsNeither) {
  const auto textures = texturesOf(GetParam().scene, inNumbers);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
  const double count = static_cast<double>(textures.size());
  for (const ImageTexture& texture : textures) {
    const Eigen::Vector2d z = texture.log_ratio.cwiseQuotient(texture.sigma);
    sum += z / std::sqrt(count);
    squares += z.cwiseAbs2() / count;
    EXPECT_LT(texture.sigma.maxCoeff(), 0.03);
  }
  EXPECT_LT(sum.cwiseAbs().maxCoeff(), 3) << sum.transpose();
  EXPECT_LT(squares.maxCoeff(), 2.5) << squares.transpose();
}
INSTANTIATE_TEST_SUITE_P(ImageTexture, NoiseAlikeEverywhere,
                         testing::Values(NoiseCase{"plain", {}}, NoiseCase{"strong", {.noise = 3}},
                                         NoiseCase{"soft", {.noise = 4, .soft_px = 1}},
                                         NoiseCase{"steep", {.slope_dn = 0.3}},
                                         NoiseCase{"dark", {.slope_dn = 0, .bright_dn = 12}}),
                         [](const auto& info) { return info.param.name; });

/// A colour of a Bayer pattern, pixel by pixel: its own where it measures, else the mean of what does among
/// its eight neighbours, the nearest ones only. green_at: sum of coordinates, modulo two, where green is.
cv::Mat mosaicked(const cv::Mat& readings, double share, int green_at) {
  const auto colourAt = [&](int v, int u) {
    return (v + u) % 2 == green_at ? 1 : v % 2 == 0 ? 2 : 0;  // of blue, green, red
  };
  cv::Mat mixed = readings.clone();
  for (int v = 1; v + 1 < readings.rows; ++v)
    for (int u = 1; u + 1 < readings.cols; ++u)
      for (int c = 0; c < 3; ++c) {
        if (colourAt(v, u) == c) continue;
        double nearest = 9, sum = 0, count = 0;
        for (int dv = -1; dv <= 1; ++dv)
          for (int du = -1; du <= 1; ++du) {
            const double square = dv * dv + du * du;
            if (colourAt(v + dv, u + du) != c || square > nearest) continue;
            if (square < nearest) nearest = square, sum = 0, count = 0;
            sum += readings.at<cv::Vec3d>(v + dv, u + du)[c];
            ++count;
          }
        double& own = mixed.at<cv::Vec3d>(v, u)[c];
        own = (1 - share) * own + share * sum / count;
      }
  return mixed;
}

/// The value from 0 to `most` of which the forward model has what was read, which rises with it.
double valueFound(const std::vector<ImageTexture>& textures, int ratio, double most,
                  const std::function<ImageCoding<double>(double)>& coding) {
  double low = 0, high = most;
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = 0.5 * (low + high);
    double off = 0;
    for (const ImageTexture& texture : textures)
      off += textureOf(texture.noise, coding(middle))[ratio] - texture.log_ratio[ratio];
    (off > 0 ? high : low) = middle;
  }
  return 0.5 * (low + high);
}
ImageCoding<double> interpolatedBy(double share) {
  ImageCoding<double> coding;
  coding.interpolated = share;
  return coding;
}
ImageCoding<double> compressedBy(double table_scale) {
  ImageCoding<double> coding;
  coding.quantum_dn = 16 * table_scale;
  return coding;
}

// Noise of less than a number is rounded to whole ones, which is not quite noise: by half a percent of a
// variance, or 0.02 of the share. Near all of it, where what is left goes with the square of the rest, 0.05.
TEST(ImageTexture, AChessboardTellsHowMuchIsInterpolated) {
  for (const double share : {0.25, 0.5, 1.0}) {
    const auto textures = texturesOf(
        {}, [&](const cv::Mat& readings) { return inNumbers(mosaicked(readings, share, 1)); }, 4);
    EXPECT_NEAR(valueFound(textures, 0, 1, interpolatedBy), share, share < 1 ? 0.02 : 0.05);
    // No blocks, though noise is not white any more.
    EXPECT_LT(std::abs(meanTexture(textures)[1]), 0.01) << share;
  }
}

// The simulator's camera interpolates as the one above, but for the image's rim; float's digits.
TEST(ImageTexture, SimulatedColoursAreInterpolatedAlike) {
  const cv::Mat readings = PlainScene{}.readings(2);
  cv::Mat rgb, simulated, difference;
  readings.convertTo(rgb, CV_32F, 1.0 / 255);
  cv::cvtColor(rgb, rgb, cv::COLOR_BGR2RGB);
  cv::cvtColor(interpolatedColours(rgb, 0.7), simulated, cv::COLOR_RGB2BGR);
  simulated.convertTo(simulated, CV_64F, 255);
  cv::absdiff(simulated, mosaicked(readings, 0.7, 1), difference);
  const cv::Rect inner(1, 1, kTextureSize_px.width - 2, kTextureSize_px.height - 2);
  EXPECT_LT(cv::norm(difference(inner), cv::NORM_INF), 1e-4);
  EXPECT_EQ(cv::norm(interpolatedColours(rgb, 0), rgb, cv::NORM_INF), 0);
}

// A camera whose green pixels are the others.
TEST(ImageTexture, TheOtherChessboardIsFoundFromAllImagesTogether) {
  auto textures = texturesOf(
      {}, [&](const cv::Mat& readings) { return inNumbers(mosaicked(readings, 1, 0)); }, 3);
  EXPECT_LT(meanTexture(textures)[0], -0.5);
  setChessboard(textures);
  EXPECT_NEAR(valueFound(textures, 0, 1, interpolatedBy), 1, 0.05);
}

// Where there is none, no sign is preferred.
TEST(ImageTexture, WithoutAChessboardNothingIsTurned) {
  std::vector<ImageTexture> textures(20);
  Random random(4);
  for (int round = 0; round < 200; ++round) {
    for (ImageTexture& texture : textures) texture.log_ratio[0] = random.normal();
    const Eigen::Vector2d before = meanTexture(textures);
    setChessboard(textures);
    EXPECT_EQ(meanTexture(textures), before);
  }
}

/// As OpenCV writes it and reads it again.
cv::Mat throughOpenCv(const cv::Mat& readings, int quality) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", inNumbers(readings), bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(bytes, cv::IMREAD_COLOR);
}

// The forward model takes noise and slopes as normal, and steps of the table as not rounded: 5 points.
TEST(ImageTexture, BlocksTellTheQuality) {
  for (const PlainScene& scene : {PlainScene{}, PlainScene{.bright_dn = 170}, PlainScene{.slope_dn = 0.08}})
    for (const int quality : {97, 95, 90, 85, 75, 60}) {
      const auto textures = texturesOf(
          scene, [&](const cv::Mat& readings) { return throughOpenCv(readings, quality); }, 3);
      const double scale = valueFound(textures, 1, 2, compressedBy);
      EXPECT_NEAR(ImageCompression::qualityOf(scale), quality, 5)
          << scene.bright_dn << " " << scene.slope_dn << " " << meanTexture(textures).transpose();
    }
}

// Coefficients of the finest waves are rounded to nothing: what is left is less than a tenth.
TEST(ImageTexture, CompressionHidesTheChessboard) {
  const auto plain = texturesOf(
      {}, [&](const cv::Mat& readings) { return inNumbers(mosaicked(readings, 1, 1)); }, 3);
  const auto textures = texturesOf(
      {}, [&](const cv::Mat& readings) { return throughOpenCv(mosaicked(readings, 1, 1), 90); }, 3);
  EXPECT_LT(std::abs(meanTexture(textures)[0]), 0.1 * meanTexture(plain)[0]);
  ImageCoding<double> both = compressedBy(0.2);
  both.interpolated = 1;
  EXPECT_LT(textureOf(textures[0].noise, both)[0], 0.1 * meanTexture(plain)[0]);
}

// Some flakes and hot pixels are too far off to be noise.
TEST(ImageTexture, SpecksDoNotCount) {
  const auto spotted = [](const cv::Mat& readings) {
    cv::Mat image = inNumbers(readings);
    Random random(9);
    for (int i = 0; i < 300; ++i)
      image.at<cv::Vec3b>(static_cast<int>(random.uniform(0, 480)),
                          static_cast<int>(random.uniform(0, 640))) = cv::Vec3b::all(200);
    return image;
  };
  EXPECT_LT((meanTexture(texturesOf({}, spotted, 3)) - meanTexture(texturesOf({}, inNumbers, 3)))
                .cwiseAbs()
                .maxCoeff(),
            0.01);
}

TEST(ImageTexture, IsNotMeasuredWhereThereIsTooLittle) {
  const cv::Mat image = inNumbers(PlainScene().readings(1)), labels(kTextureSize_px, CV_32SC1, cv::Scalar(0));
  cv::Mat mask(kTextureSize_px, CV_8UC1, cv::Scalar(0));
  mask({100, 100, 10, 10}) = 255;
  EXPECT_FALSE(measureTexture(image, mask, labels, CameraSheet()));
  mask = 255;
  EXPECT_FALSE(measureTexture(image, mask, labels - 1, CameraSheet()));
  EXPECT_FALSE(
      measureTexture(cv::Mat(kTextureSize_px, CV_8UC3, cv::Scalar::all(254)), mask, labels, CameraSheet()));
  // An image without any noise has a reading whose sigma is not nothing.
  const auto even =
      measureTexture(cv::Mat(kTextureSize_px, CV_8UC3, cv::Scalar::all(90)), mask, labels, CameraSheet());
  ASSERT_TRUE(even);
  EXPECT_EQ(even->log_ratio.norm(), 0);
  EXPECT_GT(even->sigma.minCoeff(), 1e-3);
}

// The forward model.

TEST(ImageTexture, WithoutCodingThereIsNone) {
  for (const double slope_dn2 : {0.0, 1e-3, 0.1})
    for (const double noise_dn2 : {0.01, 0.5, 10.0}) {
      EXPECT_LT(textureOf<double>({{1, noise_dn2, noise_dn2, slope_dn2}}, {}).norm(), 1e-12);
      const auto steps = roundedSteps<double>(noise_dn2, slope_dn2, 0);
      EXPECT_NEAR(steps.across, steps.within, 1e-9 * steps.within);
    }
}

// Against draws: 200 000 of them know a variance to 0.3 %.
TEST(ImageTexture, ANormalVariableIsRoundedAsDrawn) {
  Random random(3);
  for (const double step : {0.1, 1.0, 2.3, 2.5, 4.0, 7.0}) {
    const RoundedNormal<double> rounding(1.0, step * step);
    double square = 0, product = 0, difference = 0;
    constexpr int kDraws = 200000;
    for (int i = 0; i < kDraws; ++i) {
      const double x = random.normal(), q = step * std::round(x / step);
      square += q * q / kDraws;
      product += q * x / kDraws;
      const double at = random.uniform(0, step), a = at + random.normal(), b = at + random.normal();
      difference += std::pow(step * (std::round(a / step) - std::round(b / step)), 2) / kDraws;
    }
    EXPECT_NEAR(rounding.variance, square, 0.015 + 0.01 * step * step) << step;
    EXPECT_NEAR(rounding.gain, product, 0.02 * (1 + step)) << step;
    EXPECT_NEAR(roundedDifference(2.0, step * step), difference, 0.03 * (1 + step)) << step;
  }
}

// Its two ways of summing up meet.
TEST(ImageTexture, IsWithoutAStepInTheStep) {
  for (const double step2 : {6.0, 0.5}) {
    const RoundedNormal<double> below(1.0, step2 * (1 - 1e-9)), above(1.0, step2 * (1 + 1e-9));
    EXPECT_NEAR(below.variance, above.variance, 1e-7);
    EXPECT_NEAR(below.gain, above.gain, 1e-7);
  }
  for (const double step2 : {64.0, 0.5})
    EXPECT_NEAR(roundedDifference(1.0, step2 * (1 - 1e-9)), roundedDifference(1.0, step2 * (1 + 1e-9)), 1e-6);
}

// A fit that starts from nothing finds its way: the stronger, the larger.
TEST(ImageTexture, BlocksGrowWithCompression) {
  for (const double noise_dn2 : {0.05, 0.2, 0.5, 1.5}) {
    double before = 0;
    for (double scale = 0.01; scale < 1; scale += 0.01) {
      const double now = textureOf({{1, 2 * noise_dn2, noise_dn2, 2e-3}}, compressedBy(scale))[1];
      EXPECT_GT(now, before) << noise_dn2 << " " << scale;
      before = now;
    }
  }
}

TEST(ImageTexture, QualityIsLibjpegs) {
  EXPECT_FALSE(codingQuality({}));
  EXPECT_EQ(codingQuality(compressedBy(0.1)), 95);
  EXPECT_EQ(codingQuality(compressedBy(0.5)), 75);
  EXPECT_EQ(codingQuality(compressedBy(1)), 50);
  EXPECT_EQ(codingQuality(compressedBy(2.5)), 20);
}

}  // namespace
}  // namespace fathom
