#pragma once

#include <cstddef>
#include <vector>

namespace fathom {

/// So many of them, in their order: the middle ones of as many equal pieces. All, where there are no more.
template <class T>
std::vector<T> evenly(const std::vector<T>& all, std::size_t count) {
  if (all.size() <= count) return all;
  std::vector<T> some;
  for (std::size_t k = 0; k < count; ++k) some.push_back(all[(2 * k + 1) * all.size() / (2 * count)]);
  return some;
}

}  // namespace fathom
