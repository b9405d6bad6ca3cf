#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "effects/registry.h"

/// Effects that are known to be there, from a calibration file.
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

}  // namespace fathom
