#include "bent_light.h"

#include <cmath>
#include <opencv2/imgproc.hpp>

namespace fathom::sealed {
namespace {

constexpr double kBend_deg = 2.0;  // standard deviation in each direction, as narrow as Petzold 1972 measured
constexpr int kPlaces = 6;         // of a single bend, along the way
constexpr double kNarrowest_px = 0.3;

/// A wide blur is made of an image of fewer pixels, which is as smooth: taking means of squares of `coarser`
/// pixels and linear interpolation between them add a quarter of its square to the variance.
cv::Mat3f blurred(const cv::Mat3f& image, double sigma_px) {
  if (sigma_px < kNarrowest_px) return image;
  const int coarser = sigma_px > 8 ? 4 : sigma_px > 4 ? 2 : 1;
  const double left_px2 = sigma_px * sigma_px - (coarser > 1 ? coarser * coarser / 4.0 : 0.0);
  cv::Mat3f result = image.clone();
  if (coarser > 1) cv::resize(image, result, image.size() / coarser, 0, 0, cv::INTER_AREA);
  const double sigma_coarse = std::sqrt(left_px2) / coarser;
  cv::GaussianBlur(result, result, {}, sigma_coarse, sigma_coarse, cv::BORDER_REFLECT_101);
  if (coarser > 1) cv::resize(result, result, image.size(), 0, 0, cv::INTER_LINEAR);
  return result;
}

}  // namespace

/// A bend at the share u of the way from the scene shifts light by u of its angle, as the camera sees it,
/// whatever the range: of a single one, any u is as likely, which makes a kernel with a sharp middle. Those
/// of several bends add up to a normal curve, with a third of each one's variance (Wells 1973).
cv::Mat3f withBentLight(const Picture& picture, const Camera& camera) {
  cv::Mat3f light = picture.scene[0] + picture.veil;
  if (picture.scene.size() == 1) return light;
  const double bend_px = radians(kBend_deg) * camera.fx_px;
  for (int place = 0; place < kPlaces; ++place)
    light += blurred(picture.scene[1], bend_px * (place + 0.5) / kPlaces) / kPlaces;
  light += blurred(picture.scene[2], bend_px * std::sqrt(2.0 / 3.0));
  light += blurred(picture.scene[3], bend_px * std::sqrt(3.3 / 3.0));  // three bends, and a few more
  return light;
}

}  // namespace fathom::sealed
