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
  // of ordinary imperfections
  placement,
  flatness,
  stretch,
  edges,
  response,
  flat_field,
  illumination,
  albedo,
  gain,
  clock,
  jitter,
  dvl_bias,
  dvl_outliers,
  corner_outliers,
  // of outsiders
  arm,
  hidden_corners,
  growth,
  first_image = 1000  ///< and one for each image from here on
};

inline Random stream(std::uint64_t seed, Stream which, std::uint64_t index = 0) {
  return Random::stream(seed, static_cast<std::uint64_t>(which) + index);
}

/// One for each image, of what images have besides.
inline Random imageStream(std::uint64_t seed, Stream which, std::size_t image) {
  return stream(seed, which, (std::uint64_t{image} + 1) << 20);
}

}  // namespace fathom::sealed
