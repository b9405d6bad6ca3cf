#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "core/camera_model.h"
#include "core/geometry.h"

/// Light that the water bends by a small angle arrives all the same, from beside where it comes from: as if
/// it came from a scene that is blurred. Each bend, anywhere on the way, shifts what is seen by a share of
/// its angle, uniform from 0 to 1; there are as many as Poisson's law has of a mean n, and at least one. So
/// the blur's variance is kBend_rad² / 3 times n / (1 - exp(-n)), which is about 1 + n / 2.
///
/// Source: Jaffe 1990, eqs. 8 and 9, with the blur a normal one.
namespace fathom {

inline constexpr double kBend_rad = 0.035;  ///< standard deviation a bend, of either axis

/// Blurs, by how many times kBend_rad² / 3 their variance is, in between of which others are interpolated.
inline constexpr std::array kBlurs{1.0, 2.0};

/// Radiance of a point of the scene, and around it with each of the blurs.
template <class T>
struct SceneRadiance {
  Vector3<T> own;
  std::array<Vector3<T>, kBlurs.size()> around;

  /// Of what is like its surroundings.
  SceneRadiance(const Vector3<T>& radiance) : own(radiance) { around.fill(radiance); }  // NOLINT
  SceneRadiance(const Vector3<T>& radiance, const std::array<Vector3<T>, kBlurs.size()>& blurred)
      : own(radiance), around(blurred) {}

  /// Of one colour, where light has been bent n times in the mean; to a percent up to n = 2.
  T bent(int colour, const T& n) const {
    const T blur = 1.0 + n / 2.0 + n * n / 12.0;
    return around[0][colour] +
           (blur - kBlurs[0]) / (kBlurs[1] - kBlurs[0]) * (around[1][colour] - around[0][colour]);
  }
};

/// A view's radiance (CV_32F, any number of colours) with one of the blurs; beyond its edges all is as at its
/// edges.
cv::Mat blurred(const cv::Mat& radiance, const CameraModel& camera, double blur);

}  // namespace fathom
