#pragma once

#include <chrono>
#include <cstdint>
#include <ratio>

namespace fathom {

/// UTC in ticks of 100 ns since 1601, as rawlogs have it.
struct UtcClock {
  using rep = std::int64_t;
  using period = std::ratio<1, 10'000'000>;
  using duration = std::chrono::duration<rep, period>;
  using time_point = std::chrono::time_point<UtcClock>;
  static constexpr bool is_steady = false;
  static constexpr duration kFrom1601To1970 = std::chrono::seconds(11'644'473'600);
};

/// Time of validity; Time{} says that there is none.
using Time = UtcClock::time_point;

/// b - a in seconds, exact to the tick for differences below 28 years.
inline double secondsBetween(const Time& a, const Time& b) {
  return 1e-7 * static_cast<double>((b - a).count());
}
/// Rounded to the nearest tick.
inline Time after(const Time& start, double seconds) {
  return start + Time::duration(static_cast<Time::rep>(seconds * 1e7 + (seconds < 0 ? -0.5 : 0.5)));
}
/// Rounded towards 1970.
inline Time fromUnixSeconds(double seconds) {
  return Time(UtcClock::kFrom1601To1970 + Time::duration(static_cast<Time::rep>(seconds * 1e7)));
}
/// Seconds since 1970; a double resolves 0.24 us at today's dates. 0 where there is no time.
inline double toUnixSeconds(const Time& time) {
  if (time == Time{}) return 0.0;
  return static_cast<double>((time.time_since_epoch() - UtcClock::kFrom1601To1970).count()) / 1e7;
}

}  // namespace fathom
