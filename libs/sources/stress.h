#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sources/degradation.h"

namespace fathom {

/// A fault at several strengths, to see what each does to an estimate.
struct StressFault {
  std::string name;
  DegradationStage stage;  ///< with what `vary` does not change
  std::string vary;        ///< the strength varied, unit in its name; "factor": all of the stage's, together
  std::vector<double> strengths;

  DegradationStage at(double strength) const;
};

/// Reads a list of faults (config/stress.yaml). Strict. Throws Error.
///
///   faults:
///     - {name: dvl-drop, kind: drop, sensors: [DVL], vary: probability, strengths: [0.1, 0.5, 0.9]}
///     - {name: ins-noise, kind: noise, sensors: [INS], gyro_rad_s: 0.001, accelerometer_m_s2: 0.01,
///        vary: factor, strengths: [1, 3, 10]}
///
/// A stage's keys (degradation.h), a name that no other fault has, and `strengths` of the key that `vary`
/// names. Where that is an amount with axes, it may be given for its direction ([1, 0, 0]); strengths are
/// then its largest component.
std::vector<StressFault> readStress(const std::filesystem::path& file);

}  // namespace fathom
