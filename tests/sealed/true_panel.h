#pragma once

#include <array>
#include <map>
#include <vector>

#include "ordinary.h"
#include "panel/panel_map.h"
#include "sealed_case.h"

namespace fathom::sealed {

/// The panel as it really is: moved, bent, its markers elsewhere or larger than the map says.
class TruePanel {
 public:
  TruePanel(PanelMap map, const SealedCase& sealed);

  const PanelMap& map() const { return map_; }
  Pose T_odom_panel(double t_s) const;
  /// Whether it is as plane as the map has it at any time.
  bool flat() const;
  /// Where a flat panel's point really is.
  Vector3d bent(const Vector3d& point_panel, double t_s) const;
  /// The fraction of the daylight that its point there gets.
  double illumination(const Vector3d& point_panel, double t_s) const;
  /// A marker as it was put on, before the panel bends.
  Marker placed(const Marker& marker, double t_s) const;
  /// Of a marker that was put on so, as wide as it was printed, before the panel bends.
  std::array<Vector3d, 4> placedCorners_panel(const Marker& placed) const;
  /// Top-left, top-right, bottom-right, bottom-left; panel frame.
  std::array<Vector3d, 4> corners_panel(const Marker& marker, double t_s) const;

 private:
  /// z = amplitude cos(wave . (x, y) + phase)
  struct Ripple {
    double amplitude_m;
    Eigen::Vector2d wave_rad_m;
    double phase_rad;
  };

  void addOrdinary();
  double folded_rad(double t_s) const;
  double height_m(const Vector3d& point_panel, double t_s) const;

  PanelMap map_;
  const SealedCase& sealed_;
  std::vector<Ripple> ripples_;
  double ordinary_scale_ = 1;  ///< of all markers
  Eigen::Vector2d ordinary_stretch_{0, 0};
  std::map<int, Vector3d> ordinary_offset_m_;  ///< by marker's id
  FieldTable flatness_, illumination_;
};

}  // namespace fathom::sealed
