#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "core/camera_model.h"
#include "core/random.h"
#include "effects/registry.h"
#include "imaging/water.h"

/// Marine snow: flakes that drift between the camera and the scene. Each is a disc that faces along the
/// optical axis, of one diameter, gray and diffuse, in the same daylight as the scene; lamps do not reach it
/// here. They are strewn by Poisson's law, evenly over the water's volume.
///
/// Source: Alldredge & Silver 1988: aggregates from half a millimetre on, most of those that one sees a few
/// millimetres, the larger the fewer.
namespace fathom {

inline constexpr double kFlakeDiameter_m = 0.003;
inline constexpr double kFlakeReflectance = 0.5;  ///< porous and gray: between the panel's black and white
inline constexpr double kNearestFlake_m = 0.15;   ///< along the optical axis; nearer ones are out of focus

/// Light of a flake z_m away along the optical axis, as it arrives: that of any surface of its reflectance,
/// see predictLight(). red, green, blue.
Vector3d flakeLight(double z_m, const Environment& environment);

/// Pixels for each unit of ideal image coordinates (x/z, y/z) there: their areas' ratio, its root. Not
/// positive where the lens folds the image over.
double focalAt(const Vector2d& ideal, const CameraModel& camera);

/// Share of the pixel (a unit square) at `pixel` that a disc covers.
double coveredShare(const Vector2d& pixel, const Vector2d& centre_px, double radius_px);

/// Draws flakes on light (CV_32FC3, linear red green blue) that has come through the water: those nearer than
/// what the pixel shows, z_m (CV_32FC1, along the optical axis, infinite where nothing is hit). The same ones
/// whenever `random` is. Nothing is drawn of what is too far to change any pixel by half a digital number of
/// eight bits.
void drawSnow(cv::Mat& light, const cv::Mat& z_m, const CameraModel& camera, const Environment& environment,
              double per_m3, Random random);

// What is found of it: specks, which are pixels side by side that are too far off what is behind them.

/// A pixel belongs to a speck where any colour is off by so many of its sigmas. A diagnosis looks at some 1e8
/// numbers: of normal noise 0.2 of them are beyond six, but 57 beyond five.
inline constexpr double kSpeckSigmas = 6;

/// Specks by their number of pixels: 1 to 3, 4 to 15, 16 or more.
inline constexpr int kSpeckClasses = 3;
using BySpeckClass = Eigen::Array<double, kSpeckClasses, 1>;
int speckClass(int pixels);

/// What a pixel shows where no flake is.
struct Backdrop {
  Vector3d light = Vector3d::Zero();  ///< as it arrives
  Vector3d sigma = Vector3d::Ones();  ///< a pixel's noise; infinite for a colour that does not count
  double z_m = 0;                     ///< of the surface
  double focal_px = 0;                ///< see focalAt()
};

/// Volume in which a flake makes a speck, m³, by its number of pixels: 1 to 15, and 16 or more in the last.
inline constexpr int kSpeckPixels = 16;
using BySpeckPixels = Eigen::Array<double, kSpeckPixels, 1>;

/// The volume that one pixel contributes: of the flakes whose middle it sees, from kNearestFlake_m to the
/// surface. Integral of z² / focal² times the probability of such a speck, whose average over where in the
/// pixel the middle is, noise included, is tabulated once over apparent radius and contrast.
BySpeckPixels visibleVolume(const Backdrop& backdrop, const Environment& environment);

/// What an image shows of a density of flakes: a sum over its pixels.
struct SpeckVolumes {
  BySpeckClass visible_m3 = BySpeckClass::Zero();  ///< where a flake makes a speck of that class
  /// Of pairs of flakes: specks of that class which become one with another, and which come of two.
  BySpeckClass merging_m6 = BySpeckClass::Zero(), merged_m6 = BySpeckClass::Zero();

  /// So many pixels more of this volume each, counted for each class by itself.
  void add(const BySpeckPixels& volume_m3, const BySpeckClass& pixels);
  SpeckVolumes& operator+=(const SpeckVolumes& other);
};

/// Mean number of specks of each class. That many flakes overlap is right to second order in the density, and
/// they never become fewer than none.
template <class T>
Eigen::Array<T, kSpeckClasses, 1> expectedSpecks(const SpeckVolumes& volumes, const T& per_m3) {
  using std::exp;
  Eigen::Array<T, kSpeckClasses, 1> count;
  for (int k = 0; k < kSpeckClasses; ++k) {
    const double visible = volumes.visible_m3[k];
    if (visible <= 0) {
      count[k] = per_m3 * per_m3 * volumes.merged_m6[k];
      continue;
    }
    count[k] =
        per_m3 * (visible + per_m3 * volumes.merged_m6[k]) * exp(-per_m3 * (volumes.merging_m6[k] / visible));
  }
  return count;
}

/// What an image showed.
struct ImageSpecks {
  double t_s = 0;  ///< the image's stamp, since the recording's first entry
  std::size_t image = 0, eye = 0;
  BySpeckClass counted = BySpeckClass::Zero();
  BySpeckClass sigma = BySpeckClass::Ones();  ///< of that number
  SpeckVolumes volumes;
};

/// The same of the effects that are on, in an image stamped t_s.
template <class T>
Eigen::Array<T, kSpeckClasses, 1> predictSpecks(const SpeckVolumes& volumes,
                                                const EffectParameters<T>& effects, double t_s) {
  SuspendedParticles<T> particles;
  applyEffects(effects, t_s, particles);
  return expectedSpecks(volumes, particles.per_m3);
}

}  // namespace fathom
