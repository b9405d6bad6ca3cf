#include "tuning/noise_parameters.h"

namespace fathom {
namespace {

/// A regime of less tells too little of its own.
constexpr double kLeast_s = 30.0;
/// Fewer readings of a channel do not tell its noise.
constexpr std::size_t kLeastReadings = 30;

/// Of the first of these, and of the others with it.
NoiseParameter driveOf(const std::vector<Regime>& regimes, bool of_turning_rate, const DrivingNoise& drive) {
  const Vector3d& density = of_turning_rate ? drive.angular_velocity : drive.acceleration;
  return {std::string(of_turning_rate ? "angular acceleration, " : "jerk, ").append(nameOf(regimes.front())),
          of_turning_rate ? "rad/s^1.5" : "m/s^2.5", std::sqrt(density.maxCoeff()),
          [regimes, of_turning_rate](LocalizationOptions& options, double factor) {
            const double times = factor * factor;
            for (const Regime regime : regimes) {
              const auto driven = options.driven.find(regime);
              if (regime == Regime::station_keeping)
                (of_turning_rate ? options.noise.angular_velocity : options.noise.acceleration) *= times;
              else if (driven != options.driven.end())
                (of_turning_rate ? driven->second.angular_velocity : driven->second.acceleration) *= times;
            }
          },
          of_turning_rate ? kChannel<Gyro> : kChannel<Accelerometer>};
}

/// Each regime that lasts; with the longest, those that do not: a drive that stayed as it was would upset the
/// filter each time it is met.
std::vector<std::vector<Regime>> drivenTogether(const std::map<Regime, double>& times_s) {
  const auto timeIn = [&times_s](Regime regime) {
    const auto time = times_s.find(regime);
    return time == times_s.end() ? 0.0 : time->second;
  };
  std::vector<std::vector<Regime>> groups;
  std::vector<Regime> rest;
  for (const Regime regime : kEveryRegime)
    if (timeIn(regime) >= kLeast_s)
      groups.push_back({regime});
    else
      rest.push_back(regime);
  if (groups.empty()) return {rest};
  auto& longest = *std::max_element(groups.begin(), groups.end(), [&](const auto& a, const auto& b) {
    return timeIn(a.front()) < timeIn(b.front());
  });
  longest.insert(longest.end(), rest.begin(), rest.end());
  return groups;
}

NoiseParameter sigmaOf(Channel channel, const LocalizationOptions& options) {
  const auto times = options.sigma_times.find(channel);
  return {"sigma of " + nameOf(channel), "times the vehicle file's",
          times == options.sigma_times.end() ? 1.0 : times->second,
          [channel](LocalizationOptions& o, double factor) {
            o.sigma_times.try_emplace(channel, 1.0).first->second *= factor;
          },
          channel};
}

}  // namespace

LocalizationOptions writtenOut(LocalizationOptions options, const Vehicle& vehicle, const Scores& scores) {
  if (vehicle.ins && !options.biases)
    options.biases = {vehicle.ins->gyro_bias_sigma_rad_s, vehicle.ins->accelerometer_bias_sigma_m_s2,
                      vehicle.ins->bias_time_constant_s};
  for (const auto& [regime, time_s] : scores.regimes_s)
    if (regime != Regime::station_keeping && time_s >= kLeast_s)
      options.driven.try_emplace(regime,
                                 DrivingNoise{options.noise.angular_velocity, options.noise.acceleration});
  return options;
}

std::vector<NoiseParameter> noiseParameters(const LocalizationOptions& options, const Vehicle& vehicle,
                                            const Scores& scores) {
  std::vector<NoiseParameter> parameters;
  const auto has = [&](Channel channel) {
    const auto found = scores.fit.channels.find(channel);
    return found != scores.fit.channels.end() && found->second.count >= kLeastReadings;
  };
  for (const std::vector<Regime>& regimes : drivenTogether(scores.regimes_s)) {
    const auto driven = options.driven.find(regimes.front());
    const DrivingNoise drive = driven == options.driven.end()
                                   ? DrivingNoise{options.noise.angular_velocity, options.noise.acceleration}
                                   : driven->second;
    for (const bool of_turning_rate : {true, false})
      parameters.push_back(driveOf(regimes, of_turning_rate, drive));
  }
  if (options.bias_states && options.noise.sea_floor > 0.0 &&
      std::any_of(kEveryChannel.begin(), kEveryChannel.end(),
                  [&](Channel channel) { return textOf(channel).is_indirect && has(channel); }))
    parameters.push_back(
        {"slope of the ground", "m/s^0.5", std::sqrt(options.noise.sea_floor),
         [](LocalizationOptions& o, double factor) { o.noise.sea_floor *= factor * factor; }});
  for (const Channel channel : kEveryChannel)
    if (textOf(channel).is_filtered && has(channel)) parameters.push_back(sigmaOf(channel, options));
  if (!vehicle.ins || !options.bias_states || !options.biases) return parameters;
  if (has(kChannel<Gyro>) && options.biases->gyro_sigma_rad_s > 0.0)
    parameters.push_back(
        {"gyro bias", "deg/s", degrees(options.biases->gyro_sigma_rad_s),
         [](LocalizationOptions& o, double factor) { o.biases->gyro_sigma_rad_s *= factor; }});
  if (has(kChannel<Accelerometer>) && options.biases->accelerometer_sigma_m_s2 > 0.0)
    parameters.push_back(
        {"accelerometer bias", "m/s^2", options.biases->accelerometer_sigma_m_s2,
         [](LocalizationOptions& o, double factor) { o.biases->accelerometer_sigma_m_s2 *= factor; }});
  if (parameters.back().name.ends_with("bias"))
    parameters.push_back(
        {"biases' time constant", "s", options.biases->time_constant_s,
         [](LocalizationOptions& o, double factor) { o.biases->time_constant_s *= factor; }});
  return parameters;
}

}  // namespace fathom
