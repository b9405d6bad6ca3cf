#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace fathom {

namespace detail {
/// Indices 0 to count - 1 in order; `before` is called with `values`.
std::vector<std::size_t> stableOrder(std::size_t count, const void* values,
                                     bool (*before)(const void* values, std::size_t a, std::size_t b));
}  // namespace detail

/// std::stable_sort, which each type and order would compile anew: here it sorts their indices.
template <class T, class Before>
void stableSort(std::vector<T>& values, const Before& before) {
  const auto indexBefore = [&](std::size_t a, std::size_t b) { return before(values[a], values[b]); };
  using IndexBefore = decltype(indexBefore);
  std::vector<std::size_t> from =
      detail::stableOrder(values.size(), &indexBefore, [](const void* less, std::size_t a, std::size_t b) {
        return (*static_cast<const IndexBefore*>(less))(a, b);
      });
  for (std::size_t first = 0; first < from.size(); ++first) {
    if (from[first] == first) continue;
    T held = std::move(values[first]);
    std::size_t at = first;
    while (from[at] != first) {
      values[at] = std::move(values[from[at]]);
      at = std::exchange(from[at], at);
    }
    values[at] = std::move(held);
    from[at] = at;
  }
}

}  // namespace fathom
