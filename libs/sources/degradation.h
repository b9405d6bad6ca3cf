#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/yaml.h"
#include "sources/faults.h"

namespace fathom {

/// Stands in a stage's sensors for MARKERS and PANEL, the two forms of what one image tells.
inline constexpr const char* kLandmarks = "LANDMARKS";

/// One fault, of some sensors, for some time.
struct DegradationStage {
  AnyFault fault;
  std::vector<std::string> sensors;  ///< labels, and LANDMARKS
  /// The stage acts on samples stamped within [begin_s, end_s) since the source's first entry.
  double begin_s = 0.0, end_s = std::numeric_limits<double>::infinity();
  std::uint64_t seed = 1;

  std::string kind() const;  ///< e.g. "drop"
  bool concerns(const std::string& label) const;

  /// What says how strong the fault is, as named in YAML.
  std::vector<std::string> strengthKeys() const;
  /// Every strength times `factor` (not negative); probabilities stay at most 1. Zero changes nothing.
  DegradationStage scaled(double factor) const;
  /// With this strength set. Of an amount with axes, the direction stays and the largest component becomes
  /// `value`; where it was zero, every axis does. Throws std::invalid_argument with the reason where there is
  /// no such strength or it may not be this value.
  DegradationStage with(const std::string& key, double value) const;
};

/// Reads what is done to a stream of samples, in this order. Strict. Throws Error.
///
///   stages:
///     - {kind: outage, sensors: [DVL], begin_s: 60, duration_s: 60}
///     - {kind: noise, sensors: [INS, LANDMARKS], gyro_rad_s: 0.01, position_m: 0.05, seed: 7}
///
/// Every stage: kind, sensors, and where wanted begin_s, end_s, seed. The kinds:
///
///   drop        probability
///   delay       delay_s                    keeps the stamp, arrives later
///   jitter      sigma_s                    of the stamp; the order of arrival stays
///   noise       amounts                    white, sigma in each axis
///   bias        amounts                    constant
///   swing       amounts, [period_s]        a sine of these amplitudes
///   burst       amounts, [duration_s], [repeat_s]   white noise for 2 s every 20 s, or so long and so often
///   clock       rate_ppm                   stamps run ahead, or behind
///   outage      duration_s, [repeat_s]     from begin_s on
///   duplicate   probability, [after_s]     arrives twice
///   reorder     probability, [within_s]    some arrive later by up to 0.5 s or within_s
///   corrupt     probability, [as]          as: [nan, huge, wild], of these
///
/// Amounts: a number for every axis or [x, y, z]; each sensor listed needs at least one:
///
///   INS         gyro_rad_s, accelerometer_m_s2, attitude_deg
///   DVL         velocity_m_s
///   DVL_BEAMS   range_m (a number)
///   DEPTH       pressure_pa (a number)
///   USBL        position_m, odom axes
///   COMPASS     heading_rad (a number)
///   GNSS        fix_m: east, north, up
///   ALTIMETER   altimeter_m (a number)
///   LANDMARKS   position_m, angle_deg: the robot pose they imply is moved so, in robot axes
///
/// The sensors: INS, DVL, DVL_BEAMS, DEPTH, USBL, COMPASS, GNSS, ALTIMETER, CAMERA, STEREO, LANDMARKS,
/// MARKERS, PANEL, and of several of a kind DVL.2 and so on, each by itself. Landmarks are derived from
/// images before the stages act, so what happens to CAMERA does not happen to LANDMARKS.
std::vector<DegradationStage> readDegradation(const std::filesystem::path& file);
/// One stage; keys other than a stage's are left to the caller. `vary` names a strength that need not be
/// there yet.
DegradationStage parseDegradationStage(const YamlMap& map, const std::string& vary = "");

}  // namespace fathom
