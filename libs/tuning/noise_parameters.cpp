#include "tuning/noise_parameters.h"

namespace fathom {
namespace {

/// A regime of less tells too little of its own.
constexpr double kLeast_s = 30.0;
/// Fewer readings of a channel do not tell its noise.
constexpr std::size_t kLeastReadings = 30;

NoiseParameter driveOf(Regime regime, bool of_turning_rate, const DrivingNoise& drive) {
  const Vector3d& density = of_turning_rate ? drive.angular_velocity : drive.acceleration;
  return {std::string(of_turning_rate ? "angular acceleration, " : "jerk, ").append(nameOf(regime)),
          of_turning_rate ? "rad/s^1.5" : "m/s^2.5", std::sqrt(density.maxCoeff()),
          [regime, of_turning_rate](LocalizationOptions& options, double factor) {
            const double times = factor * factor;
            if (regime == Regime::station_keeping) {
              (of_turning_rate ? options.noise.angular_velocity : options.noise.acceleration) *= times;
            } else {
              DrivingNoise& driven = options.driven.at(regime);
              (of_turning_rate ? driven.angular_velocity : driven.acceleration) *= times;
            }
          }};
}

NoiseParameter sigmaOf(Channel channel, const LocalizationOptions& options) {
  const auto times = options.sigma_times.find(channel);
  return {"sigma of " + nameOf(channel), "times the vehicle file's",
          times == options.sigma_times.end() ? 1.0 : times->second,
          [channel](LocalizationOptions& o, double factor) {
            o.sigma_times.try_emplace(channel, 1.0).first->second *= factor;
          }};
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
  // Where no regime but one lasts, the drive is of all.
  const bool stays = std::none_of(scores.regimes_s.begin(), scores.regimes_s.end(),
                                  [](const auto& r) { return r.second >= kLeast_s; });
  for (const Regime regime : kEveryRegime) {
    const auto time = scores.regimes_s.find(regime);
    const bool lasts = time != scores.regimes_s.end() && time->second >= kLeast_s;
    if (!lasts && !(stays && regime == Regime::station_keeping)) continue;
    const auto driven = options.driven.find(regime);
    const DrivingNoise drive = driven == options.driven.end()
                                   ? DrivingNoise{options.noise.angular_velocity, options.noise.acceleration}
                                   : driven->second;
    for (const bool of_turning_rate : {true, false})
      parameters.push_back(driveOf(regime, of_turning_rate, drive));
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
