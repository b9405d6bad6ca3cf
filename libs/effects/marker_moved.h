#pragma once

#include <array>
#include <cmath>

#include "core/scalar.h"
#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/rotation_vector.h"
#include "effects/stages.h"

namespace fathom {

struct MarkerMoved {
  template <class T>
  using Stage = MarkerPlacement<T>;
  static constexpr std::string_view id = "marker-moved";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "One marker is not where the panel map has it",
      .equation =
          "position_true = position + offset_m, R_true = Rz(rotation_deg) R\n"
          "panel frame",
      .source = "Definition",
      .confused_with = {"marker-size", "lens-distortion"},
      .told_apart = "Its neighbours in the same images: it shows on one id, wherever in the image"};
  static constexpr std::array parameters{
      Parameter{.name = "marker_id",
                .unit = "1",
                .limit = 1e6,
                .kind = ParameterKind::marker_id,
                .usual = "one of the panel map's"},
      Parameter{.name = "offset_m",
                .unit = "m",
                .size = 3,
                .prior_sigma = 0.02,
                .limit = 5.0,
                .usual = "true - map, panel frame, within 0.05 m, z near 0"},
      Parameter{.name = "rotation_deg",
                .unit = "deg",
                .prior_sigma = 2.0,
                .limit = 180.0,
                .usual = "counter-clockwise about the panel's z axis, within 5 deg"}};
  template <class T>
  static void apply(const T* p, Stage<T>& marker) {
    if (static_cast<int>(std::lround(valueOf(p[0]))) != marker.id) return;
    marker.position_panel += Vector3<T>(p[1], p[2], p[3]);
    marker.R_panel_marker = rotationFromDegrees<T>({T(0), T(0), p[4]}) * marker.R_panel_marker;
  }
};

}  // namespace fathom
