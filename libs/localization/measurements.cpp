#include "localization/measurements.h"

#include <stdexcept>

namespace fathom {
namespace {

bool isCalibrated(const MeasurementContext& context) {
  return context.calibration.on.any() || !context.calibration.further.empty();
}

/// An instant as the filter sees it (the sea floor and the biases are among its states) with derivatives: ten
/// kilobytes, nearly all of them zeros that stay, so it is made once and used for one reading after the
/// other.
template <class Jet>
class LiftedInputs {
 public:
  const Inputs<Jet>& at(const NavigationState<double>& x, const StateColumns& columns,
                        const MeasurementContext& context, const Instance& instance) {
    seedMotion(x, columns);
    setMotion(x.motion);
    in_.world = {context.vehicle->gravityOdom(), Jet(x.sea_floor_z_m)};
    if (const int k = columns.find(kSeaFloor); k >= 0) in_.world.sea_floor_z_m.v[k] = 1.0;
    in_.t_s = context.t_s;
    if (isCalibrated(context))
      in_.effects = context.calibration.at<Jet>(context.t_s, instance);
    else
      in_.effects.on.reset();
    if (instance.isFirst()) addBiases(x);
    return in_;
  }

 private:
  /// Derivatives of the motion by these columns. Where they are those of the reading before, only the
  /// orientation's have changed.
  void seedMotion(const NavigationState<double>& x, const StateColumns& columns) {
    const bool same = columns.count == columns_.count && columns.list == columns_.list;
    if (!same) seedColumns(x, 0, kCoreSize, 0.0);
    columns_ = columns;
    seedColumns(x, same ? kOrientation : 0, same ? kVelocity : kCoreSize, 1.0);
  }
  void seedColumns(const NavigationState<double>& x, int first, int end, double factor) {
    for (int k = 0; k < columns_.count; ++k)
      if (const int column = columns_.list[static_cast<std::size_t>(k)]; column >= first && column < end)
        seed(in_.state, x.motion.R_odom_robot, column, k, factor);
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

  /// Those that the measurement depends on.
  void addBiases(const NavigationState<double>& x) {
    addBias<GyroBias>(kGyroBias, x.gyro_bias_rad_s.data());
    addBias<AccelerometerBias>(kAccelerometerBias, x.accelerometer_bias_m_s2.data());
    addBias<PressureOffset>(kPressureOffset, &x.pressure_offset_pa);
  }
  template <class Effect>
  void addBias(int first_column, const double* bias) {
    const int first = columns_.find(first_column);
    if (first < 0) return;
    constexpr int kSize = parameterSize<Effect>();
    Jet* const parameters = in_.effects.template of<Effect>();
    if (!in_.effects.template has<Effect>()) std::fill_n(parameters, kSize, Jet(0.0));
    in_.effects.on.set(kEffectIndex<Effect>);
    for (int i = 0; i < kSize; ++i) parameters[i] += Jet(bias[i], first + i);
  }

  Inputs<Jet> in_;
  StateColumns columns_;  ///< that there are derivatives by
};

template <class Jet>
Prediction<Jet> jetsAt(const NavigationState<double>& x, const StateColumns& columns, Channel channel,
                       const Observation& seen, const MeasurementContext& context) {
  thread_local LiftedInputs<Jet> lifted;
  const Inputs<Jet>& in = lifted.at(x, columns, context, seen.instance);
  if constexpr (std::is_same_v<Jet, ShortJet>)
    return modelOf(channel).differentiate_by_few(in, *context.vehicle, seen);
  else
    return modelOf(channel).differentiate(in, *context.vehicle, seen);
}

/// All that any of the example's derivatives is not zero by.
StateColumns trace(Channel channel, int states, bool has_effects) {
  const Inputs<double> example = exampleInputs();
  const Vehicle vehicle;
  MeasurementContext context{&vehicle, {}, example.t_s};
  if (has_effects) context.calibration = example.effects;
  NavigationState<double> x;
  x.motion = example.state;
  x.sea_floor_z_m = example.world.sea_floor_z_m;
  StateColumns depends;
  for (int first = 0; first < states; first += kJetSize) {
    StateColumns asked;
    for (int c = first; c < std::min(states, first + kJetSize); ++c) asked.add(c);
    const auto jets = jetsAt<SensorJet>(x, asked, channel, exampleObservation(), context);
    for (int k = 0; k < asked.count; ++k)
      if (std::any_of(jets.begin(), jets.end(), [&](const SensorJet& jet) { return jet.v[k] != 0.0; }))
        depends.add(asked.list[static_cast<std::size_t>(k)]);
  }
  return depends;
}

template <int N>
std::array<StateColumns, kInstrumentChannelCount> traceAll(bool has_effects) {
  std::array<StateColumns, kInstrumentChannelCount> columns;
  for (std::size_t i = 0; i < columns.size(); ++i)
    columns[i] = trace(static_cast<Channel>(i), N, has_effects);
  return columns;
}

/// Residual and Jacobian, by Jets that have room for the measurement's columns.
template <class Jet, class Measurement>
void linearize(Measurement& m, const NavigationState<double>& x, Channel channel, const Observation& seen,
               const MeasurementContext& context) {
  const Prediction<Jet> prediction = jetsAt<Jet>(x, m.columns, channel, seen, context);
  for (int i = 0; i < m.residual.size(); ++i) {
    m.residual[i] = seen.value[i] - prediction[i].a;
    m.H.row(i).template head<Jet::DIMENSION>() = prediction[i].v.transpose();
  }
}

}  // namespace

template <int N>
const StateColumns& columnsOf(Channel channel, bool has_effects) {
  static const std::array columns{traceAll<N>(false), traceAll<N>(true)};
  return columns[has_effects ? 1 : 0].at(indexOf(channel));
}

template <int N, int M>
typename ErrorStateFilter<N>::template Measurement<M> measure(const NavigationState<double>& x,
                                                              Channel channel, const Observation& seen,
                                                              const MeasurementContext& context) {
  typename ErrorStateFilter<N>::template Measurement<M> m;
  m.columns = columnsOf<N>(channel, isCalibrated(context));
  if (m.columns.count <= kShortJetSize)
    linearize<ShortJet>(m, x, channel, seen, context);
  else
    linearize<SensorJet>(m, x, channel, seen, context);
  m.R = seen.covariance;
  if (const auto& model = modelOf(channel); model.drift_effect && !seen.instance.isFirst())
    m.R.diagonal().array() += model.drift(*context.vehicle, seen.instance).whiteVariance();
  return m;
}

template const StateColumns& columnsOf<kCoreSize>(Channel, bool);
template const StateColumns& columnsOf<kFullSize>(Channel, bool);

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
