#include "imaging/detected_corners.h"

namespace fathom {

template std::array<Vector2<double>, 4> predictDetectedCorners(
    const KinematicState<double>&, const PanelPlacement<double>&, const Marker&, const CameraModel&,
    const Pose&, const EdgeLight&, const EffectParameters<double>&, double, const Pose&);

}  // namespace fathom
