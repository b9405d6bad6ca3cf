#pragma once

#include <cmath>

#include "sources/fault.h"

namespace fathom {

/// A sensor is silent from the stage's begin_s on, for a time; with repeat_s again and again.
struct OutageFault {
  static constexpr const char* id = "outage";
  static constexpr bool changes_values = false;
  double duration_s = 0.0;
  double repeat_s = std::numeric_limits<double>::infinity();  ///< from the begin of one to that of the next

  template <class F>
  void fields(F& f) {
    f.strength("duration_s", duration_s, Limit::not_negative);
    f.option("repeat_s", repeat_s, Limit::positive);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    if (std::fmod(context.since_begin_s, repeat_s) >= duration_s) out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
