#pragma once

#include <cmath>

namespace fathom {

/// What is there at t_s of an effect that comes and goes, as a share of its peak: a normal curve about
/// time_s, of standard deviation width_s.
template <class T>
T shareOfPeak(double t_s, const T& time_s, const T& width_s) {
  using std::exp;
  const T away = (t_s - time_s) / width_s;
  return exp(-0.5 * away * away);
}

}  // namespace fathom
