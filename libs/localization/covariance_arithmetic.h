#pragma once

#include <algorithm>

#include "localization/covariance_blocks.h"

/// The kernels, written on four rows at a time: `Four` is a vector of the compiler's, or whatever else
/// computes like one. All is inlined into whoever calls, and so compiled for the caller's instructions.
namespace fathom::kernels {

#define FATHOM_INLINE [[gnu::always_inline]] inline

using FourDoubles = double __attribute__((vector_size(32), may_alias));

/// Columns of so many fours each.
template <class Four, int Fours>
struct Columns {
  Four* first;
  FATHOM_INLINE Four* operator[](int k) const { return first + k * Fours; }
  FATHOM_INLINE double& at(int i, int j) const { return reinterpret_cast<double*>(first)[4 * Fours * j + i]; }
};

/// Four rows of four columns, the other way round.
template <class Four>
FATHOM_INLINE void transpose(Four (&m)[4]) {
  const Four a = __builtin_shufflevector(m[0], m[1], 0, 4, 2, 6);
  const Four b = __builtin_shufflevector(m[0], m[1], 1, 5, 3, 7);
  const Four c = __builtin_shufflevector(m[2], m[3], 0, 4, 2, 6);
  const Four d = __builtin_shufflevector(m[2], m[3], 1, 5, 3, 7);
  m[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  m[1] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  m[2] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  m[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

/// The first columns of `to` from the rows of `from`, as many as it has, at fours `a` of rows and `b` of
/// columns.
template <int Count, class Four, int FoursFrom, int FoursTo>
FATHOM_INLINE void copyTransposed(Columns<Four, FoursFrom> from, Columns<Four, FoursTo> to, int a, int b) {
  Four block[4];
  for (int k = 0; k < 4; ++k) block[k] = from[4 * b + k][a];
  transpose(block);
  for (int k = 0; k < Count; ++k) to[4 * a + k][b] = block[k];
}

/// What is above the diagonal in four rows, at four `b`, becomes the mirror image of what is below it in as
/// many columns.
template <int N, int b, class Four, int Fours>
FATHOM_INLINE void mirrorFour(Columns<Four, Fours> P) {
  constexpr int kWhole = N / 4, kLast = N % 4, kOnDiagonal = b < kWhole ? 4 : kLast;
  if constexpr (b + 1 < kWhole) copyTransposed<4>(P, P, b + 1, b);
  if constexpr (b + 2 < kWhole) copyTransposed<4>(P, P, b + 2, b);
  if constexpr (b + 3 < kWhole) copyTransposed<4>(P, P, b + 3, b);
  if constexpr (b + 4 < kWhole) copyTransposed<4>(P, P, b + 4, b);
  if constexpr (b < kWhole && kLast != 0) copyTransposed<kLast>(P, P, kWhole, b);
  for (int j = 0; j < kOnDiagonal; ++j)
    for (int i = 0; i < j; ++i) P.at(4 * b + i, 4 * b + j) = P.at(4 * b + j, 4 * b + i);
}

/// The upper triangle of the first N columns becomes the lower one's mirror image. (Written out, since loops
/// of few and varying turns are not unrolled.)
template <int N, class Four, int Fours>
FATHOM_INLINE void mirrorLower(Columns<Four, Fours> P) {
  static_assert(N <= 24);
  mirrorFour<N, 0>(P);
  mirrorFour<N, 1>(P);
  mirrorFour<N, 2>(P);
  if constexpr (N > 12) mirrorFour<N, 3>(P);
  if constexpr (N > 16) mirrorFour<N, 4>(P);
  if constexpr (N > 20) mirrorFour<N, 5>(P);
}

/// B F^T in place, for B's rows four by four.
template <class Four, int Fours>
FATHOM_INLINE void timesTransitionTransposed(Columns<Four, Fours> B, const TransitionBlocks& F) {
  const double half_square = 0.5 * F.dt * F.dt;
  for (int p = 0; p < Fours; ++p) {
    Four angle[3], velocity[3], rate[3], push[3], way[3];
    for (int k = 0; k < 3; ++k) {
      angle[k] = B[kOrientation + k][p];
      velocity[k] = B[kVelocity + k][p];
      rate[k] = B[kAngularVelocity + k][p];
      push[k] = B[kAcceleration + k][p];
      way[k] = velocity[k] * F.dt + push[k] * half_square;
    }
    for (int j = 0; j < 3; ++j) {
      Four position = B[kPosition + j][p] + angle[0] * F.position_orientation(j, 0);
      position += angle[1] * F.position_orientation(j, 1);
      position += angle[2] * F.position_orientation(j, 2);
      Four turned = angle[0] * F.back(j, 0);
      turned += angle[1] * F.back(j, 1);
      turned += angle[2] * F.back(j, 2);
      Four moved = velocity[0] * F.back(j, 0);
      moved += velocity[1] * F.back(j, 1);
      moved += velocity[2] * F.back(j, 2);
      for (int k = 0; k < 3; ++k) {
        position += way[k] * F.position_way(j, k);
        turned += rate[k] * F.rate_to_angle(j, k);
        moved += rate[k] * F.rate_to_velocity(j, k);
        moved += push[k] * F.half_back(j, k);
      }
      B[kPosition + j][p] = position;
      B[kOrientation + j][p] = turned;
      B[kVelocity + j][p] = moved;
    }
  }
}

template <int N>
FATHOM_INLINE void addToDiagonal(double* P, const double* q) {
  for (int i = 0; i < N; ++i) P[i * (N + 2)] += q[i];
}

/// Rows and columns of the biases.
template <class Four, int N>
FATHOM_INLINE void decayBiases(double* P, double decay) {
  constexpr int kRows = N + 1, kEnd = kAccelerometerBias + 3;
  for (int j = 0; j < N; ++j) {
    const double column = j >= kGyroBias && j < kEnd ? decay : 1.0;
    for (int i = 0; i < N; ++i) P[j * kRows + i] *= i >= kGyroBias && i < kEnd ? column * decay : column;
  }
}

template <class Four, int N>
FATHOM_INLINE void propagate(double* P, const TransitionBlocks& F, const double* q, double decay) {
  constexpr int kFours = (N + 1) / 4, kMoved = 9, kMovedFours = 3;
  addToDiagonal<N>(P, q);
  if constexpr (N == kFullSize) decayBiases<Four, N>(P, decay);
  const Columns<Four, kFours> columns{reinterpret_cast<Four*>(P)};
  timesTransitionTransposed(columns, F);  // P F^T; its rows from nine on are final

  // The first nine, transposed, once more: (F (P F^T))^T.
  alignas(32) double numbers[4 * kMovedFours * (N + 1)];
  const Columns<Four, kMovedFours> rows{reinterpret_cast<Four*>(numbers)};
  for (int a = 0; a < kFours; ++a)
    for (int b = 0; b < kMovedFours; ++b) copyTransposed<4>(columns, rows, a, b);
  timesTransitionTransposed(rows, F);
  for (int j = 0; j < N; ++j) {
    columns[j][0] = rows[j][0];
    columns[j][1] = rows[j][1];
    columns.at(8, j) = rows.at(8, j);
  }
  mirrorLower<kMoved>(columns);
  addToDiagonal<N>(P, q);
}

template <class Four, int N>
FATHOM_INLINE void project(const double* P, const StateColumns& columns, const double* H, Border<N>& border) {
  constexpr int kFours = (N + 1) / 4;
  const Columns<const Four, kFours> from{reinterpret_cast<const Four*>(P)};
  for (int i = 0; i < border.size; ++i) {
    Four sum[kFours];
    for (int p = 0; p < kFours; ++p) sum[p] = from[columns.list[0]][p] * H[i];
    for (int k = 1; k < columns.count; ++k)
      for (int p = 0; p < kFours; ++p)
        sum[p] += from[columns.list[static_cast<std::size_t>(k)]][p] * H[k * border.size + i];
    auto* column = reinterpret_cast<Four*>(border.column(i));
    for (int p = 0; p < kFours; ++p) column[p] = sum[p];
  }
}

template <class Four, int N>
FATHOM_INLINE bool eliminate(Border<N>& border) {
  constexpr int kFours = (N + 1) / 4, kFoursOfS = Border<N>::kMost / 4;
  const Columns<Four, kFours> W{reinterpret_cast<Four*>(border.rows.data())};
  const Columns<Four, kFoursOfS> S{reinterpret_cast<Four*>(border.S.data())};
  const int fours = (border.size + 3) / 4;
  std::array<double, Border<N>::kMost> least;
  for (int j = 0; j < border.size; ++j) least[j] = Border<N>::kLeast * border.columnOfS(j)[j];
  for (int j = 0; j < border.size; ++j) {
    const double pivot = border.columnOfS(j)[j];
    if (!(pivot > least[j])) return false;
    border.reciprocal[j] = 1.0 / pivot;
    for (int k = j + 1; k < border.size; ++k) {
      const double factor = border.columnOfS(j)[k] * border.reciprocal[j];
      for (int p = k / 4; p < fours; ++p) S[k][p] -= S[j][p] * factor;
      for (int p = 0; p < kFours; ++p) W[k][p] -= W[j][p] * factor;
    }
  }
  return true;
}

/// P(:, first … first + 3) -= W D^-1 W^T, from row `first` on.
template <class Four, int N, int First>
FATHOM_INLINE void subtractColumns(double* P, const Border<N>& border) {
  constexpr int kFours = (N + 1) / 4, kFirstFour = First / 4, kCount = First + 4 <= N ? 4 : N - First;
  const Columns<Four, kFours> columns{reinterpret_cast<Four*>(P)};
  const Columns<const Four, kFours> W{reinterpret_cast<const Four*>(border.rows.data())};
  for (int j = First; j < First + kCount; ++j) {
    Four sum[kFours];
    for (int p = kFirstFour; p < kFours; ++p) sum[p] = columns[j][p];
    for (int i = 0; i < border.size; ++i) {
      const double factor = border.rows[i * (N + 1) + j] * border.reciprocal[i];
      for (int p = kFirstFour; p < kFours; ++p) sum[p] -= W[i][p] * factor;
    }
    for (int p = kFirstFour; p < kFours; ++p) columns[j][p] = sum[p];
  }
}

template <class Four, int N>
FATHOM_INLINE void subtract(double* P, const Border<N>& border) {
  subtractColumns<Four, N, 0>(P, border);
  subtractColumns<Four, N, 4>(P, border);
  subtractColumns<Four, N, 8>(P, border);
  subtractColumns<Four, N, 12>(P, border);
  if constexpr (N == kFullSize) {
    subtractColumns<Four, N, 16>(P, border);
    subtractColumns<Four, N, 20>(P, border);
  }
}

template <class Four, int N>
FATHOM_INLINE void turn(double* P, const Matrix3d& G) {
  constexpr int kFours = (N + 1) / 4;
  const auto at = [P](int i, int j) -> double& { return P[j * (N + 1) + i]; };
  const auto turnRows = [&](int j) {  // the orientation's, of one column
    const double a = at(kOrientation, j), b = at(kOrientation + 1, j), c = at(kOrientation + 2, j);
    for (int i = 0; i < 3; ++i) at(kOrientation + i, j) = G(i, 0) * a + G(i, 1) * b + G(i, 2) * c;
  };
  for (int j = 0; j < 3; ++j) {
    turnRows(j);
    for (int i = j + 1; i < 3; ++i)
      at(kOrientation + j, kOrientation + i) = at(kOrientation + i, kOrientation + j);
  }
  const Columns<Four, kFours> angle{reinterpret_cast<Four*>(P + kOrientation * (N + 1))};
  for (int p = 0; p < kFours; ++p) {
    const Four a = angle[0][p], b = angle[1][p], c = angle[2][p];
    for (int j = 0; j < 3; ++j) {
      Four sum = a * G(j, 0);
      sum += b * G(j, 1);
      sum += c * G(j, 2);
      angle[j][p] = sum;
    }
  }
  for (int j = kOrientation; j < kOrientation + 3; ++j) turnRows(j);
  for (int j = 0; j < N; ++j) at(N, j) = 0.0;
  mirrorLower<N>(Columns<Four, kFours>{reinterpret_cast<Four*>(P)});
}

}  // namespace fathom::kernels
