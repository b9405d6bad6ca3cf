#pragma once

#include <chrono>

namespace fathom::test {

/// How long a piece of work takes by the clock, s.
template <class Work>
double seconds(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace fathom::test
