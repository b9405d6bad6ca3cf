#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/yaml.h"
#include "effects/registry.h"

/// The calibration file: which effects are on, with which parameters. `simulate`, `localize` and (later)
/// `diagnose` read and write the same form:
///
///   effects:
///     - {id: dvl-scale, scale_error: 0.012}
///     - {id: dvl-lever-arm, offset_m: [0.10, 0, -0.02]}
namespace fathom {

/// Throws Error: unknown effect (lists the known ones), an effect twice, a parameter missing, unknown, of the
/// wrong size or beyond its limit.
EffectParameters<double> readCalibration(const std::filesystem::path& file);
EffectParameters<double> parseCalibration(const YamlMap& map);
/// The text form of the effects that are on; numbers to the last digit, so that reading it back is exact.
std::string formatCalibration(const EffectParameters<double>& parameters);

/// A registered effect without its type, for listings and reports.
struct EffectInfo {
  std::string_view id;
  std::vector<Parameter> parameters;
};
std::vector<EffectInfo> allEffects();

}  // namespace fathom
