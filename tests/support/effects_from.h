#pragma once

#include <string>

#include "core/yaml.h"
#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "estimation/batch_estimate.h"

namespace fathom::test {

/// Of the entries of a calibration file's list: "{id: dvl-scale, scale_error: 0.02}, …".
inline EffectParameters<double> effectsFrom(const std::string& entries) {
  return parseCalibration(YamlFile::parse("effects: [" + entries + "]", "test").root());
}

/// What is to be estimated: the same effects, discrete parameters as given, continuous ones neutral.
inline BatchOptions estimating(const EffectParameters<double>& truth) {
  BatchOptions options;
  options.calibration = truth;
  options.problem.estimate = truth.on;
  for (const EffectInfo& effect : allEffects())
    if (truth.on[effect.index])
      for (const std::size_t scalar : continuousScalars(effect.index)) options.calibration.values[scalar] = 0;
  return options;
}

}  // namespace fathom::test
