#pragma once

#include "effects/registry.h"
#include "panel/panel_map.h"

namespace fathom {

/// A panel as it truly is, t_s after the recording's first entry: its pose, the shape of its
/// face, its markers' places and sizes and what covers them, with what effects make of them. A marker moved
/// before the face stays a flat sheet there.
PanelMap truePanel(const PanelMap& nominal, const EffectParameters<double>& effects, double t_s);

/// Its pose alone.
Pose truePanelPose(const PanelMap& nominal, const EffectParameters<double>& effects, double t_s);

/// Whether these effects can make panels other than their maps.
bool changesPanels(const EffectParameters<double>& effects);

/// Whether they can do so to where markers' corners are.
bool movesPanels(const EffectParameters<double>& effects);

}  // namespace fathom
