#include "simulation/camera_studio.h"

#include <tbb/enumerable_thread_specific.h>

#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "effects/drawn.h"
#include "render/scene.h"
#include "sensors/fingerprints.h"
#include "sensors/image_model.h"
#include "sensors/lamp_glow.h"
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
      effects_(withoutDraws(effects)),
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

const EffectParameters<double>& CameraStudio::effectsOn(const CameraShot& shot) const {
  return shot.effects ? *shot.effects : effects_;
}

SceneLight<double> CameraStudio::sceneLight(const CameraShot& shot) const {
  SceneLight<double> light;
  applyEffects(effectsOn(shot), shot.t_s, light);
  return light;
}

Lighting CameraStudio::lighting(const Pose& T_odom_robot, double daylight) const {
  Lighting light{(daylight * world_.environment.ambient).cast<float>(), {}};
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

/// What a lamp of irradiance 1 sheds on the scene: rendered as one that shines evenly all around, then each
/// pixel's light on its way through the beam and the water.
cv::Mat CameraStudio::underLamp(const CameraShot& shot, const LampSheet& lamp) const {
  Lighting lighting{Eigen::Vector3f::Zero(), {}};
  lighting.spots.push_back({shot.T_odom_robot * lamp.T_robot_lamp, std::numbers::pi, {1.0F, 1.0F, 1.0F}});
  View view = render(shot, lighting);
  const cv::Mat& rays = eyeOf(shot.camera.lens).model.rays();
  for (int v = 0; v < rays.rows; ++v)
    for (int u = 0; u < rays.cols; ++u) {
      auto& radiance = view.radiance.at<cv::Vec3f>(v, u);
      const double range_m = view.range_m.at<float>(v, u);
      if (!std::isfinite(range_m)) continue;
      const cv::Vec3f& ray = rays.at<cv::Vec3f>(v, u);
      const Vector3d point_robot =
          shot.camera.T_robot_camera * Vector3d(range_m * Vector3d(ray[0], ray[1], ray[2]));
      const double square = (point_robot - lamp.T_robot_lamp.position).squaredNorm();
      const Vector3d irradiance =
          lampIrradiance(lamp, point_robot, world_.environment.water.attenuation_per_m);
      for (int c = 0; c < 3; ++c) radiance[c] *= static_cast<float>(square * irradiance[c]);
    }
  return view.radiance;
}

View CameraStudio::render(const CameraShot& shot) const {
  const SceneLight<double> light = sceneLight(shot);
  View view = render(shot, lighting(shot.T_odom_robot, light.daylight));
  for (const LampSheet& lamp : lamps_)
    if (light.lamps > 0) view.radiance += light.lamps * underLamp(shot, lamp);
  return view;
}

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
  const ImageModel model = eyeOf(shot.camera.lens).model.with(effectsOn(shot));
  cv::Mat light = model.light(view.radiance, view.range_m, shot.t_s);
  if (const double lamps = sceneLight(shot).lamps; lamps > 0)
    light +=
        lamps *
        LampGlow(shot.camera.lens, shot.camera.T_robot_camera, lamps_, world_.environment).upTo(view.range_m);
  return model.expose(light, noise, shot.t_s);
}

}  // namespace fathom
