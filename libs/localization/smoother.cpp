#include "localization/smoother.h"

#include <optional>

#include "core/linear_algebra.h"

namespace fathom {

template <int N>
void Smoother<N>::record(double t_s, const Filter& filter, const std::vector<int>& anew) {
  times_.push_back(t_s);
  states_.push_back(filter.x);
  packed_.resize(packed_.size() + kPacked);
  setCovariance(size() - 1, filter.P);
  if (!filter.attached.T_odom.empty()) attached_.emplace_hint(attached_.end(), size() - 1, filter.attached);
  if (!anew.empty()) anew_.emplace_hint(anew_.end(), size() - 1, anew);
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
auto Smoother<N>::filterAt(std::size_t k) const -> Filter {
  Filter filter;
  filter.x = states_[k];
  filter.P = covariance(k);
  if (const auto found = attached_.find(k); found != attached_.end()) filter.attached = found->second;
  return filter;
}

template <int N>
void Smoother<N>::keep(std::size_t k, const Filter& filter) {
  states_[k] = filter.x;
  setCovariance(k, filter.P);
  if (attached_.contains(k)) attached_.at(k) = filter.attached;
}

template <int N>
void Smoother<N>::moveFrame(const FrameMove& move) {
  const auto [at, is_first] = moves_.try_emplace(size(), move);
  if (!is_first) at->second = move.after(at->second);
}

template <int N>
void Smoother<N>::moveFrames() {
  std::optional<FrameMove> move;  // by all that came later
  for (std::size_t k = size(); k-- > 0;) {
    if (const auto found = moves_.find(k + 1); found != moves_.end())
      move = move ? move->after(found->second) : found->second;
    if (!move) continue;
    Filter filter = filterAt(k);
    filter.moveFrame(*move);
    keep(k, filter);
  }
}

template <int N>
void Smoother<N>::smoothStep(std::size_t k, const ProcessNoise& noise) {
  // The filter's prediction from k to k + 1, made again, with the product of its transitions. Sizes are those
  // of the motion and of what is attached; they cost little beside the products.
  Filter now = filterAt(k), predicted = now;
  const Filter next = filterAt(k + 1);
  const Eigen::MatrixXd P = now.wholeCovariance();
  const Eigen::Index size = P.rows();
  Eigen::MatrixXd F;  // of the motion: what is attached stands still
  const double dt = times_[k + 1] - times_[k];
  const int steps = std::max(1, static_cast<int>(std::ceil(dt / kMaximumStep_s - 1e-9)));
  for (int i = 0; i < steps; ++i) {
    const Eigen::MatrixXd transition = Filter::transition(predicted.x, dt / steps, noise);
    F = i == 0 ? transition : Eigen::MatrixXd(transition * F);
    predicted.predict(dt / steps, noise);
  }

  // Over what the next step shares with this one: rows of what started anew carry nothing.
  Eigen::MatrixXd P_predicted = predicted.wholeCovariance(), FP = P;
  FP.topRows(N) = F * P.topRows(N);
  if (const auto anew = anew_.find(k + 1); anew != anew_.end())
    for (const int row : anew->second)
      if (row < size) {
        P_predicted.row(row).setZero();
        P_predicted.col(row).setZero();
        P_predicted(row, row) = 1.0;
        FP.row(row).setZero();
      }
  // Gain G = P F^T P_predicted^-1. LDLT copes with the exact zeros of states that are switched off.
  const Eigen::MatrixXd G = solveSymmetric(P_predicted, FP).transpose();
  Eigen::VectorXd delta(size);
  delta.head<N>() = difference<N>(next.x, predicted.x);
  for (std::size_t i = 0; i < now.attached.T_odom.size(); ++i)
    delta.segment<6>(N + 6 * static_cast<Eigen::Index>(i)) =
        poseDifference(predicted.attached.T_odom[i], next.attached.T_odom[i]);
  const Eigen::VectorXd correction = G * delta;
  retract<N>(now.x, correction.head<N>());
  for (std::size_t i = 0; i < now.attached.T_odom.size(); ++i) {
    const auto row = N + 6 * static_cast<Eigen::Index>(i);
    Pose& pose = now.attached.T_odom[i];
    pose.position += correction.segment<3>(row);
    pose.rotation = pose.rotation * expSO3<double>(correction.segment<3>(row + 3));
  }
  now.setWholeCovariance(P + G * (next.wholeCovariance().topLeftCorner(size, size) - P_predicted) *
                                 G.transpose());
  keep(k, now);
}

template class Smoother<kCoreSize>;
template class Smoother<kFullSize>;

}  // namespace fathom
