#pragma once

#include <array>

#include "core/scalar.h"
#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/rotation_vector.h"
#include "effects/stages.h"

namespace fathom {

struct PanelMoved {
  template <class T>
  using Stage = PanelPlacement<T>;
  static constexpr std::string_view id = "panel-moved";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "The panel was pushed while the robot worked",
      .equation = "from time_s on, T_odom_panel,true = T_odom_panel (Exp(rotation_deg), offset_m)",
      .source = "Definition",
      .confused_with = {"camera-misalignment", "marker-moved"},
      .told_apart = "Seeing it before and after: it steps in time on all markers at once"};
  static constexpr std::array parameters{
      Parameter{.name = "time_s",
                .unit = "s",
                .limit = 1e9,
                .kind = ParameterKind::time,
                .usual = "since the recording's first entry; 0 or before: the map is wrong from the start"},
      Parameter{.name = "offset_m",
                .unit = "m",
                .size = 3,
                .prior_sigma = 0.1,
                .limit = 100.0,
                .usual = "panel frame, within 0.3 m"},
      Parameter{.name = "rotation_deg",
                .unit = "deg",
                .size = 3,
                .prior_sigma = 5.0,
                .limit = 180.0,
                .usual = "rotation vector, panel frame, within 15 deg, mostly about the vertical"}};
  template <class T>
  static void apply(const T* p, Stage<T>& panel) {
    if (panel.t_s < valueOf(p[0])) return;
    panel.position_odom += panel.R_odom_panel * Vector3<T>(p[1], p[2], p[3]);
    panel.R_odom_panel = panel.R_odom_panel * rotationFromDegrees<T>({p[4], p[5], p[6]});
  }
};

}  // namespace fathom
