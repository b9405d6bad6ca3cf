#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "core/camera_model.h"
#include "core/geometry.h"

/// Light that the water bends by a small angle arrives all the same, from beside where it comes from: as if
/// it came from a scene that is blurred. Each bend, anywhere on the way, shifts what is seen by a share of
/// its angle, uniform from 0 to 1; there are as many as Poisson's law has of a mean n, and at least one.
/// Light that is bent once is blurred by the mean of normal curves of all widths up to a bend's, which has a
/// sharp middle: a third of it stays within a third of the angle. Several bends add up to a normal curve with
/// a third of the square of each.
///
/// Source: Jaffe 1990, eqs. 8 and 9; Wells 1973 (small angles along a path).
namespace fathom {

inline constexpr double kBend_rad = 0.035;  ///< standard deviation a bend, of either axis

/// So many bends are blurs that are made; of others in between they are interpolated.
inline constexpr std::array kBends{1, 2, 4};

/// What is around a point, with each of the blurs: colours x blurs.
template <class T>
using Surroundings = Eigen::Matrix<T, 3, static_cast<int>(kBends.size())>;

/// Radiance of a point of the scene, and around it.
template <class T>
struct SceneRadiance {
  Vector3<T> own;
  Surroundings<T> around;

  /// Of what is like its surroundings.
  SceneRadiance(const Vector3<T>& radiance)  // NOLINT
      : own(radiance), around(radiance.rowwise().replicate(kBends.size())) {}
  SceneRadiance(const Vector3<T>& radiance, const Surroundings<T>& blurred)
      : own(radiance), around(blurred) {}

  /// Of one colour, where light has been bent n times in the mean; to a percent up to n = 2. By Poisson's
  /// law n / (exp(n) - 1) of what is bent is bent once, the other 2 + n / 3 + n² / 18 times in the mean.
  T bent(int colour, const T& n) const {
    const T once = 1.0 - n / 2.0 + n * n / 12.0 * (1.0 - n * n / 60.0);
    const T beyond_two = n / 3.0 + n * n / 18.0;
    const double slope = 1.0 / (kBends[2] - kBends[1]);
    const T several = around(colour, 1) + slope * beyond_two * (around(colour, 2) - around(colour, 1));
    return once * around(colour, 0) + (1.0 - once) * several;
  }
};

/// A view's radiance (CV_32F, any number of colours) as light shows it that was bent so many times; beyond
/// its edges all is as at its edges.
cv::Mat bentLight(const cv::Mat& radiance, const CameraModel& camera, int bends);

}  // namespace fathom
