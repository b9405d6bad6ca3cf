#include "imaging/true_panel.h"

#include "imaging/camera_geometry.h"

namespace fathom {

Pose truePanelPose(const PanelMap& nominal, const EffectParameters<double>& effects, double t_s) {
  auto placement = nominalPlacement<double>(nominal.T_odom_panel, t_s);
  applyEffects(effects, t_s, placement);
  return {placement.R_odom_panel, placement.position_odom};
}

PanelMap truePanel(const PanelMap& nominal, const EffectParameters<double>& effects, double t_s) {
  PanelMap panel = nominal;
  panel.T_odom_panel = truePanelPose(nominal, effects, t_s);
  for (Marker& marker : panel.markers) {
    const auto there = markerPlacement(marker, effects, t_s);
    marker.size_m = there.size_m;
    marker.T_panel_marker = {there.R_panel_marker, there.position_panel};
  }
  return panel;
}

bool movesPanels(const EffectParameters<double>& effects) {
  return anyActsAt<MarkerPlacement<double>>(effects) || anyActsAt<PanelPlacement<double>>(effects);
}

}  // namespace fathom
