#pragma once

#include <algorithm>

#include "sources/fault.h"

namespace fathom {

/// Stamps are off by normal noise, as where they are given on arrival over a busy bus; the order of arrival
/// stays. (Noise on the arrival is the fault `reorder`.)
struct JitterFault {
  static constexpr const char* id = "jitter";
  static constexpr bool changes_values = false;
  double sigma_s = 0.0;

  template <class F>
  void fields(F& f) {
    f.strength("sigma_s", sigma_s, Limit::not_negative);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    constexpr double kMost_s = 86400.0;  // what any clock of a dive could be off by
    const double off_s = std::clamp(sigma_s * context.random.normal(), -kMost_s, kMost_s);
    arrival.sample.time = after(arrival.sample.time, off_s);
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
