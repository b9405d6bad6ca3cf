#pragma once

#include <cmath>
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
  colours,
  first_image = 1000  ///< and one for each image from here on
};

inline Random stream(std::uint64_t seed, Stream which, std::uint64_t index = 0) {
  return Random::stream(seed, static_cast<std::uint64_t>(which) + index);
}

/// One for each of several alike: a marker, an axis.
inline Random streamOf(std::uint64_t seed, Stream which, std::uint64_t index) {
  return stream(seed, which, (index + 1) << 20);
}
/// One for each image, which has its stamp, not below zero, for itself.
inline Random streamAt(std::uint64_t seed, Stream which, double stamp_s) {
  return streamOf(seed, which, static_cast<std::uint64_t>(std::lround(stamp_s * 1e6)));
}

}  // namespace fathom::sealed
