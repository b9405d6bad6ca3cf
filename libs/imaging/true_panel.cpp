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
  applyEffects(effects, t_s, panel.shape);
  for (Marker& marker : panel.markers) {
    const auto there = markerPlacement(marker, effects, t_s);
    const auto corners = markerCorners_panel(marker, effects, t_s);
    MarkerCover<double> cover{marker.id};
    applyEffects(effects, t_s, cover);
    marker.covered = cover.share;
    marker.cover_albedo = cover.albedo;
    marker.size_m = there.size_m;
    marker.T_panel_marker = {there.R_panel_marker, there.position_panel};
    const auto square = marker.corners_panel();
    for (std::size_t k = 0; k < corners.size(); ++k)
      marker.off_square_m.col(static_cast<Eigen::Index>(k)) =
          there.R_panel_marker.transpose() * (corners[k] - square[k]);
  }
  return panel;
}

bool changesPanels(const EffectParameters<double>& effects) {
  return movesPanels(effects) || anyActsAt<MarkerCover<double>>(effects);
}

bool movesPanels(const EffectParameters<double>& effects) {
  return anyActsAt<MarkerPlacement<double>>(effects) || anyActsAt<PanelPlacement<double>>(effects) ||
         anyActsAt<FaceShape<double>>(effects);
}

}  // namespace fathom
