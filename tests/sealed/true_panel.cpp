#include "true_panel.h"

#include <cmath>
#include <numbers>

#include "panel_design.h"
#include "streams.h"

namespace fathom::sealed {

/// A rich recording's panel is not quite plane: three ripples, together 0.3 to 1 mm at their highest, as of a
/// plate that was cut and painted.
TruePanel::TruePanel(PanelMap map, const SealedCase& sealed)
    : map_(std::move(map)),
      sealed_(sealed),
      fold_rad_(radians(sealed.outsideSize("panel-folded"))),
      bow_m_(sealed.outsideSize("panel-bowed") / 1000) {
  if (!sealed.rich) return;
  Random random = stream(sealed.seed, Stream::ripple);
  const double highest_m = random.uniform(0.0003, 0.001);
  for (int i = 0; i < 3; ++i) {
    const double wavelength_m = random.uniform(0.4, 1.2), towards_rad = random.uniform(0, std::numbers::pi);
    const double wave_rad_m = 2 * std::numbers::pi / wavelength_m;
    ripples_.push_back({highest_m / 3,
                        wave_rad_m * Eigen::Vector2d(std::cos(towards_rad), std::sin(towards_rad)),
                        random.uniform(0, 2 * std::numbers::pi)});
  }
}

Pose TruePanel::T_odom_panel(double t_s) const {
  const HiddenEffect* pushed = sealed_.find("panel-moved", t_s);
  if (!pushed || t_s < sealed_.number("panel-moved", "time_s", t_s)) return map_.T_odom_panel;
  return map_.T_odom_panel * Pose{sealed_.rotation("panel-moved", "rotation_deg", t_s),
                                  sealed_.vector("panel-moved", "offset_m", t_s)};
}

/// Folded about its upright middle line, both halves towards who looks at it; bowed, its middle nearer.
Vector3d TruePanel::bent(const Vector3d& point_panel) const {
  Vector3d bent = point_panel;
  bent.x() = point_panel.x() * std::cos(fold_rad_ / 2);
  bent.z() += std::abs(point_panel.x()) * std::sin(fold_rad_ / 2);
  bent.z() += bow_m_ * (1 - std::pow(point_panel.x() / kHalfWidth_m, 2));
  for (const Ripple& ripple : ripples_)
    bent.z() +=
        ripple.amplitude_m * std::cos(ripple.wave_rad_m.dot(point_panel.head<2>()) + ripple.phase_rad);
  return bent;
}

Marker TruePanel::placed(const Marker& marker, double t_s) const {
  Marker real = marker;
  real.size_m *= 1 + sealed_.number("marker-size", "scale_error", t_s);
  const HiddenEffect* moved = sealed_.find("marker-moved", t_s);
  if (!moved || std::lround(sealed_.number("marker-moved", "marker_id", t_s)) != marker.id) return real;
  const double turned_rad = radians(sealed_.number("marker-moved", "rotation_deg", t_s));
  real.T_panel_marker.position += sealed_.vector("marker-moved", "offset_m", t_s);
  real.T_panel_marker.rotation = rotationFromYawPitchRoll(turned_rad, 0, 0) * real.T_panel_marker.rotation;
  return real;
}

std::array<Vector3d, 4> TruePanel::corners_panel(const Marker& marker, double t_s) const {
  auto corners = placed(marker, t_s).corners_panel();
  for (Vector3d& corner : corners) corner = bent(corner);
  return corners;
}

}  // namespace fathom::sealed
