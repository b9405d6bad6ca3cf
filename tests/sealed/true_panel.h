#pragma once

#include <array>
#include <vector>

#include "panel/panel_map.h"
#include "sealed_case.h"

namespace fathom::sealed {

/// The panel as it really is: moved, bent, its markers elsewhere or larger than the map says.
class TruePanel {
 public:
  TruePanel(PanelMap map, const SealedCase& sealed);

  const PanelMap& map() const { return map_; }
  Pose T_odom_panel(double t_s) const;
  /// Whether it is as plane as the map has it.
  bool flat() const { return fold_rad_ == 0 && bow_m_ == 0 && ripples_.empty(); }
  /// Where a flat panel's point really is.
  Vector3d bent(const Vector3d& point_panel) const;
  /// A marker as it was put on, before the panel bends.
  Marker placed(const Marker& marker, double t_s) const;
  /// Top-left, top-right, bottom-right, bottom-left; panel frame.
  std::array<Vector3d, 4> corners_panel(const Marker& marker, double t_s) const;

 private:
  /// z = amplitude cos(wave . (x, y) + phase)
  struct Ripple {
    double amplitude_m;
    Eigen::Vector2d wave_rad_m;
    double phase_rad;
  };

  PanelMap map_;
  const SealedCase& sealed_;
  double fold_rad_, bow_m_;
  std::vector<Ripple> ripples_;
};

}  // namespace fathom::sealed
