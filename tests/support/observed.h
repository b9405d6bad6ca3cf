#pragma once

#include "localization/measurements.h"
#include "sensors/channel_model.h"

namespace fathom::test {

/// An observation of a channel as a filter's measurement.
template <int N, class C>
auto measured(const NavigationState<double>& x, const Observation& seen, const MeasurementContext& context) {
  return measure<N, C::channel.component_count>(x, kChannel<C>, seen, context);
}

/// A vehicle with every instrument on board, mounted at the reference point.
inline const Vehicle& fullVehicle() {
  static const Vehicle vehicle = [] {
    Vehicle v;
    forEachInstrument([&]<class Instrument>() { (v.*Instrument::on_board).emplace(); });
    return v;
  }();
  return vehicle;
}

inline Inputs<double> inputs(const KinematicState<double>& state, const World<double>& world = {},
                             const EffectParameters<double>& effects = {}, double t_s = 0) {
  return {state, world, effects, t_s};
}

}  // namespace fathom::test
