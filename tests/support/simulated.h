#pragma once

#include <map>
#include <string>
#include <vector>

#include "recording/instrument_entries.h"
#include "sensors/vehicle.h"
#include "simulation/navigation_simulator.h"

namespace fathom::test {

/// A vehicle with every navigation sensor, mounted aslant, so that no frame can be forgotten unnoticed.
inline Vehicle slantedVehicle() {
  const auto pose = [](double x, double y, double z, double yaw_deg, double pitch_deg, double roll_deg) {
    return Pose{rotationFromYawPitchRoll(radians(yaw_deg), radians(pitch_deg), radians(roll_deg)), {x, y, z}};
  };
  Vehicle vehicle;
  vehicle.ins.emplace().T_robot_ins = pose(0.15, -0.12, 0.13, 20, -5, 8);
  vehicle.ins->attitude_sigma = radians(0.2);
  vehicle.dvl.emplace().T_robot_dvl = pose(-0.2, 0.05, -0.18, 45, 2, -3);
  vehicle.depth.emplace().T_robot_depth = pose(-0.3, 0.2, 0.1, 0, 0, 0);
  vehicle.usbl.emplace().T_robot_usbl = pose(0.1, 0.0, 0.4, 0, 0, 0);
  vehicle.usbl->rate_hz = 1;
  return vehicle;
}

inline constexpr double kSeaFloor_m = -7.0;

/// The slanted vehicle above a sea floor, its sensors without noise.
inline SimulationOptions noiseless() {
  SimulationOptions options;
  options.vehicle = slantedVehicle();
  options.noise = false;
  options.sea_floor_z_m = kSeaFloor_m;
  return options;
}

using SamplesByLabel = std::map<std::string, std::vector<Sample>>;

inline SamplesByLabel simulated(const SimulationOptions& options, const Trajectory& trajectory) {
  SamplesByLabel samples;
  simulateNavigation(options, trajectory, [&](const Sample& s) { samples[s.label].push_back(s); });
  return samples;
}

/// The i-th of a sensor.
template <class R>
const R& reading(const SamplesByLabel& samples, const char* label, std::size_t i) {
  return std::get<R>(samples.at(label).at(i).reading);
}

/// All numbers of a reading, absent ones as NaN, for comparisons.
inline std::vector<double> numbersOf(const Sample& sample) {
  std::vector<double> numbers;
  const auto add = [&](const auto& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) numbers.push_back(m(i));
  };
  const auto addValue = [&](const auto* value) {
    if (value == nullptr)
      numbers.push_back(std::nan(""));
    else if constexpr (std::is_arithmetic_v<std::remove_cvref_t<decltype(*value)>>)
      numbers.push_back(*value);
    else
      add(*value);
  };
  if (!std::holds_alternative<PoseSample>(sample.reading)) {
    withInstrument(sample, [&]<class Instrument>(const auto& entry, const Instance&) {
      Instrument::forEachValue(entry, [&](int, const auto* value) { addValue(value); });
    });
  } else if (const auto* pose = std::get_if<PoseSample>(&sample.reading)) {
    const Pose T = pose->T_odom_robot.mean;
    add(T.position);
    add(T.rotation);
  }
  return numbers;
}

/// Largest difference of two lists of readings; infinite where counts, stamps or absences differ.
inline double largestDifference(const std::vector<Sample>& a, const std::vector<Sample>& b) {
  constexpr double kDifferent = std::numeric_limits<double>::infinity();
  if (a.size() != b.size()) return kDifferent;
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto x = numbersOf(a[i]), y = numbersOf(b[i]);
    if (a[i].time != b[i].time || x.size() != y.size()) return kDifferent;
    for (std::size_t j = 0; j < x.size(); ++j) {
      if (std::isnan(x[j]) != std::isnan(y[j])) return kDifferent;
      if (!std::isnan(x[j])) largest = std::max(largest, std::abs(x[j] - y[j]));
    }
  }
  return largest;
}

}  // namespace fathom::test
