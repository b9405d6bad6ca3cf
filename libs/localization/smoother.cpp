#include "localization/smoother.h"

namespace fathom {

template <int N>
void Smoother<N>::record(double t_s, const Filter& filter) {
  times_.push_back(t_s);
  states_.push_back(filter.x);
  packed_.resize(packed_.size() + kPacked);
  setCovariance(size() - 1, filter.P);
}

template <int N>
void Smoother<N>::setCovariance(std::size_t k, const typename Filter::Matrix& P) {
  double* out = packed_.data() + k * kPacked;
  for (int column = 0; column < N; ++column)
    for (int row = column; row < N; ++row) *out++ = P(row, column);
}

template <int N>
auto Smoother<N>::covariance(std::size_t k) const -> typename Filter::Matrix {
  typename Filter::Matrix P;
  const double* in = packed_.data() + k * kPacked;
  for (int column = 0; column < N; ++column)
    for (int row = column; row < N; ++row) P(row, column) = P(column, row) = *in++;
  return P;
}

template <int N>
void Smoother<N>::smoothStep(std::size_t k, const ProcessNoise& noise) {
  // The filter's prediction from k to k + 1, made again, with the product of its transitions.
  const typename Filter::Matrix P = covariance(k);
  Filter predicted;
  predicted.x = states_[k];
  predicted.P = P;
  typename Filter::Matrix F = Filter::Matrix::Identity();
  const double dt = times_[k + 1] - times_[k];
  const int steps = std::max(1, static_cast<int>(std::ceil(dt / kMaximumStep_s - 1e-9)));
  for (int i = 0; i < steps; ++i) {
    F = (Filter::transition(predicted.x, dt / steps, noise) * F).eval();
    predicted.predict(dt / steps, noise);
  }

  // Gain G = P F^T P_predicted^-1. LDLT copes with the exact zeros of states that are switched off.
  const typename Filter::Matrix G = predicted.P.ldlt().solve(F * P).transpose();
  const typename Filter::Vector delta = difference<N>(states_[k + 1], predicted.x);
  retract<N>(states_[k], G * delta);
  const typename Filter::Matrix smoothed = P + G * (covariance(k + 1) - predicted.P) * G.transpose();
  setCovariance(k, 0.5 * (smoothed + smoothed.transpose()));
}

template class Smoother<kCoreSize>;
template class Smoother<kFullSize>;

}  // namespace fathom
