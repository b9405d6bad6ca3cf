#pragma once

#include <filesystem>
#include <string>

#include "core/yaml.h"
#include "effects/registry.h"

/// The calibration file: which effects are on, when, with which parameters. `simulate`, `localize` and
/// `diagnose` read and write the same form:
///
///   effects:
///     - {id: dvl-scale, scale_error: 0.012}
///     - {id: dvl-lever-arm, offset_m: [0.10, 0, -0.02]}
///     - {id: clock-drift, sensor: DVL, rate_ppm: 40}
///     - {id: water-current, current_m_s: [0.2, 0.1, 0], active_s: [30, 80]}
///
/// active_s: from when to when, in seconds from the recording's first entry, or [[from, to], [from, to]] of
/// what comes again; without it, always.
/// instance: where a vehicle has several instruments of the kind, the one that it acts on, as it stands
/// behind the dot of its label (`2` of DVL.2, or `first`); without it, on each. An effect may be given once
/// for each instance.
namespace fathom {

/// Throws Error: unknown effect (lists the known ones), an effect twice, a parameter missing, unknown, of the
/// wrong size, beyond its limit, negative where it must not be or, of an id, not a whole number; an interval
/// that ends before it begins.
EffectParameters<double> readCalibration(const std::filesystem::path& file);
EffectParameters<double> parseCalibration(const YamlMap& map);
/// The text form of the effects that are on; numbers to the last digit, so that reading it back is exact.
std::string formatCalibration(const EffectParameters<double>& parameters);

}  // namespace fathom
