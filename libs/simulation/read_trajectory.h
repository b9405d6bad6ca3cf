#pragma once

#include <filesystem>

#include "simulation/trajectory.h"

namespace fathom {

/// Reads where the robot goes. NAME.yaml is strict YAML, of one of the kinds below; NAME.rawlog stands for
/// its TRUTH entries; anything else is TUM text. Throws Error, naming file, key and line.
///
/// Coordinates are the robot's in odom, metres and degrees, MRPT order. Angles go the way the numbers go: yaw
/// 0 to 360 is a whole turn; pitch_deg and roll_deg may be left out. Planned motions begin and end at rest:
/// the first and last hold last at least 2 s, sway grows and fades in 8 s (or a third of the whole). Keys
/// with a value here and `sway` may be left out.
///
///   speed_m_s: 0.4             # along a leg, after speeding up
///   turn_rate_deg_s: 20        # likewise; the slower of the two sets a leg's duration
///   ramp_s: 2                  # time to speed up and to slow down
///   sway:                      # added sinusoids: axis x, y, z (odom) with amplitude_m,
///     - {axis: roll, amplitude_deg: 2, period_s: 4.3}         # yaw, pitch, roll with amplitude_deg
///     - {axis: z, amplitude_m: 0.03, period_s: 7, phase_deg: 90}
///   sway_seed: 7               # phases that are not given are drawn from it; without it they are 0
///
/// Waypoints, at rest at each (config/dive_trajectory.yaml):
///
///   kind: waypoints
///   waypoints:
///     - {x: 0, y: 0, z: -3, yaw_deg: 0, pitch_deg: 0, roll_deg: 0, hold_s: 5}
///     - {x: 4, y: 0, z: -3, yaw_deg: 360, speed_m_s: 0.6}     # speeds of the leg that ends here
///     - {x: 4, y: 1, z: -3, yaw_deg: 360, t_s: 60}            # or its time of arrival
///
/// Station keeping, one pose and sway (config/trajectory_station.yaml):
///
///   kind: station
///   pose: {x: 3.5, y: 0, z: -4.6, yaw_deg: 0}
///   duration_s: 120
///
/// A survey, lawn-mower sweeps in front of a panel or over the floor (config/trajectory_survey.yaml):
///
///   kind: survey
///   target: {x: 6, y: 0, z: -4.6}  # what is looked at
///   heading_deg: 0                 # from the vehicle to the target
///   plane: upright                 # upright: sweeps stand before the target, legs go sideways, top leg
///   first;
///                                  # level: they lie over it, legs go along the heading, rightmost first
///   distances_m: [3.5, 2.5, 1.5]   # one sweep at each, before or above the target; the next one goes back
///   length_m: 1.6                  # of a leg
///   extent_m: 0.8                  # across the legs
///   spacing_m: 0.4                 # of legs, at most
///   facing: heading                # heading: always; target: yaw turns to it, exactly where legs begin and
///                                  # end; legs: nose along the leg, turning on the spot (plane: level only)
///
/// As recorded, the poses of a TUM file or the TRUTH of a rawlog (config/trajectory_recorded.yaml):
///
///   kind: recorded
///   file: truth.tum                # relative to this file
Trajectory readTrajectory(const std::filesystem::path& file);

/// The poses of a file "as recorded" with their stamps: NAME.rawlog's TRUTH, or TUM text. Throws Error.
std::vector<StampedPose> readRecordedPoses(const std::filesystem::path& file);

}  // namespace fathom
