#pragma once

#include <algorithm>
#include <array>

#include "core/geometry.h"
#include "localization/navigation_state.h"

/// The arithmetic of ErrorStateFilter on covariances. P is symmetric to the last bit before and after; its
/// columns have N + 1 rows in memory (PaddedMatrix), of which the last, hidden one is zero.
///
/// Two sets of the processor's instructions are compiled, and the larger one that it has is chosen at start.
/// That one's fused multiply-adds round once where others round twice: on one machine the same input gives
/// the same bytes, between machines of the two kinds results differ by rounding.
/// Used within this room only.
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

/// P is PaddedMatrix::padded().
template <int N>
struct CovarianceKernels {
  /// P becomes G (P + diag q) G^T + diag q, q being half of a step's noise, G the motion's F and, where there
  /// are biases (N = 23), their decay.
  void (*propagate)(double* P, const TransitionBlocks& F, const double* q, double decay);
  /// The border's first N rows: P H^T, for an H of M rows against the listed columns, column after column.
  void (*project)(const double* P, const StateColumns& columns, const double* H, Border<N>& border);
  /// The border's columns become W = [P H^T; r^T] L^-T. Whether it came to its end: not where a pivot in D is
  /// less than Border::kLeast of the variance in S, or no number.
  bool (*eliminate)(Border<N>& border);
  /// P - W D^-1 W^T in the lower triangle; what is above it is left undefined. What comes out in the hidden
  /// row is minus the correction K r.
  void (*subtract)(double* P, const Border<N>& border);
  /// The orientation's error is turned: P becomes G P G^T, G the identity but for that block. Of P the lower
  /// triangle is given; whole after, and its hidden row zero.
  void (*turn)(double* P, const Matrix3d& G);
};

enum class Instructions {
  base,  ///< every processor's
  wide,  ///< AVX2 and FMA
};
bool processorHas(Instructions instructions);
template <int N>
const CovarianceKernels<N>& covarianceKernels(Instructions instructions);
/// The best that this processor has.
template <int N>
const CovarianceKernels<N>& fastestKernels();

}  // namespace fathom
