#pragma once

#include <cmath>

#include "sources/fault.h"
#include "sources/value_changes.h"

namespace fathom {

/// Bursts of outliers: white noise (sigmas as in value_changes.h) for a while, again and again.
struct BurstFault {
  static constexpr const char* id = "burst";
  static constexpr bool changes_values = true;
  Amounts sigma;
  double duration_s = 2.0;
  double repeat_s = 20.0;  ///< from the begin of one to that of the next

  template <class F>
  void fields(F& f) {
    sigma.fields(f, Limit::not_negative);
    f.option("duration_s", duration_s, Limit::positive);
    f.option("repeat_s", repeat_s, Limit::positive);
  }

  void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const {
    Random& random = context.random;
    const double on = std::fmod(context.since_begin_s, repeat_s) < duration_s ? 1.0 : 0.0;
    addTo(arrival.sample, sigma,
          [&](const Vector3d& s) -> Vector3d { return on * s.cwiseProduct(random.normal3()); });
    out.push_back(std::move(arrival));
  }
};

}  // namespace fathom
