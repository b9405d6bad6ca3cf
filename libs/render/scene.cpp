#include "render/scene.h"

#include "render/sea_floor.h"

namespace fathom {

Surface seaFloorBelow(const std::vector<PanelMap>& panels, double sea_floor_z_m, Random sand) {
  Vector3d sum = Vector3d::Zero();
  for (const PanelMap& panel : panels) sum += panel.T_odom_panel.position;
  const Vector3d middle = sum / static_cast<double>(panels.size());
  SeaFloor floor;
  floor.centre_odom = {middle.x(), middle.y(), sea_floor_z_m};
  return seaFloor(floor, sand);
}

Surface sceneOf(const std::vector<PanelMap>& panels, const Surface& sea_floor_odom) {
  Surface scene;
  for (const PanelMap& panel : panels) scene.add(surfaceOf(panel), panel.T_odom_panel);
  scene.add(sea_floor_odom);
  return scene;
}

Surface sceneOf(const std::vector<PanelMap>& panels, double sea_floor_z_m, Random sand) {
  return sceneOf(panels, seaFloorBelow(panels, sea_floor_z_m, sand));
}

}  // namespace fathom
