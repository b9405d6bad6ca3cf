#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/geometry.h"

namespace fathom {

/// A sampled vector signal, straight lines between the samples, constant outside.
class SampledSignal {
 public:
  /// Times in s, ascending, one a value; at least one.
  SampledSignal(const std::vector<double>& time_s, std::vector<Vector3d> value)
      : time_(time_s), value_(std::move(value)) {}

  Vector3d at(double t) const {
    const auto after = std::upper_bound(time_.begin(), time_.end(), t);
    if (after == time_.begin()) return value_.front();
    if (after == time_.end()) return value_.back();
    const auto k = static_cast<std::size_t>(after - time_.begin());
    const double share = (t - time_[k - 1]) / (time_[k] - time_[k - 1]);
    return (1.0 - share) * value_[k - 1] + share * value_[k];
  }
  /// Whether an interval lies within the samples.
  bool covers(double from, double to) const { return from >= time_.front() && to <= time_.back(); }

  /// Its integral from the first sample on, by trapezia.
  SampledSignal integral() const {
    std::vector<Vector3d> sum{Vector3d::Zero()};
    for (std::size_t k = 1; k < value_.size(); ++k)
      sum.emplace_back(sum.back() + 0.5 * (time_[k] - time_[k - 1]) * (value_[k] + value_[k - 1]));
    return {time_, std::move(sum)};
  }

 private:
  std::vector<double> time_;
  std::vector<Vector3d> value_;
};

}  // namespace fathom
