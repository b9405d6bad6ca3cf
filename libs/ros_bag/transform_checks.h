#pragma once

#include <optional>
#include <string>
#include <vector>

#include "recording/tum.h"

/// What contradicts itself in a bag's transforms.
namespace fathom {

/// How far apart two poses are.
struct PosesApart {
  double m = 0, deg = 0;

  /// "5.21 m and 0.5 deg"
  std::string text() const;
  bool exceeds(double most_m, double most_deg) const { return m > most_m || deg > most_deg; }
};
PosesApart apart(const Pose& a, const Pose& b);
/// Each at its largest.
PosesApart largest(const PosesApart& a, const PosesApart& b);

/// Poses that jump away from those before and after them, which agree, as where two publishers send them.
struct JumpingPoses {
  std::size_t count = 0;
  PosesApart typical;
};
/// Of poses in time order, equal times among them; nothing where they are few, as outliers are.
std::optional<JumpingPoses> jumpingPoses(const std::vector<StampedPose>& poses);

}  // namespace fathom
