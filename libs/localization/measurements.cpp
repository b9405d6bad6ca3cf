#include "localization/measurements.h"

#include <stdexcept>

namespace fathom {
namespace {

/// An instant as the filter sees it (the sea floor and the biases are among its states) with derivatives: ten
/// kilobytes, nearly all of them zeros that stay, so it is made once and used for one reading after the
/// other.
class LiftedInputs {
 public:
  const Inputs<SensorJet>& at(const NavigationState<double>& x, const StateColumns& columns,
                              const MeasurementContext& context, const Instance& instance) {
    for (int k = 0; k < columns_.count; ++k) seedMotion(x, k, 0.0);
    columns_ = columns;
    setMotion(x.motion);
    in_.world = {context.vehicle->gravityOdom(), SensorJet(x.sea_floor_z_m)};
    in_.t_s = context.t_s;
    setCalibrated(context, instance);
    if (instance.isFirst()) addBiases(x, in_.effects);
    for (int k = 0; k < columns_.count; ++k) {
      seedMotion(x, k, 1.0);
      if (columnOf(k) == kSeaFloor) in_.world.sea_floor_z_m.v[k] = 1.0;
      if (instance.isFirst()) seedBiases(k);
    }
    return in_;
  }

 private:
  int columnOf(int k) const { return columns_.list[static_cast<std::size_t>(k)]; }

  /// Where nothing is calibrated, what is off need not be zero: but for the biases, which are added to.
  void setCalibrated(const MeasurementContext& context, const Instance& instance) {
    if (context.calibration.on.any() || !context.calibration.further.empty()) {
      in_.effects = context.calibration.at<SensorJet>(context.t_s, instance);
      return;
    }
    in_.effects.on.reset();
    clear<GyroBias>();
    clear<AccelerometerBias>();
    clear<PressureOffset>();
  }
  template <class Effect>
  void clear() {
    std::fill_n(in_.effects.of<Effect>(), parameterSize<Effect>(), SensorJet(0.0));
  }

  void setMotion(const KinematicState<double>& motion) {
    for (int i = 0; i < 9; ++i) in_.state.R_odom_robot(i).a = motion.R_odom_robot(i);
    for (int i = 0; i < 3; ++i) {
      in_.state.position_odom[i].a = motion.position_odom[i];
      in_.state.velocity_robot[i].a = motion.velocity_robot[i];
      in_.state.angular_velocity_robot[i].a = motion.angular_velocity_robot[i];
      in_.state.acceleration_robot[i].a = motion.acceleration_robot[i];
    }
  }

  void seedMotion(const NavigationState<double>& x, int k, double factor) {
    if (columnOf(k) < kCoreSize) seed(in_.state, x.motion.R_odom_robot, columnOf(k), k, factor);
  }

  void seedBiases(int k) {
    const int column = columnOf(k);
    if (column >= kGyroBias && column < kAccelerometerBias)
      in_.effects.of<GyroBias>()[column - kGyroBias].v[k] = 1.0;
    else if (column >= kAccelerometerBias && column < kPressureOffset)
      in_.effects.of<AccelerometerBias>()[column - kAccelerometerBias].v[k] = 1.0;
    else if (column == kPressureOffset)
      in_.effects.of<PressureOffset>()->v[k] = 1.0;
  }

  Inputs<SensorJet> in_;
  StateColumns columns_;  ///< that there are derivatives by
};

Prediction<SensorJet> jetsAt(const NavigationState<double>& x, const StateColumns& columns, Channel channel,
                             const Observation& seen, const MeasurementContext& context) {
  thread_local LiftedInputs lifted;
  return modelOf(channel).differentiate(lifted.at(x, columns, context, seen.instance), *context.vehicle,
                                        seen);
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
}  // namespace fathom
