#pragma once

#include "sources/fault.h"

namespace fathom {

/// Samples get lost, each with the same probability.
struct DropFault {
  static constexpr const char* id = "drop";
  static constexpr bool changes_values = false;
  double probability = 0.0;

  template <class F>
  void fields(F& f) {
    f.strength("probability", probability, Limit::probability);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    if (context.random.uniform() >= probability) out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
