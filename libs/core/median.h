#pragma once

#include <algorithm>
#include <iterator>
#include <utility>
#include <vector>

namespace fathom {

/// The upper of the two middle values where their count is even. At least one value.
template <class T>
T upperMedian(std::vector<T> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Of absolute values of what is normally distributed about nothing: its sigma, which outliers hardly move.
inline double sigmaByMedian(std::vector<double> absolute) {
  constexpr double kMedianOfNormal = 0.67449;  // of its absolute values, in sigmas
  return upperMedian(std::move(absolute)) / kMedianOfNormal;
}

}  // namespace fathom
