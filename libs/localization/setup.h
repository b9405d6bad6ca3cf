#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "effects/registry.h"
#include "localization/options.h"
#include "sensors/vehicle.h"

namespace fathom {

/// A panel that sightings refer to by its index in LocalizationSetup::panels.
struct PanelPrior {
  std::string name;
  Pose T_odom_panel;
  /// Of each axis. Both zero: the pose is exact. Both infinite: it is not known, and T_odom_panel not used.
  double position_sigma_m = 0.0, angle_sigma_rad = 0.0;

  bool isKnown() const { return std::isfinite(position_sigma_m) && std::isfinite(angle_sigma_rad); }
};

struct LocalizationSetup {
  Vehicle vehicle;
  EffectParameters<double> calibration;
  LocalizationOptions options;
  std::optional<StartPose> start;  ///< absent: aligned from the first seconds
  Time time_zero;                  ///< the recording's first entry
  std::vector<PanelPrior> panels;  ///< that PanelSamples refer to
};

}  // namespace fathom
