#pragma once

#include <algorithm>

#include "sources/fault.h"
#include "sources/value_changes.h"

namespace fathom {

/// All values of a sample are replaced by garbage: of the kinds in `as`, each as often.
struct CorruptFault {
  static constexpr const char* id = "corrupt";
  static constexpr bool changes_values = true;
  double probability = 0.0;
  std::vector<Garbage> as{Garbage::nan, Garbage::huge, Garbage::wild};

  template <class F>
  void fields(F& f) {
    f.strength("probability", probability, Limit::probability);
    f.choices("as", kGarbageNames, as);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    const bool hit = context.random.uniform() < probability;
    const auto kinds = static_cast<double>(as.size());
    const auto kind = static_cast<std::size_t>(kinds * context.random.uniform());
    Random garbage(context.random.bits());
    if (hit) replaceValues(arrival.sample, as[std::min(kind, as.size() - 1)], garbage);
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
