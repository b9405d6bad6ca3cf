#pragma once

#include "localization/covariance_blocks.h"

/// The arithmetic of ErrorStateFilter on covariances. P is symmetric to the last bit before and after; its
/// columns have N + 1 rows in memory (PaddedMatrix), of which the last, hidden one is zero.
///
/// Two sets of the processor's instructions are compiled, and the larger one that it has is chosen at start.
/// That one's fused multiply-adds round once where others round twice: on one machine the same input gives
/// the same bytes, between machines of the two kinds results differ by rounding.
/// Used within this room only.
namespace fathom {

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
