#pragma once

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/random.h"
#include "effects/registry.h"
#include "imaging/forward_scatter.h"
#include "imaging/water.h"
#include "sensors/vehicle.h"

/// The camera's forward model after the clean rendering: light at the scene -> through the water -> exposure
/// -> the sensor's numbers. The scalar functions are the model; ImageModel runs it over whole images.
///
/// Radiances are linear red, green, blue, and 1 is the camera's full scale.
namespace fathom {

/// Radiance at the camera of a scene point of radiance `scene`, z_m away along the optical axis and range_m
/// along the line of sight. Both infinite where nothing is hit: then it is the veil. t_s: the image's time
/// stamp, since the recording's first entry.
template <class T>
Vector3<T> predictLight(const SceneRadiance<T>& scene, const T& z_m, const T& range_m,
                        const WaterColumn<T>& water, const EffectParameters<T>& effects, double t_s = 0,
                        const SightInScene<T>& sight = {}) {
  using std::exp, std::isfinite;
  if (!isfinite(z_m)) return water.veil;
  const Vector3<T> depth = water.attenuation_per_m * z_m;
  WaterRay<T> ray{t_s, z_m, range_m, depth, depth, Vector3<T>::Zero(), sight};
  applyEffects(effects, t_s, ray);
  Vector3<T> light;
  for (int c = 0; c < 3; ++c) {
    const T straight = exp(-ray.signal_depth[c]), bent = exp(ray.bends[c] - ray.signal_depth[c]) - straight;
    light[c] = straight * scene.own[c] + bent * scene.bent(c, ray.bends[c]) +
               (1.0 - exp(-ray.veil_depth[c])) * water.veil[c];
  }
  return light;
}

template <class T>
T clampedShare(const T& share) {
  return share <= T(0) ? T(0) : share >= T(1) ? T(1) : share;
}

/// What a curve makes of light from 0 to 1 in one colour.
template <class T>
T curved(const T& light, const ResponseCurve<T>& curve, int colour) {
  using std::pow;
  const T plain = pow(light, curve.exponent);
  return plain + curve.bend[colour] * plain * (T(1) - plain);
}

/// The reading as a share of full scale, from 0 to 1, of a radiance (0 or more) at a pixel, in one colour.
template <class T>
T predictReading(const T& radiance, const PixelResponse<T>& response, const ResponseCurve<T>& curve,
                 int colour) {
  const T exposed = response.gain[colour] * radiance;
  if (exposed <= T(0)) return clampedShare(response.offset[colour]);
  return clampedShare(
      T((exposed >= T(1) ? T(1.0) : curved(exposed, curve, colour)) + response.offset[colour]));
}

/// Its inverse: the radiance of a reading. 0 where no light reads so little; what is clipped comes back as
/// the least that is. Of a bend within +-1, by which the curve rises everywhere.
inline double radianceBehind(double reading, const PixelResponse<double>& response,
                             const ResponseCurve<double>& curve, int colour) {
  const double bent = std::clamp(reading - response.offset[colour], 0.0, 1.0), b = curve.bend[colour];
  const double plain = 2 * bent / (1 + b + std::sqrt((1 + b) * (1 + b) - 4 * b * bent));
  return std::pow(plain, 1 / curve.exponent) / response.gain[colour];
}

/// Sigma of a radiance as the sensor sees it, before the response: electrons count with the variance of
/// Poisson's law, plus read noise.
inline double radianceSigma(double radiance, const CameraSheet& sheet) {
  return std::sqrt(radiance * sheet.full_well_e + sheet.read_noise_e * sheet.read_noise_e) /
         sheet.full_well_e;
}

/// How much light one more of an image's numbers is at a radiance, without effects: the response's slope,
/// inverted. Darker and brighter than from 0.001 to 1 as there.
double radianceStep(double radiance, const CameraSheet& sheet);

/// Sigma of a pixel's radiance: the sensor's noise, and that of rounding to whole numbers.
double pixelSigma(double radiance, const CameraSheet& sheet);

/// The radiance that a number in an image stands for; the inverse of the response without noise or effects.
double radianceOf(int number, const CameraSheet& sheet);
/// The same for an image as cv::imread() gives it (blue, green, red): CV_32FC3, red, green, blue.
cv::Mat radianceOf(const cv::Mat& image_bgr, const CameraSheet& sheet);

/// Each pixel's line of sight, unit length, camera frame: CV_32FC3. Takes 0.2 s at 640 x 480.
cv::Mat raysOf(const CameraModel& camera);

/// Its cosine to the optical axis, by which z follows from range: CV_32FC1. Takes as long.
cv::Mat cosinesOf(const CameraModel& camera);

/// Light in which white has grown over black by so many pixels at every edge (negative: black over white):
/// its level lines have moved by so much, colour by colour. CV_32FC3.
cv::Mat whiteGrown(const cv::Mat& light, double by_px);

/// Light of which so large a share is strewn evenly over the image. CV_32FC3.
cv::Mat withStrayLight(const cv::Mat& light, double share);

/// Light of which regions of the image are covered, see ViewCover. CV_32FC3.
cv::Mat covered(const cv::Mat& light, const EffectParameters<double>& effects, double t_s);

/// Light through a lens that is out of focus: blurred by a normal curve. CV_32FC3.
cv::Mat defocused(const cv::Mat& light, double variance_px2);

/// Readings (CV_32FC3, red green blue) of which so large a share is what a Bayer pattern's neighbours have:
/// of rows and columns from 0, red where both are even, blue where both are odd, green elsewhere; what a
/// pixel does not measure is the mean of the two or four nearest that do.
cv::Mat interpolatedColours(const cv::Mat& readings, double share);

/// Readings (CV_32F, 0 to 1, any number of colours) after unsharp masking, see Sharpening; clipped.
cv::Mat sharpened(const cv::Mat& readings, double amount);

/// The model over whole images. Const and without hidden state, so threads may share one; an image is the
/// same whoever makes it.
class ImageModel {
 public:
  explicit ImageModel(const CameraSheet& sheet, const Water& water,
                      const EffectParameters<double>& effects = {});

  /// The same camera in another water; cheap.
  ImageModel in(const Water& water) const {
    ImageModel other = *this;
    other.water_ = water;
    return other;
  }

  /// The same camera at another place, from where the map has the first panel, in odom axes; cheap.
  ImageModel at(const Pose& T_scene_camera) const {
    ImageModel other = *this;
    other.T_scene_camera_ = T_scene_camera;
    return other;
  }

  /// The same camera with other effects; cheap.
  ImageModel with(const EffectParameters<double>& effects) const {
    ImageModel other = *this;
    other.effects_ = effects;
    return other;
  }

  /// raysOf() the camera.
  const cv::Mat& rays() const { return rays_; }

  /// Through the water. `radiance` (CV_32FC3) and `range_m` (CV_32FC1, infinite where nothing is hit) are a
  /// View, see render/renderer.h. Without effects exp() is approximated to 3e-7 of the light.
  cv::Mat light(const cv::Mat& radiance, const cv::Mat& range_m, double t_s = 0) const {
    cv::Mat result = radiance.clone();
    throughWater(result, range_m, t_s);
    return result;
  }
  /// The same in place: `light` comes as the radiance.
  void throughWater(cv::Mat& light, const cv::Mat& range_m, double t_s = 0) const;

  /// The sensor: edges where it has them, shot and read noise, clipping, response, interpolation of colours,
  /// rounding to the sheet's bits. Blue, green, red, as cv::imwrite() wants it; CV_8UC3, or CV_16UC3 where
  /// there are more than 8 bits. Poisson's law is taken as a normal one of the same variance: good where
  /// electrons are many, and read noise hides the rest. The normal numbers come from a table of 65536 and so
  /// end at 4.3 sigma. Without `noise`: none.
  cv::Mat expose(const cv::Mat& light, Random* noise, double t_s = 0) const;

 private:
  void throughWaterWithEffects(cv::Mat& light, const cv::Mat& range_m, double t_s) const;
  struct RowResponse;
  void respondAlong(int row, double t_s, RowResponse& response) const;

  CameraSheet sheet_;
  Water water_;
  EffectParameters<double> effects_;
  std::optional<Pose> T_scene_camera_;
  cv::Mat rays_;  ///< raysOf() the camera
};

}  // namespace fathom
