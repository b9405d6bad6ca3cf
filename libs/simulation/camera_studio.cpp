#include "simulation/camera_studio.h"

#include <tbb/enumerable_thread_specific.h>

#include <limits>
#include <map>
#include <optional>

#include "render/scene.h"
#include "sensors/fingerprints.h"
#include "sensors/image_model.h"
#include "sensors/true_panel.h"
#include "simulation/apparent_scene.h"

namespace fathom {
namespace {

constexpr double kSameRange_m = 1e-3;  // of a panel, rendered twice

}  // namespace

/// What one thread needs for a lens.
struct CameraStudio::Eye {
  Renderer renderer;
  std::optional<Renderer> panels_alone;  // made where masks are asked for
  ImageModel model;
};

struct CameraStudio::Threads {
  tbb::enumerable_thread_specific<std::map<std::string, std::unique_ptr<Eye>>> eyes;
};

CameraStudio::CameraStudio(CameraWorld world, const CameraSheet& sheet, std::vector<LampSheet> lamps,
                           const EffectParameters<double>& effects)
    : world_(std::move(world)),
      sheet_(sheet),
      lamps_(std::move(lamps)),
      effects_(effects),
      panels_move_(movesPanels(effects)),
      scene_changes_(panels_move_ || anyActsAt<FlatPort<double>>(effects) ||
                     anyActsAt<Shutter<double>>(effects)),
      threads_(std::make_unique<Threads>()) {}

CameraStudio::~CameraStudio() = default;

CameraStudio::Eye& CameraStudio::eyeOf(const CameraModel& lens) const {
  auto& eye = threads_->eyes.local()[fingerprintOf(lens)];
  if (eye) return *eye;
  CameraSheet sheet = sheet_;
  sheet.model = lens;
  eye = std::make_unique<Eye>(
      Eye{Renderer(lens), std::nullopt, ImageModel(sheet, world_.environment.water, effects_)});
  if (!scene_changes_) eye->renderer.setScene(sceneOf(world_.panels, world_.sea_floor_odom));
  return *eye;
}

/// The panels where they truly are, on this sea floor, as a pinhole with the shot's lens would have to see
/// them.
Surface CameraStudio::asSeen(const CameraShot& shot, const Surface& sea_floor_odom) const {
  std::vector<PanelMap> moved;
  if (panels_move_)
    for (const PanelMap& panel : world_.panels) moved.push_back(truePanel(panel, effects_, shot.t_s));
  Surface scene = sceneOf(panels_move_ ? moved : world_.panels, sea_floor_odom);
  return shot.camera.bends() ? apparentScene(scene, shot.T_odom_camera(), shot.camera.projector) : scene;
}

Lighting CameraStudio::lighting(const Pose& T_odom_robot) const {
  Lighting light{world_.environment.ambient.cast<float>(), {}};
  if (const auto& irradiance = world_.environment.lamps_irradiance_1m)
    for (const LampSheet& lamp : lamps_)
      light.spots.push_back(
          {T_odom_robot * lamp.T_robot_lamp, lamp.half_angle_rad, irradiance->cast<float>()});
  return light;
}

View CameraStudio::render(const CameraShot& shot, const Lighting& lighting) const {
  Renderer& renderer = eyeOf(shot.camera.lens).renderer;
  if (scene_changes_) renderer.setScene(asSeen(shot, world_.sea_floor_odom));
  return renderer.render(shot.T_odom_camera(), lighting);
}

View CameraStudio::render(const CameraShot& shot) const { return render(shot, lighting(shot.T_odom_robot)); }

View CameraStudio::renderAlbedo(const CameraShot& shot) const { return render(shot, Lighting{}); }

cv::Mat CameraStudio::panelMask(const CameraShot& shot, const View& view) const {
  cv::Mat hit = view.range_m < std::numeric_limits<float>::infinity();
  if (world_.sea_floor_odom.triangles.empty()) return hit;
  Eye& eye = eyeOf(shot.camera.lens);
  const bool first = !eye.panels_alone;
  if (first) eye.panels_alone.emplace(shot.camera.lens);
  if (first || scene_changes_) eye.panels_alone->setScene(asSeen(shot, {}));
  const View panels = eye.panels_alone->render(shot.T_odom_camera(), Lighting{});
  return hit & (panels.range_m <= view.range_m + kSameRange_m);  // not what is buried in the sand
}

cv::Mat CameraStudio::expose(const CameraShot& shot, const View& view, Random* noise) const {
  const ImageModel model = eyeOf(shot.camera.lens).model.with(shot.effects.value_or(effects_));
  return model.expose(model.light(view.radiance, view.range_m, shot.t_s), noise, shot.t_s);
}

}  // namespace fathom
