#pragma once

#include <cstdio>
#include <string>

#include "core/time.h"

namespace fathom {

/// Ticks of 100 ns since 1970-01-01, UTC.
inline std::int64_t unixTicks(const Time& time) {
  constexpr std::int64_t kTicksFrom1601To1970 = 116'444'736'000'000'000;
  return time.time_since_epoch().count() - kTicksFrom1601To1970;
}
inline Time fromUnixTicks(std::int64_t ticks) { return Time{} + Time::duration(ticks - unixTicks(Time{})); }

/// Ticks as seconds with all 7 decimals.
inline std::string secondsText(std::int64_t ticks) {
  constexpr std::int64_t kTicksPerSecond = 10'000'000;
  const bool negative = ticks < 0;
  const auto magnitude = negative ? -ticks : ticks;
  char text[48];
  std::snprintf(text, sizeof text, "%s%lld.%07lld", negative ? "-" : "",
                static_cast<long long>(magnitude / kTicksPerSecond),
                static_cast<long long>(magnitude % kTicksPerSecond));
  return text;
}

}  // namespace fathom
