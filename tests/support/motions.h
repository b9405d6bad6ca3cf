#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/geometry.h"
#include "core/kinematics.h"
#include "core/random.h"
#include "simulation/trajectory.h"

namespace fathom::test {

/// A motion written down as sines, so that the truth of its derivatives is known: 3 m at most from
/// (0, 0, -4), all angles moving.
inline Pose sinePose(double t) {
  return {
      rotationFromYawPitchRoll(0.8 * std::sin(0.31 * t) + 0.1 * t, 0.15 * std::sin(0.53 * t),
                               0.2 * std::sin(0.71 * t + 0.4)),
      Vector3d(2.0 * std::sin(0.23 * t), 1.5 * std::sin(0.17 * t + 1.0), -4.0 + 0.6 * std::sin(0.29 * t))};
}

/// first, first + step, … below last.
inline std::vector<double> timesBetween(double first, double last, double step) {
  std::vector<double> times_s(static_cast<std::size_t>(std::ceil((last - first) / step)));
  for (std::size_t i = 0; i < times_s.size(); ++i) times_s[i] = first + step * static_cast<double>(i);
  return times_s;
}

inline Trajectory sineTrajectory(double duration_s, double interval_s = 0.1) {
  const auto times_s = timesBetween(0, duration_s + interval_s / 2, interval_s);
  std::vector<Pose> poses(times_s.size());
  std::transform(times_s.begin(), times_s.end(), poses.begin(), sinePose);
  return {times_s, poses};
}

/// Poses at random with up to 0.6 rad between neighbours, at uneven times.
inline std::pair<std::vector<double>, std::vector<Pose>> randomPoses(std::uint64_t seed, std::size_t count) {
  Random random(seed);
  std::vector<double> times_s{random.uniform(-5, 5)};
  std::vector<Pose> poses{{expSO3<double>(random.normal3()), random.normal3()}};
  while (poses.size() < count) {
    times_s.push_back(times_s.back() + random.uniform(0.1, 0.4));
    const Vector3d turn = random.uniform(0.0, 0.6) * random.normal3().normalized();
    poses.push_back(
        {poses.back().rotation * expSO3<double>(turn), poses.back().position + 0.3 * random.normal3()});
  }
  return {times_s, poses};
}

inline KinematicState<double> randomMotion(Random& random) {
  KinematicState<double> state;
  state.position_odom = Vector3d(0, 0, -3) + random.normal3();
  state.R_odom_robot = expSO3<double>(0.4 * random.normal3());
  state.velocity_robot = 0.5 * random.normal3();
  state.angular_velocity_robot = 0.3 * random.normal3();
  state.acceleration_robot = 0.2 * random.normal3();
  state.angular_acceleration_robot = 0.2 * random.normal3();
  return state;
}

}  // namespace fathom::test
