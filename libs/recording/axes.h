#pragma once

#include <array>
#include <string>
#include <vector>

#include "core/geometry.h"

namespace fathom {

/// One of the 48 ways to name and sign three perpendicular axes: result[i] = sign[i] * vector[source[i]].
struct SignedAxes {
  std::array<int, 3> source{0, 1, 2};
  std::array<int, 3> sign{1, 1, 1};

  Matrix3d matrix() const;
  bool proper() const { return matrix().determinant() > 0; }  ///< a rotation, not a mirror
  std::string text() const;                                   ///< "(x, -y, z)"
  bool operator==(const SignedAxes&) const = default;
};

/// All 48.
std::vector<SignedAxes> allAxes();

struct AxesScore {
  SignedAxes axes;
  double log_likelihood = 0.0;  ///< up to a constant that is the same for all axes
  Vector3d residual_rms = Vector3d::Zero();
};

/// Compares what a sensor should have read, in known axes, with what it read, in unknown ones. Keeps sums
/// only, so a long recording costs no memory.
class AxesEvidence {
 public:
  void add(const Vector3d& expected, const Vector3d& measured);
  std::size_t count() const { return count_; }
  /// Of all axes together; zero of nothing.
  double expectedRms() const;
  /// Residuals expected - axes(measured) are taken as Gaussian with an unknown sigma on each axis:
  /// log likelihood = -N sum ln(RMS). All 48, best first; of equals, the less changed comes first.
  std::vector<AxesScore> ranking() const;

 private:
  std::size_t count_ = 0;
  Matrix3d product_ = Matrix3d::Zero();  // sum of expected measured^T
  Vector3d expected_squared_ = Vector3d::Zero(), measured_squared_ = Vector3d::Zero();
};

/// The evidence below which nothing is changed: the residuals' product must shrink by a tenth at least.
constexpr double kDecisiveRatio = 1.1;

}  // namespace fathom
