#pragma once

#include "sources/fault.h"

namespace fathom {

/// Samples arrive twice, the copy right behind the sample or `after_s` later.
struct DuplicateFault {
  static constexpr const char* id = "duplicate";
  static constexpr bool changes_values = false;
  double probability = 0.0;
  double after_s = 0.0;

  template <class F>
  void fields(F& f) {
    f.strength("probability", probability, Limit::probability);
    f.option("after_s", after_s, Limit::not_negative);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    const bool twice = context.random.uniform() < probability;
    out.push_back(std::move(arrival));
    if (twice) out.push_back({out.back().arrival_s + after_s, out.back().sample});
  }
};

}  // namespace fathom
