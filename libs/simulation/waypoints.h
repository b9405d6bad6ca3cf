#pragma once

#include <filesystem>

#include "simulation/trajectory.h"

namespace fathom {

/// Reads waypoints, strict YAML. Everything but `waypoints` and the coordinates may be left out:
///
///   speed_m_s: 0.4             # along a leg, after speeding up
///   turn_rate_deg_s: 20        # likewise; the slower of the two sets a leg's duration
///   ramp_s: 2                  # time to speed up and to slow down
///   waypoints:                 # robot in odom, metres and degrees, MRPT order; at rest at each
///     - {x: 0, y: 0, z: -3, yaw_deg: 0, pitch_deg: 0, roll_deg: 0, hold_s: 5}
///     - {x: 4, y: 0, z: -3, yaw_deg: 360, speed_m_s: 0.6}     # speeds of the leg that ends here
///     - {x: 4, y: 1, z: -3, yaw_deg: 360, t_s: 60}            # or its time of arrival
///   sway:                      # added sinusoids: axis x, y, z (odom) with amplitude_m,
///     - {axis: roll, amplitude_deg: 2, period_s: 4.3}         # yaw, pitch, roll with amplitude_deg;
///     - {axis: z, amplitude_m: 0.03, period_s: 7, phase_deg: 90}
///
/// Angles go the way the numbers go: yaw 0 to 360 is a whole turn. The trajectory begins and ends at rest:
/// the first and last hold last at least 2 s, sway grows and fades in 8 s (or a third of the whole).
/// Throws Error, naming file, key and line.
Trajectory readWaypoints(const std::filesystem::path& file);

}  // namespace fathom
