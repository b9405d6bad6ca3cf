#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "motion.h"
#include "sealed_case.h"

/// The path of a dive: smooth and known in closed form, so that rates and accelerations are exact.
namespace fathom::sealed {

/// Where a coordinate is, and how it changes.
struct Coordinate {
  double value = 0, rate = 0, acceleration = 0;
};

/// A sum of sines.
struct Swing {
  struct Wave {
    double amplitude, rate_rad_s, phase_rad;
  };
  double mean = 0;
  std::vector<Wave> waves{};

  Coordinate at(double t_s) const;
};

class Dive {
 public:
  explicit Dive(std::function<Motion(double t_s)> motion) : motion_(std::move(motion)) {}

  Motion at(double t_s) const { return motion_(t_s); }
  Pose poseAt(double t_s) const { return motion_(t_s).T_odom_robot; }

 private:
  std::function<Motion(double t_s)> motion_;
};

/// A dive before a panel that looks along -x of odom, its middle at `panel_odom`. Amplitudes, frequencies and
/// phases are drawn from the seed.
Dive makeDive(const std::string& manoeuvre, std::uint64_t seed, const Vector3d& panel_odom);
/// The same, or along the path that is given. Throws Error as GivenPath does.
Dive makeDive(const DiveCase& dive, const Vector3d& panel_odom);

}  // namespace fathom::sealed
