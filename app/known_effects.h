#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "effects/registry.h"

/// The option --calibration of commands whose images have the effects in a calibration file.
namespace fathom {

struct KnownEffects {
  std::string file;         ///< empty: none was given, all is as drawn
  std::string fingerprint;  ///< of what is in it
  EffectParameters<double> effects;

  bool given() const { return !file.empty(); }
  std::vector<std::string> ids() const;
  /// "Effects that are on: gamma, vignetting (cal.yaml)."
  std::string inWords() const;
};

/// Of no name: none. Throws Error.
KnownEffects readKnownEffects(const std::string& file);

/// {"file": …, "fingerprint": …, "effects": [ids]}
nlohmann::ordered_json toJson(const KnownEffects& known);

/// Adds `--calibration FILE`.
CLI::Option* addCalibrationOption(CLI::App& command, std::string& file, const std::string& help);
/// Adds `--at SECONDS`, of images that have no time of their own.
CLI::Option* addTimeOption(CLI::App& command, double& t_s, CLI::Option* calibration);

/// What --help says of effects in images of views.
inline constexpr const char* kEffectsInViews =
    "With --calibration (a file as `fathom diagnose` writes it), the images have those effects; readers and\n"
    "estimators know nothing of them. Views have no time of their own: what is active for a part of a "
    "recording\n"
    "(active_s), or peaks, is there as it is at --at. What is drawn for each image is drawn for each view. "
    "The\n"
    "camera truly is where the view has it, and stands still: effects on navigation sensors, latencies, the\n"
    "camera's mounting and the panel's pose change nothing.\n";

}  // namespace fathom
