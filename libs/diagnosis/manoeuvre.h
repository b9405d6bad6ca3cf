#pragma once

#include <string>
#include <vector>

#include "diagnosis/refit.h"

namespace fathom {

/// What an operator can do for a minute, and again.
struct Manoeuvre {
  static constexpr double kDuration_s = 60;
  std::string text;  ///< as one would say it to the pilot
  /// The robot's pose in that of the station, t_s after the beginning, within the first minute.
  Pose (*in_first_minute)(double t_s);

  /// The same t_s after the beginning of as many times as one likes.
  Pose T_station_robot(double t_s) const;
};
/// The library, the simplest first.
const std::vector<Manoeuvre>& manoeuvres();

/// Where the robot was then, levelled: nobody holds station tilted.
Pose stationAt(const Pose& T_odom_robot);

/// Which manoeuvre would tell two effects apart: how much of one's size (in units of what can be resolved)
/// the other could not imitate, the smaller of both ways round.
struct Advice {
  static constexpr int kMostMinutes = 5;
  std::string manoeuvre;      ///< a Manoeuvre's text; empty: none would in so many minutes
  int minutes = 1;            ///< so many times, until they should differ by enough
  double from_s = 0;          ///< begun where the robot was then, levelled: see stationAt()
  double separation = 0;      ///< after a minute of it, at the sizes found; of the best even where it is none
  double separation_now = 0;  ///< in the recording
};

/// An effect at the size that a fit found.
struct SizedEffect {
  Candidate candidate;
  Eigen::VectorXd value;  ///< of its continuous scalars
};
/// "dive up and down by a metre, four times, 3 minutes long"; empty where there is none.
std::string textOf(const Advice& advice);
SizedEffect sized(const Refit& fit, const Candidate& effect);

/// The best of the library for telling one of two effects from the other. By Jacobians alone: nothing is
/// simulated, only predicted at the poses of each manoeuvre from the place where the recording saw most
/// markers, with what is known to be there besides. `without`: the recording's model with neither;
/// `recorded`: where the robot and the panels were; `known`: the effects of `without`.
Advice adviseManoeuvre(const BatchData& data, const WhitenedModel& without, const BatchState& recorded,
                       const EffectParameters<double>& known, const SizedEffect& first,
                       const SizedEffect& second, const NoiseModel& noise);

}  // namespace fathom
