#pragma once

#include <cstddef>

namespace fathom {

namespace detail {
void parallelFor(std::size_t count, const void* body, void (*call)(const void* body, std::size_t i));
}  // namespace detail

/// Calls body(i) for each i from 0 to count - 1, on all cores; what it throws ends all. tbb::parallel_for(),
/// which each body would compile anew.
template <class Index, class Body>
void parallelFor(Index count, const Body& body) {
  detail::parallelFor(static_cast<std::size_t>(count), &body, [](const void* own, std::size_t i) {
    (*static_cast<const Body*>(own))(static_cast<Index>(i));
  });
}

/// Calls both, side by side where there is more than one core; what one throws ends both. Not
/// tbb::parallel_invoke(), which is left half done where a loop around it ends.
template <class First, class Second>
void bothAtOnce(const First& first, const Second& second) {
  parallelFor(2, [&](int i) {
    if (i == 0)
      first();
    else
      second();
  });
}

}  // namespace fathom
