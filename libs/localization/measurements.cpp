#include "localization/measurements.h"

#include <stdexcept>

namespace fathom {
namespace {

/// As the filter sees an instant: the sea floor and the biases are among its states.
template <class T>
Inputs<T> inputsOf(const NavigationState<T>& x, const MeasurementContext& context, const Instance& instance) {
  return {x.motion,
          {context.vehicle->gravityOdom(), x.sea_floor_z_m},
          effectsOf(x, context.calibration, context.t_s, instance),
          context.t_s};
}

Prediction<SensorJet> jetsAt(const NavigationState<double>& x, const StateColumns& columns, Channel channel,
                             const Observation& seen, const MeasurementContext& context) {
  return modelOf(channel).differentiate(inputsOf(lift<kJetSize>(x, columns), context, seen.instance),
                                        *context.vehicle, seen);
}

/// All that any of the example's derivatives is not zero by.
StateColumns trace(Channel channel, int states) {
  const Inputs<double> example = exampleInputs();
  const Vehicle vehicle;
  MeasurementContext context{&vehicle, example.effects, example.t_s};
  NavigationState<double> x;
  x.motion = example.state;
  x.sea_floor_z_m = example.world.sea_floor_z_m;
  StateColumns depends;
  for (int first = 0; first < states; first += kJetSize) {
    StateColumns asked;
    for (int c = first; c < std::min(states, first + kJetSize); ++c) asked.add(c);
    const auto jets = jetsAt(x, asked, channel, exampleObservation(), context);
    for (int k = 0; k < asked.count; ++k)
      if (std::any_of(jets.begin(), jets.end(), [&](const SensorJet& jet) { return jet.v[k] != 0.0; }))
        depends.add(asked.list[static_cast<std::size_t>(k)]);
  }
  return depends;
}

}  // namespace

template <int N>
const StateColumns& columnsOf(Channel channel) {
  static const auto all = [] {
    std::array<StateColumns, kInstrumentChannelCount> columns;
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = trace(static_cast<Channel>(i), N);
    return columns;
  }();
  return all.at(indexOf(channel));
}

template <int N, int M>
typename ErrorStateFilter<N>::template Measurement<M> measure(const NavigationState<double>& x,
                                                              Channel channel, const Observation& seen,
                                                              const MeasurementContext& context) {
  typename ErrorStateFilter<N>::template Measurement<M> m;
  m.columns = columnsOf<N>(channel);
  const auto prediction = jetsAt(x, m.columns, channel, seen, context);
  for (int i = 0; i < M; ++i) {
    m.residual[i] = seen.value[i] - prediction[i].a;
    m.H.row(i) = prediction[i].v.transpose();
  }
  m.R = seen.covariance;
  if (const auto& model = modelOf(channel); model.drift_effect && !seen.instance.isFirst())
    m.R.diagonal().array() += model.drift(*context.vehicle, seen.instance).whiteVariance();
  return m;
}

template const StateColumns& columnsOf<kCoreSize>(Channel);
template const StateColumns& columnsOf<kFullSize>(Channel);

// The sizes that channels have.
template ErrorStateFilter<kCoreSize>::Measurement<1> measure<kCoreSize, 1>(const NavigationState<double>&,
                                                                           Channel, const Observation&,
                                                                           const MeasurementContext&);
template ErrorStateFilter<kCoreSize>::Measurement<3> measure<kCoreSize, 3>(const NavigationState<double>&,
                                                                           Channel, const Observation&,
                                                                           const MeasurementContext&);
template ErrorStateFilter<kFullSize>::Measurement<1> measure<kFullSize, 1>(const NavigationState<double>&,
                                                                           Channel, const Observation&,
                                                                           const MeasurementContext&);
template ErrorStateFilter<kFullSize>::Measurement<3> measure<kFullSize, 3>(const NavigationState<double>&,
                                                                           Channel, const Observation&,
                                                                           const MeasurementContext&);
template double ErrorStateFilter<kCoreSize>::update(const Measurement<1>&, double);
template double ErrorStateFilter<kCoreSize>::update(const Measurement<3>&, double);
template double ErrorStateFilter<kCoreSize>::update(const Selection<Columns<0, 1, 2, 3, 4, 5>>&, double);
template double ErrorStateFilter<kFullSize>::update(const Measurement<1>&, double);
template double ErrorStateFilter<kFullSize>::update(const Measurement<3>&, double);
template double ErrorStateFilter<kFullSize>::update(const Selection<Columns<0, 1, 2, 3, 4, 5>>&, double);

}  // namespace fathom
