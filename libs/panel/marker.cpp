#include "panel/panel_map.h"

namespace fathom {

std::array<Vector3d, 4> Marker::corners_panel() const {
  const double half_m = size_m / 2;
  return {T_panel_marker * Vector3d(-half_m, half_m, 0), T_panel_marker * Vector3d(half_m, half_m, 0),
          T_panel_marker * Vector3d(half_m, -half_m, 0), T_panel_marker * Vector3d(-half_m, -half_m, 0)};
}

}  // namespace fathom
