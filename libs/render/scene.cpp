#include "render/scene.h"

#include "render/sea_floor.h"

namespace fathom {

Surface sceneOf(const std::vector<PanelMap>& panels, double sea_floor_z_m, Random sand) {
  Surface scene;
  Vector3d sum = Vector3d::Zero();
  for (const PanelMap& panel : panels) {
    scene.add(surfaceOf(panel), panel.T_odom_panel);
    sum += panel.T_odom_panel.position;
  }
  const Vector3d middle = sum / static_cast<double>(panels.size());
  SeaFloor floor;
  floor.centre_odom = {middle.x(), middle.y(), sea_floor_z_m};
  scene.add(seaFloor(floor, std::move(sand)));
  return scene;
}

}  // namespace fathom
