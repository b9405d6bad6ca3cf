#pragma once

#include <mrpt/core/Clock.h>

namespace fathom {

/// Time of validity, UTC, 100 ns ticks.
using Time = mrpt::Clock::time_point;

/// b - a in seconds, exact to the tick for differences below 28 years.
inline double secondsBetween(const Time& a, const Time& b) {
  return 1e-7 * static_cast<double>((b - a).count());
}
/// Rounded to the nearest tick.
inline Time after(const Time& start, double seconds) {
  return start + mrpt::Clock::duration(
                     static_cast<mrpt::Clock::duration::rep>(seconds * 1e7 + (seconds < 0 ? -0.5 : 0.5)));
}
inline Time fromUnixSeconds(double seconds) { return mrpt::Clock::fromDouble(seconds); }
/// Seconds since 1970; a double resolves 0.24 us at today's dates.
inline double toUnixSeconds(const Time& time) { return mrpt::Clock::toDouble(time); }

}  // namespace fathom
