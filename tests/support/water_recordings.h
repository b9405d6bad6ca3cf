#pragma once

#include "support/sil_recordings.h"

namespace fathom::test {

/// An approach to the shipped panel in this water, one image of 320 x 240 px a second, from 3.5 to 1.4 m.
inline RecordingFiles simulateApproach(const std::filesystem::path& folder, const std::string& water,
                                       std::uint64_t seed = 1, double seconds = 24,
                                       const EffectParameters<double>& effects = {}) {
  SimulationOptions options = smallCameraOptions();
  options.seed = seed;
  options.effects = effects;
  options.duration_s = seconds - 1;
  return simulateBeforePanel(
      folder,
      "speed_m_s: 0.1\nturn_rate_deg_s: 5\nramp_s: 1\nwaypoints:\n"
      "  - {x: 2.1, y: 0.3, z: -4.2, yaw_deg: -4}\n  - {x: 4.3, y: -0.2, z: -4.25, yaw_deg: 4}\n"
      "sway:\n  - {axis: roll, amplitude_deg: 4, period_s: 5}\n",
      kConfig / water, options);
}

}  // namespace fathom::test
