#include "support/drawn_dives.h"

#include <cmath>

#include "core/stable_sort.h"
#include "localization/error_state_filter.h"

namespace fathom::test {
namespace {

/// Time constants of the pull, s: long against what the filter remembers, or its model is not this one. (A
/// pull makes successive changes of a rate correlated, as noise of its sensor does, and the drive seem
/// weaker.)
constexpr double kMoves_s = 5.0, kTurns_s = 10.0;
const Vector3d kRest_odom(0, 0, -20);

/// Critically damped.
void pullBack(KinematicState<double>& m, double dt) {
  const Vector3d away = m.R_odom_robot.transpose() * (m.position_odom - kRest_odom);
  const Vector3d turned = logSO3<double>(m.R_odom_robot);
  const double k = 1.0 / kMoves_s, c = 1.0 / kTurns_s;
  m.acceleration_robot -=
      dt * (3 * k * m.acceleration_robot + 3 * k * k * m.velocity_robot + k * k * k * away);
  m.angular_velocity_robot -= dt * (2 * c * m.angular_velocity_robot + c * c * turned);
}

void drive(KinematicState<double>& m, const DrivingNoise& noise, double dt, Random& random) {
  m.angular_velocity_robot += (dt * noise.angular_velocity).cwiseSqrt().cwiseProduct(random.normal3());
  m.acceleration_robot += (dt * noise.acceleration).cwiseSqrt().cwiseProduct(random.normal3());
}

template <class Instrument>
void addReadings(const std::vector<KinematicState<double>>& motion, double interval_s,
                 const SimulationOptions& options, std::vector<Sample>& samples) {
  const auto& sheet = options.vehicle.*Instrument::on_board;
  if (!sheet) return;
  typename Instrument::Simulated instrument(
      *sheet, {options.seed, options.noise, options.beam_min_range_m, options.beam_max_range_m});
  const auto every = static_cast<std::size_t>(std::lround(1.0 / (sheet->rate_hz * interval_s)));
  for (std::size_t k = 0; k < motion.size(); k += every) {
    const double t_s = static_cast<double>(k) * interval_s;
    Inputs<double> in{
        motion[k], {options.vehicle.gravityOdom(), options.sea_floor_z_m}, options.effects, t_s};
    if constexpr (requires { instrument.draw(in.effects); }) instrument.draw(in.effects);
    samples.push_back({after(options.start, t_s), Instrument::label, instrument.read(&in)});
  }
}

}  // namespace

std::vector<KinematicState<double>> drawnMotion(const DrivingNoise& noise, double interval_s,
                                                double duration_s, std::uint64_t seed) {
  Random random = Random::stream(seed, 78);
  NavigationState<double> x;
  x.motion.position_odom = kRest_odom;
  std::vector<KinematicState<double>> motion;
  for (double t_s = 0; t_s <= duration_s; t_s += interval_s) {
    motion.push_back(x.motion);
    // Half of the noise before the step and half after it, as the filter has it.
    drive(x.motion, noise, interval_s / 2, random);
    pullBack(x.motion, interval_s);
    ErrorStateFilter<kCoreSize>::move(x, interval_s, {});
    drive(x.motion, noise, interval_s / 2, random);
  }
  return motion;
}

std::vector<Sample> readingsOf(const std::vector<KinematicState<double>>& motion, double interval_s,
                               const SimulationOptions& options) {
  std::vector<Sample> samples;
  forEachInstrument(
      [&]<class Instrument>() { addReadings<Instrument>(motion, interval_s, options, samples); });
  stableSort(samples, [](const Sample& a, const Sample& b) { return a.time < b.time; });
  return samples;
}

}  // namespace fathom::test
