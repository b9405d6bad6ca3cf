#pragma once

#include <string>
#include <vector>

#include "diagnosis/refit.h"

namespace fathom {

/// What an operator can do for a minute.
struct Manoeuvre {
  std::string text;  ///< as one would say it to the pilot
  /// The robot's pose in that of the station, t_s after the beginning.
  Pose (*T_station_robot)(double t_s);
};
/// The library, the simplest first.
const std::vector<Manoeuvre>& manoeuvres();

/// Where the robot was then, levelled: nobody holds station tilted.
Pose stationAt(const Pose& T_odom_robot);

/// Which manoeuvre would tell two effects apart: how much of one's size (in units of what can be resolved)
/// the other could not imitate, the smaller of both ways round.
struct Advice {
  std::string manoeuvre;      ///< a Manoeuvre's text; empty: none would
  double from_s = 0;          ///< begun where the robot was then, levelled: see stationAt()
  double separation = 0;      ///< after a minute of it, at the sizes found
  double separation_now = 0;  ///< in the recording
};

/// An effect at the size that a fit found.
struct SizedEffect {
  Candidate candidate;
  Eigen::VectorXd value;  ///< of its continuous scalars
};
SizedEffect sized(const Refit& fit, const Candidate& effect);

/// The best of the library for telling one of two effects from the other. By Jacobians alone: nothing is
/// simulated, only predicted at the poses of each manoeuvre from the place where the recording saw most
/// markers. `without`: the recording's model with neither; `recorded`: where the robot and the panels were.
Advice adviseManoeuvre(const BatchData& data, const WhitenedModel& without, const BatchState& recorded,
                       const SizedEffect& first, const SizedEffect& second, const NoiseModel& noise);

}  // namespace fathom
