#pragma once

#include <array>

#include "effects/effect_text.h"
#include "effects/parameter.h"
#include "effects/stages.h"

namespace fathom {

struct PanelShape {
  template <class T>
  using Stage = FaceShape<T>;
  static constexpr std::string_view id = "panel-shape";
  static constexpr EffectText text{
      .channel = EffectChannel::marker_geometry,
      .title = "The panel is stretched, sheared, folded, twisted or bent against its map",
      .equation =
          "x' = cos(fold/2) x1, y' = (1 + stretch_y) y, z' = z + sin(fold/2) |x1| + twist_m u v + bend_m (1 "
          "- "
          "(u^2 + v^2)/2)\n"
          "x1 = (1 + stretch_x) x + shear y; u, v: x and y over half the face's width and height\n"
          "panel frame, from the middle of the face, z out of it: every corner of every marker moves so",
      .source =
          "Affine, and the lowest terms of a surface's series; printed targets are off by as much (Strobl & "
          "Hirzinger 2011, imperfect planar targets)",
      .confused_with = {"marker-moved", "marker-size", "focal-scale", "lens-distortion"},
      .told_apart =
          "Many markers at once, from both sides and from near by: it stays with the panel, lens and port "
          "stay with the image; one marker that moved leaves its neighbours"};
  static constexpr std::array parameters{
      Parameter{.name = "stretch_x",
                .unit = "1",
                .prior_sigma = 1e-3,
                .limit = 0.5,
                .usual = "true/nominal - 1 along the panel's width, within 0.003"},
      Parameter{.name = "stretch_y",
                .unit = "1",
                .prior_sigma = 1e-3,
                .limit = 0.5,
                .usual = "the same along its height"},
      Parameter{.name = "shear",
                .unit = "1",
                .prior_sigma = 1e-3,
                .limit = 0.5,
                .usual = "x that is added for each y: top edge to the right, within 0.003"},
      Parameter{.name = "fold_deg",
                .unit = "deg",
                .prior_sigma = 0.3,
                .limit = 90.0,
                .usual = "between left and right half, about the vertical middle line; positive: towards "
                         "whoever looks at it, within 1 deg"},
      Parameter{.name = "twist_m",
                .unit = "m",
                .prior_sigma = 0.002,
                .limit = 1.0,
                .usual = "height of the corners: top right and bottom left forward, the others back, within "
                         "0.005 m"},
      Parameter{.name = "bend_m",
                .unit = "m",
                .prior_sigma = 0.002,
                .limit = 1.0,
                .usual = "height of the middle over the corners, within 0.005 m"}};
  template <class T>
  static void apply(const T* p, Stage<T>& shape) {
    shape.stretch_x += p[0];
    shape.stretch_y += p[1];
    shape.shear += p[2];
    shape.fold_rad += p[3] * radians(1.0);
    shape.twist_m += p[4];
    shape.bend_m += p[5];
  }
};

}  // namespace fathom
