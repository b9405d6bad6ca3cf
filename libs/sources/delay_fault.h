#pragma once

#include "sources/fault.h"

namespace fathom {

/// Samples keep their stamps but arrive later, all by the same time.
struct DelayFault {
  static constexpr const char* id = "delay";
  static constexpr bool changes_values = false;
  double delay_s = 0.0;

  template <class F>
  void fields(F& f) {
    f.strength("delay_s", delay_s, Limit::not_negative);
  }

  void apply(Arrival arrival, const FaultContext&, std::vector<Arrival>& out) const {
    arrival.arrival_s += delay_s;
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
