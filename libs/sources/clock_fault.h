#pragma once

#include "core/time.h"
#include "sources/fault.h"

namespace fathom {

/// A clock that runs fast or slow from the stage's begin on: stamps go ahead, or fall behind, more and more.
/// When samples arrive stays.
struct ClockFault {
  static constexpr const char* id = "clock";
  static constexpr bool changes_values = false;
  double rate_ppm = 0.0;

  template <class F>
  void fields(F& f) {
    f.strength("rate_ppm", rate_ppm, Limit::any);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    const double ahead_s = context.since_begin_s * rate_ppm * 1e-6;
    if (std::isfinite(ahead_s) && std::abs(ahead_s) < context.since_begin_s)
      arrival.sample.time = after(arrival.sample.time, ahead_s);
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
