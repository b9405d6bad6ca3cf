#pragma once

#include <cmath>
#include <numbers>

#include "sources/fault.h"
#include "sources/value_changes.h"

namespace fathom {

/// An offset that comes and goes: a sine of time that begins at zero, of these amplitudes (value_changes.h).
/// So a heading is off near iron that the robot passes, or a DVL that tracks water beside a tide.
struct SwingFault {
  static constexpr const char* id = "swing";
  static constexpr bool changes_values = true;
  Amounts amplitude;
  double period_s = 60.0;

  template <class F>
  void fields(F& f) {
    amplitude.fields(f, Limit::any);
    f.option("period_s", period_s, Limit::positive);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    const double share =
        std::sin(2.0 * std::numbers::pi * std::fmod(context.since_begin_s, period_s) / period_s);
    addTo(arrival.sample, amplitude, [share](const Vector3d& a) -> Vector3d { return share * a; });
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
