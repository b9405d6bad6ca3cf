#pragma once

#include "sources/fault.h"
#include "sources/value_changes.h"

namespace fathom {

/// A constant offset, in the units and axes of value_changes.h; the same for every beam.
struct BiasFault {
  static constexpr const char* id = "bias";
  static constexpr bool changes_values = true;
  Amounts offset;

  template <class F>
  void fields(F& f) {
    offset.fields(f, Limit::any);
  }

  void apply(Arrival arrival, const FaultContext&, std::vector<Arrival>& out) const {
    addTo(arrival.sample, offset, [](const Vector3d& o) { return o; });
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
