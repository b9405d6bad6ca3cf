#pragma once

#include <ceres/jet.h>

#include <bitset>
#include <cstddef>
#include <optional>

#include "sensors/channels.h"
#include "sensors/vehicle.h"

/// The forward model of an instrument's channel, whichever: filter and batch estimate differentiate it by the
/// same Jets, compiled once.
namespace fathom {

/// So many derivatives at once: as many as a filter's measurement has columns at most.
inline constexpr int kJetSize = 12;
using SensorJet = ceres::Jet<double, kJetSize>;
/// As many as most measurements have: in half the time.
inline constexpr int kShortJetSize = 6;
using ShortJet = ceres::Jet<double, kShortJetSize>;
template <class T>
using Prediction = Eigen::Matrix<T, Eigen::Dynamic, 1, 0, 3, 1>;
template <class T>
using Predict = Prediction<T> (*)(const Inputs<T>& in, const Vehicle& vehicle, const Observation& seen);

struct ChannelModel {
  /// What should be read, own unit; `in` holds the motion at the time of validity.
  Predict<double> predict;
  Predict<SensorJet> differentiate;
  Predict<ShortJet> differentiate_by_few;
  /// When it was valid, seconds after its stamp.
  double (*validityOffset)(const EffectParameters<double>& effects, double t_s);
  SensorJet (*validityOffsetJet)(const EffectParameters<SensorJet>& effects, double t_s);
  /// Those that can change it, as its equations ask for them.
  std::bitset<kEffectCount> effects;
  /// Through which it drifts; nothing: it does not.
  std::optional<std::size_t> drift_effect{};
  Drift (*drift)(const Vehicle& vehicle, const Instance& instance) = nullptr;
};

/// The channel must be an instrument's.
const ChannelModel& modelOf(Channel channel);

/// An example, for those who ask how a model behaves: motion, effects, mounting and measurement at random,
/// all effects on.
Inputs<double> exampleInputs();
Observation exampleObservation();

}  // namespace fathom
