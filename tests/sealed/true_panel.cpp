#include "true_panel.h"

#include <algorithm>
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
      flatness_(onPanel(
          ordinaryField(sealed, kOrdinary.flatness_m, kOrdinary.flatness_length_m, Stream::flatness))),
      illumination_(onPanel(ordinaryField(sealed, kOrdinary.illumination, kOrdinary.illumination_length_m,
                                          Stream::illumination))) {
  addOrdinary();
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

/// Each marker's place, and what the print is larger by.
void TruePanel::addOrdinary() {
  if (sealed_.ordinary == 0) return;
  Random random = stream(sealed_.seed, Stream::placement);
  const Vector3d sigma_m(kOrdinary.placement_m, kOrdinary.placement_m, kOrdinary.marker_height_m);
  for (const Marker& marker : map_.markers)
    ordinary_offset_m_[marker.id] = sealed_.ordinary * sigma_m.cwiseProduct(random.normal3());
  random = stream(sealed_.seed, Stream::stretch);
  const Vector3d drawn = random.normal3();
  ordinary_stretch_ = sealed_.ordinary * kOrdinary.stretch * drawn.head<2>();
  ordinary_scale_ = 1 + sealed_.ordinary * kOrdinary.marker_scale * drawn.z();
}

double TruePanel::folded_rad(double t_s) const {
  return radians(sealed_.outsideSize("panel-folded") + sealed_.number("panel-shape", "fold_deg", t_s));
}

bool TruePanel::flat() const {
  const auto shaped = [](const HiddenEffect& effect) { return effect.id == "panel-shape"; };
  return sealed_.outsideSize("panel-folded") == 0 && sealed_.outsideSize("panel-bowed") == 0 &&
         ripples_.empty() && flatness_.isZero() &&
         std::none_of(sealed_.effects.begin(), sealed_.effects.end(), shaped);
}

/// Before the plane, besides a fold. Twisted, two opposite corners are nearer; bowed, the middle is.
double TruePanel::height_m(const Vector3d& point_panel, double t_s) const {
  const double x = point_panel.x() / kHalfWidth_m, y = point_panel.y() / kHalfHeight_m;
  const double bow_m =
      sealed_.outsideSize("panel-bowed") / 1000 + sealed_.number("panel-shape", "bend_m", t_s);
  double height_m = bow_m * (1 - x * x) + sealed_.number("panel-shape", "twist_m", t_s) * x * y;
  for (const Ripple& ripple : ripples_)
    height_m +=
        ripple.amplitude_m * std::cos(ripple.wave_rad_m.dot(point_panel.head<2>()) + ripple.phase_rad);
  return height_m + flatness_.at(point_panel.x(), point_panel.y());
}

/// Stretched and sheared as printed; folded about its upright middle line, both halves towards who looks at
/// it.
Vector3d TruePanel::bent(const Vector3d& point_panel, double t_s) const {
  const auto shape = [&](const char* parameter) { return sealed_.number("panel-shape", parameter, t_s); };
  const double x =
      point_panel.x() * (1 + shape("stretch_x") + ordinary_stretch_.x()) + shape("shear") * point_panel.y();
  const double y = point_panel.y() * (1 + shape("stretch_y") + ordinary_stretch_.y());
  const double half_rad = folded_rad(t_s) / 2;
  return {x * std::cos(half_rad), y,
          point_panel.z() + std::abs(x) * std::sin(half_rad) + height_m(point_panel, t_s)};
}

double TruePanel::illumination(const Vector3d& point_panel, double t_s) const {
  const HiddenEffect* hidden = sealed_.find("illumination-gradient", t_s);
  if (!hidden && illumination_.isZero()) return 1.0;
  const double ordinary = 1 + illumination_.at(point_panel.x(), point_panel.y());
  if (!hidden) return ordinary;
  const std::vector<double>& gradient_per_m = hidden->parameters.find("gradient_per_m")->second;
  return ordinary * std::exp(gradient_per_m[0] * point_panel.x() + gradient_per_m[1] * point_panel.y());
}

Marker TruePanel::placed(const Marker& marker, double t_s) const {
  Marker real = marker;
  real.size_m *= (1 + sealed_.number("marker-size", "scale_error", t_s)) * ordinary_scale_;
  if (const auto offset = ordinary_offset_m_.find(marker.id); offset != ordinary_offset_m_.end())
    real.T_panel_marker.position += offset->second;
  const HiddenEffect* moved = sealed_.find("marker-moved", t_s);
  if (!moved || std::lround(sealed_.number("marker-moved", "marker_id", t_s)) != marker.id) return real;
  const double turned_rad = radians(sealed_.number("marker-moved", "rotation_deg", t_s));
  real.T_panel_marker.position += sealed_.vector("marker-moved", "offset_m", t_s);
  real.T_panel_marker.rotation = rotationFromYawPitchRoll(turned_rad, 0, 0) * real.T_panel_marker.rotation;
  return real;
}

/// Wider in its own axes, of the same area.
std::array<Vector3d, 4> TruePanel::placedCorners_panel(const Marker& placed) const {
  auto corners = placed.corners_panel();
  const double wider = std::sqrt(1 + sealed_.outsideSize("markers-wide"));
  if (wider == 1) return corners;
  const Matrix3d& R_panel_marker = placed.T_panel_marker.rotation;
  const Vector3d middle = placed.T_panel_marker.position;
  for (Vector3d& corner : corners) {
    const Vector3d from_middle = R_panel_marker.transpose() * (corner - middle);
    corner =
        middle + R_panel_marker * Vector3d(from_middle.x() * wider, from_middle.y() / wider, from_middle.z());
  }
  return corners;
}

std::array<Vector3d, 4> TruePanel::corners_panel(const Marker& marker, double t_s) const {
  auto corners = placedCorners_panel(placed(marker, t_s));
  for (Vector3d& corner : corners) corner = bent(corner, t_s);
  return corners;
}

}  // namespace fathom::sealed
