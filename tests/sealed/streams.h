#pragma once

#include <cstdint>

#include "core/random.h"

namespace fathom::sealed {

/// Independent streams of random numbers, so that one more draw here moves no other.
enum class Stream : std::uint64_t {
  ins = 1,
  dvl,
  depth,
  corners,
  ripple,
  print,
  pixel_response,
  exposure,
  sun,
  blotch,
  snow,
  shake,
  first_image = 1000  ///< and one for each image from here on
};

inline Random stream(std::uint64_t seed, Stream which, std::uint64_t index = 0) {
  return Random::stream(seed, static_cast<std::uint64_t>(which) + index);
}

}  // namespace fathom::sealed
