#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

namespace fathom {

/// The upper of the two middle values where their count is even. At least one value.
template <class T>
T upperMedian(std::vector<T> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace fathom
