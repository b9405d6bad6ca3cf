#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "core/scalar.h"

namespace fathom {

/// What is there at t_s of an effect that comes and goes, as a share of its peak: a normal curve about
/// time_s, of standard deviation width_s.
template <class T>
T shareOfPeak(double t_s, const T& time_s, const T& width_s) {
  using std::exp;
  const T away = (t_s - time_s) / width_s;
  return exp(-0.5 * away * away);
}

/// The mean of exp(-|x|^2 / 2) over a straight way that begins at `begin`.
template <class T>
T meanOfGaussian(const Eigen::Matrix<T, 3, 1>& begin, const Eigen::Matrix<T, 3, 1>& way) {
  using std::erf, std::exp, std::sqrt;
  constexpr double kShort = 1e-3;  // the middle is the mean up to its square over 24
  if (valueOf(way.squaredNorm()) < kShort * kShort) return exp(-0.5 * (begin + 0.5 * way).squaredNorm());
  const T length = way.norm();
  const Eigen::Matrix<T, 3, 1> direction = way / length;
  const T along = begin.dot(direction), off_squared = (begin - along * direction).squaredNorm();
  const auto passed = [](const T& at) { return erf(at / std::numbers::sqrt2); };
  return sqrt(std::numbers::pi / 2) / length * exp(-0.5 * off_squared) *
         (passed(along + length) - passed(along));
}

}  // namespace fathom
