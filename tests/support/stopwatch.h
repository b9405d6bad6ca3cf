#pragma once

#include <chrono>

namespace fathom::test {

inline double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// How long a piece of work takes by the clock, s.
template <class Work>
double seconds(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return secondsSince(start);
}

}  // namespace fathom::test
