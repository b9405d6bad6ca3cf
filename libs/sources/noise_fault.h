#pragma once

#include "sources/fault.h"
#include "sources/value_changes.h"

namespace fathom {

/// White noise on top of what is there: normal, independent in each axis and each beam. Sigmas as in
/// value_changes.h.
struct NoiseFault {
  static constexpr const char* id = "noise";
  static constexpr bool changes_values = true;
  Amounts sigma;

  template <class F>
  void fields(F& f) {
    sigma.fields(f, Limit::not_negative);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    Random& random = context.random;
    addTo(arrival.sample, sigma,
          [&](const Vector3d& s) -> Vector3d { return s.cwiseProduct(random.normal3()); });
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
