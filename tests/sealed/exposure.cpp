#include "exposure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "ordinary.h"

namespace fathom::sealed {
namespace {

constexpr double kPixelScatter = 0.005;  // EMVA 1288: photo response non-uniformity of a good sensor
constexpr double kBlotchSigma_px = 70;
constexpr double kCoverEdge_px = 15;
constexpr double kCornerRadius = 0.72;  // at which `corner_loss` is stated

template <class Change>
void changeAll(cv::Mat3f& light, const Change& change) {
  for (int row = 0; row < light.rows; ++row)
    for (int column = 0; column < light.cols; ++column) change(row, column, light(row, column));
}

/// Of even light, sum 1: each pixel has the share of the disc that lies in it.
cv::Mat1d discOf(double radius_px) {
  constexpr int kFine = 20;
  const int reach = static_cast<int>(std::ceil(radius_px + 0.5));
  cv::Mat1d disc = cv::Mat1d::zeros(2 * reach + 1, 2 * reach + 1);
  for (int row = 0; row < kFine * disc.rows; ++row)
    for (int column = 0; column < kFine * disc.cols; ++column) {
      const double down = (row + 0.5) / kFine - reach - 0.5, right = (column + 0.5) / kFine - reach - 0.5;
      if (down * down + right * right <= radius_px * radius_px) disc(row / kFine, column / kFine) += 1;
    }
  return disc / std::max(1.0, cv::sum(disc)[0]);
}

/// To the right.
double varianceOf(const cv::Mat1d& kernel) {
  double variance = 0;
  for (int row = 0; row < kernel.rows; ++row)
    for (int column = 0; column < kernel.cols; ++column)
      variance += kernel(row, column) * std::pow(column - kernel.cols / 2, 2);
  return variance;
}

}  // namespace

Exposure::Exposure(const Vehicle& vehicle, const SealedCase& sealed)
    : vehicle_(vehicle),
      sealed_(sealed),
      sensitivity_(vehicle.camera.height_px, vehicle.camera.width_px, cv::Vec3f(1, 1, 1)),
      response_(ordinaryField(sealed, kOrdinary.response, kOrdinary.response_length_dn, Stream::response),
                {0, 0}, {300, 0}, 1) {
  Random place = stream(sealed.seed, Stream::blotch);
  const double x = place.uniform(0.3, 0.7), y = place.uniform(0.3, 0.7);
  blotch_ = {x * vehicle.camera.width_px, y * vehicle.camera.height_px};
  addFlatField();
  if (!sealed.rich) return;
  Random random = stream(sealed.seed, Stream::pixel_response);
  changeAll(sensitivity_, [&](int, int, cv::Vec3f& pixel) {
    for (int c = 0; c < 3; ++c) pixel[c] += static_cast<float>(kPixelScatter * random.normal());
  });
}

void Exposure::addFlatField() {
  const double length_px = kOrdinary.flat_field_length * vehicle_.camera.width_px;
  const SmoothField field = ordinaryField(sealed_, kOrdinary.flat_field, length_px, Stream::flat_field);
  if (field.isZero()) return;
  changeAll(sensitivity_, [&](int row, int column, cv::Vec3f& pixel) {
    pixel *= static_cast<float>(1 + field.at(Vector3d(column, row, 0)));
  });
}

/// What no number in the case says: an image by itself is a little brighter or darker than others.
double Exposure::ordinaryLogGain(double stamp_s) const {
  if (sealed_.ordinary == 0) return 0;
  return sealed_.ordinary * kOrdinary.gain * streamAt(sealed_.seed, Stream::gain, stamp_s).normal();
}

/// A smooth dark spot, as of growth on the window.
void Exposure::passPort(cv::Mat3f& light) const {
  const double depth = sealed_.outsideSize("port-blotch");
  if (depth == 0) return;
  changeAll(light, [&](int row, int column, cv::Vec3f& pixel) {
    const double off_px2 = (Vector2d(column, row) - blotch_).squaredNorm();
    pixel *= static_cast<float>(1 - depth * std::exp(-off_px2 / (2 * kBlotchSigma_px * kBlotchSigma_px)));
  });
}

/// Out of focus, and so with soft edges: a shadow that falls off as the error function does.
void Exposure::coverView(cv::Mat3f& light, double stamp_s) const {
  const double covered = sealed_.number("occlusion", "covered", stamp_s);
  if (covered == 0) return;
  const auto at = [&](const char* side) { return sealed_.number("occlusion", side, stamp_s); };
  const auto within = [](double place_px, double from_px, double to_px) {
    return 0.5 *
           (std::erf((place_px - from_px) / kCoverEdge_px) - std::erf((place_px - to_px) / kCoverEdge_px));
  };
  const double left_px = at("left") * light.cols, right_px = at("right") * light.cols,
               top_px = at("top") * light.rows, bottom_px = at("bottom") * light.rows;
  const auto brightness = static_cast<float>(at("brightness"));
  changeAll(light, [&](int row, int column, cv::Vec3f& pixel) {
    const auto share = static_cast<float>(covered * within(column + 0.5, left_px, right_px) *
                                          within(row + 0.5, top_px, bottom_px));
    pixel = (1 - share) * pixel + cv::Vec3f::all(share * brightness);
  });
}

/// A point becomes a disc of even light (geometrical optics: the aperture's picture), of the radius at which
/// its variance in whole pixels is as stated.
void Exposure::spreadPoints(cv::Mat3f& light, double stamp_s) const {
  const double blur_px = sealed_.number("defocus", "blur_px", stamp_s);
  if (blur_px == 0) return;
  double low_px = 0, high_px = 4 * blur_px + 2;
  for (int round = 0; round < 40; ++round) {
    const double middle_px = (low_px + high_px) / 2;
    (varianceOf(discOf(middle_px)) < blur_px * blur_px ? low_px : high_px) = middle_px;
  }
  cv::filter2D(light, light, -1, discOf(high_px), {-1, -1}, 0, cv::BORDER_REFLECT_101);
}

/// Inner surfaces reflect some of all that comes in once more, to anywhere.
void Exposure::strewLight(cv::Mat3f& light, double stamp_s) const {
  const double share = sealed_.number("veiling-glare", "glare_share", stamp_s);
  if (share == 0) return;
  const cv::Scalar mean = cv::mean(light);
  const cv::Vec3f strewn(static_cast<float>(share * mean[0]), static_cast<float>(share * mean[1]),
                         static_cast<float>(share * mean[2]));
  changeAll(light,
            [&](int, int, cv::Vec3f& pixel) { pixel = pixel * static_cast<float>(1 - share) + strewn; });
}

/// Natural fall: a power of the cosine of the angle to the axis (Kingslake 1992, ch. 6: the fourth, of a thin
/// lens), that which loses as much as stated where it is stated.
void Exposure::passLens(cv::Mat3f& light, const SightLines& sight, double stamp_s) const {
  const double loss = sealed_.number("vignetting", "corner_loss", stamp_s);
  if (loss == 0) return;
  const double power = std::log(1 - loss) / std::log(1 + kCornerRadius * kCornerRadius);
  changeAll(light, [&](int row, int column, cv::Vec3f& pixel) {
    const Vector3d direction = sight.at({column, row}).direction;
    pixel *= static_cast<float>(std::pow(1 + direction.head<2>().squaredNorm(), power));
  });
}

/// A slope over the image; and colours' gains of this image.
void Exposure::weighColours(cv::Mat3f& light, const SightLines& sight, double stamp_s) const {
  if (const HiddenEffect* field = sealed_.find("flat-field", stamp_s)) {
    const std::vector<double>& slope = field->parameters.find("slope")->second;
    changeAll(light, [&](int row, int column, cv::Vec3f& pixel) {
      const Vector3d direction = sight.at({column, row}).direction;
      pixel *= static_cast<float>(std::exp(slope[0] * direction.x() + slope[1] * direction.y()));
    });
  }
  if (!sealed_.find("white-balance", stamp_s)) return;
  const Vector3d spread = sealed_.vector("white-balance", "log_gain_sd", stamp_s);
  Random random = streamAt(sealed_.seed, Stream::colours, stamp_s);
  const Array3d gain = (spread.array() * random.normal3().array()).exp();
  changeAll(light, [&](int, int, cv::Vec3f& pixel) {
    for (int c = 0; c < 3; ++c) pixel[c] *= static_cast<float>(gain[c]);
  });
}

/// Shot noise and read noise (EMVA 1288, release 4, sec. 2), at the sensor's full well.
void Exposure::countElectrons(cv::Mat3f& light, Random& random) const {
  const double full_well_e = vehicle_.camera.full_well_e, read_noise_e = vehicle_.camera.read_noise_e;
  changeAll(light, [&](int row, int column, cv::Vec3f& pixel) {
    for (int c = 0; c < 3; ++c) {
      double electrons = std::max(0.0f, pixel[c] * sensitivity_(row, column)[c]) * full_well_e;
      if (sealed_.noise) electrons += std::sqrt(electrons + read_noise_e * read_noise_e) * random.normal();
      pixel[c] = static_cast<float>(std::clamp(electrons / full_well_e, 0.0, 1.0));
    }
  });
}

/// Behind a mosaic of filters, red green over green blue, a pixel measures one colour; each other one is the
/// mean of the nearest pixels that measure it, beside it or, where there is none, at its corners.
void Exposure::mosaic(cv::Mat3f& light, double stamp_s) const {
  const auto share = static_cast<float>(sealed_.number("demosaicing", "interpolated", stamp_s));
  if (share == 0) return;
  const cv::Mat3f full = light.clone();
  const auto measures = [](int row, int column) { return (row & 1) + (column & 1); };  // 0 red, 2 blue
  const auto meanBeside = [&](int row, int column, int c, bool at_corners) {
    float sum = 0;
    int count = 0;
    for (int down = -1; down <= 1; ++down)
      for (int right = -1; right <= 1; ++right) {
        const int r = row + down, k = column + right;
        const bool is_corner = down != 0 && right != 0;
        const bool is_inside = r >= 0 && k >= 0 && r < full.rows && k < full.cols;
        if (!is_inside || is_corner != at_corners || measures(r, k) != c) continue;
        sum += full(r, k)[c];
        ++count;
      }
    return count > 0 ? std::optional(sum / static_cast<float>(count)) : std::nullopt;
  };
  changeAll(light, [&](int row, int column, cv::Vec3f& pixel) {
    for (int c = 0; c < 3; ++c) {
      if (measures(row, column) == c) continue;
      auto other = meanBeside(row, column, c, false);
      if (!other) other = meanBeside(row, column, c, true);
      pixel[c] += share * (*other - pixel[c]);
    }
  });
}

/// Written and read as JPEG. libjpeg scales the standard's tables by 200 - 2 quality percent, of qualities
/// below 50 by 5000 / quality.
cv::Mat3b Exposure::compressed(const cv::Mat3b& image, double stamp_s) const {
  const double percent = 100 * sealed_.number("image-compression", "table_scale", stamp_s);
  if (percent == 0) return image;
  const double quality = percent > 100 ? 5000 / percent : (200 - percent) / 2;
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes,
               {cv::IMWRITE_JPEG_QUALITY, static_cast<int>(std::clamp(std::lround(quality), 1L, 100L))});
  return cv::imdecode(bytes, cv::IMREAD_COLOR);
}

/// Unsharp masking of readings, with the binomial of four steps each way for the blurred copy: its variance
/// is 1 px^2.
cv::Mat3d Exposure::sharpened(const cv::Mat3d& readings, double stamp_s) const {
  const double amount = sealed_.number("sharpening", "amount", stamp_s);
  if (amount == 0) return readings;
  const cv::Mat1d binomial = (cv::Mat1d(1, 5) << 1, 4, 6, 4, 1) / 16.0;
  cv::Mat3d soft;
  cv::sepFilter2D(readings, soft, -1, binomial, binomial, {-1, -1}, 0, cv::BORDER_REFLECT_101);
  return readings + amount * (readings - soft);
}

/// DN = 255 (L^g + offset), bent by colour, sharpened, off by what is ordinary, rounded.
cv::Mat3b Exposure::respond(const cv::Mat3f& light, double stamp_s) const {
  const double exponent =
      vehicle_.camera.response_gamma * (1 + sealed_.number("gamma", "exponent_error", stamp_s));
  const double by_colour = sealed_.outsideSize("response-by-colour");
  const std::array<double, 3> exponents{exponent * (1 + by_colour), exponent, exponent * (1 - by_colour)};
  const double offset = sealed_.number("dark-offset", "offset_share", stamp_s);
  Vector3d bend = Vector3d::Zero();
  if (sealed_.find("response-curve", stamp_s)) bend = sealed_.vector("response-curve", "bend", stamp_s);
  cv::Mat3d readings(light.size());
  for (int row = 0; row < light.rows; ++row)
    for (int column = 0; column < light.cols; ++column)
      for (int c = 0; c < 3; ++c) {
        const double l = light(row, column)[c], power = exponents[static_cast<std::size_t>(c)];
        const double r = power == 1 ? l : std::pow(l, power);
        readings(row, column)[c] = r + bend[c] * r * (1 - r) + offset;
      }
  readings = sharpened(readings, stamp_s);
  cv::Mat3b image(light.size());
  for (int row = 0; row < light.rows; ++row)
    for (int column = 0; column < light.cols; ++column)
      for (int c = 0; c < 3; ++c) {
        double dn = 255 * readings(row, column)[c];
        if (!response_.isZero()) dn *= 1 + response_.at(dn, 0);
        image(row, column)[2 - c] = static_cast<std::uint8_t>(std::clamp(std::lround(dn), 0L, 255L));
      }
  return image;
}

cv::Mat3b Exposure::expose(const cv::Mat3f& light, const SightLines& sight, double stamp_s, double log_gain,
                           Random& random) const {
  cv::Mat3f at_sensor = light.clone();
  coverView(at_sensor, stamp_s);
  passPort(at_sensor);
  passLens(at_sensor, sight, stamp_s);
  spreadPoints(at_sensor, stamp_s);
  strewLight(at_sensor, stamp_s);
  weighColours(at_sensor, sight, stamp_s);
  at_sensor *=
      std::exp(log_gain * sealed_.number("auto-exposure", "log_gain_sd", stamp_s) + ordinaryLogGain(stamp_s));
  countElectrons(at_sensor, random);
  mosaic(at_sensor, stamp_s);
  return compressed(respond(at_sensor, stamp_s), stamp_s);
}

}  // namespace fathom::sealed
