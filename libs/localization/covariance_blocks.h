#pragma once

#include <algorithm>
#include <array>

#include "core/geometry.h"
#include "localization/navigation_state.h"

/// What the arithmetic on covariances works on. Used within this room only.
namespace fathom {

/// The blocks of the motion's transition Jacobian F that are neither zero nor identity.
struct TransitionBlocks {
  Matrix3d position_orientation;  ///< -R [v dt + a dt²/2]x
  Matrix3d position_way;          ///< R: velocity and acceleration to position, by dt and dt²/2
  Matrix3d back;                  ///< Exp(omega dt)^T: orientation, velocity
  Matrix3d rate_to_angle;         ///< Jr(omega dt) dt
  Matrix3d rate_to_velocity;      ///< d(v')/d(omega)
  Matrix3d half_back;             ///< Exp(omega dt/2)^T dt: acceleration to velocity
  double dt = 0;
};

/// What a reading of M numbers adds to a covariance: columns of [P H^T; r^T], r being the residual, and of
/// the lower triangle of S = H P H^T + R.
template <int N>
struct Border {
  static constexpr int kMost = 16, kRows = N + 1;
  int size = 0;  ///< M
  alignas(32) std::array<double, kMost * kRows> rows;
  alignas(32) std::array<double, kMost * kMost> S;
  std::array<double, kMost> reciprocal;  ///< 1 / D, where S = L D L^T

  void begin(int M) {
    size = M;
    std::fill_n(S.begin(), M * kMost, 0.0);
  }
  double* column(int k) { return rows.data() + k * kRows; }
  double* columnOfS(int k) { return S.data() + k * kMost; }

  /// A pivot that is less than this of a variance: the digits of what it is the difference of are lost.
  static constexpr double kLeast = 1e-6;
  /// Before the elimination: whether the reading's own variances are no less than that beside S.
  template <class Variances>
  bool isModest(const Variances& R) const {
    bool modest = true;
    for (int k = 0; k < size; ++k)
      modest = modest && R[k] > kLeast * S[static_cast<std::size_t>(k * (kMost + 1))];
    return modest;
  }
  /// After it: of S.
  double determinant() const {
    double reciprocals = 1;
    for (int k = 0; k < size; ++k) reciprocals *= reciprocal[static_cast<std::size_t>(k)];
    return 1 / reciprocals;
  }
  /// After it: r^T S^-1 r.
  double nis() const {
    double sum = 0;
    for (int k = 0; k < size; ++k) {
      const double r = rows[static_cast<std::size_t>(k * kRows + N)];
      sum += r * r * reciprocal[static_cast<std::size_t>(k)];
    }
    return sum;
  }
};

}  // namespace fathom
