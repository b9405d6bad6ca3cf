#pragma once

#include <map>
#include <vector>

#include "localization/error_state_filter.h"

namespace fathom {

/// Rauch-Tung-Striebel smoother on the filter's manifold (Rauch, Tung & Striebel 1965; errors composed by [+]
/// and
/// [-]): the filter's own motion model run backwards over its record. Keeps one state and one packed
/// covariance a step: 2.4 kB for 15 states, 3.6 kB for 23.
///
/// Attached poses are states that do not move. One that is attached at a step says nothing of the time before
/// that the motion at that step does not say. Coordinates that started anew (a pose that was reset) are known
/// to be unrelated to what they were, so nothing is carried back through them.
template <int N>
class Smoother {
 public:
  using Filter = ErrorStateFilter<N>;

  /// The filter after all updates at time t_s; times increase.
  /// `anew`: error coordinates (motion, then six of each attached pose) that do not follow from the record
  /// before.
  void record(double t_s, const Filter& filter, const std::vector<int>& anew = {});
  /// All of the record so far is to be in a new frame, as if it had been in it from the start.
  void moveFrame(const FrameMove& move);
  std::size_t size() const { return times_.size(); }
  double time(std::size_t k) const { return times_[k]; }
  const NavigationState<double>& state(std::size_t k) const { return states_[k]; }
  typename Filter::Matrix covariance(std::size_t k) const;

  /// Replaces the record by its smoothed values. progress is called with the share done, from the end.
  /// `noise_at` gives the process noise at a filtered state, the k-th of the record.
  template <class NoiseAt, class F>
  void smooth(const NoiseAt& noise_at, F&& progress);

 private:
  Filter filterAt(std::size_t k) const;
  void keep(std::size_t k, const Filter& filter);
  void moveFrames();
  void smoothStep(std::size_t k, const ProcessNoise& noise);
  void setCovariance(std::size_t k, const typename Filter::Matrix& P);

  static constexpr std::size_t kPacked = N * (N + 1) / 2;
  std::vector<double> times_;
  std::vector<NavigationState<double>> states_;
  std::vector<double> packed_;                     ///< lower triangles
  std::map<std::size_t, AttachedPoses> attached_;  ///< of the steps that have any
  std::map<std::size_t, std::vector<int>> anew_;   ///< of the steps that have any
  std::map<std::size_t, FrameMove> moves_;         ///< of the frame, before the step
};

template <int N>
template <class NoiseAt, class F>
void Smoother<N>::smooth(const NoiseAt& noise_at, F&& progress) {
  moveFrames();
  for (std::size_t k = size(); k-- > 0;) {
    if (k + 1 < size()) smoothStep(k, noise_at(k, states_[k]));
    if (k % 1000 == 0) progress(1.0 - static_cast<double>(k) / static_cast<double>(size()));
  }
}

extern template class Smoother<kCoreSize>;
extern template class Smoother<kFullSize>;

}  // namespace fathom
