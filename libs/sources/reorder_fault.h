#pragma once

#include "sources/fault.h"

namespace fathom {

/// Some samples are held up on the way, by anything up to `within_s`, and arrive behind later ones.
struct ReorderFault {
  static constexpr const char* id = "reorder";
  static constexpr bool changes_values = false;
  double probability = 0.0;
  double within_s = 0.5;

  template <class F>
  void fields(F& f) {
    f.strength("probability", probability, Limit::probability);
    f.option("within_s", within_s, Limit::positive);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    const bool held_up = context.random.uniform() < probability;
    const double by_s = within_s * context.random.uniform();
    if (held_up) arrival.arrival_s += by_s;
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
