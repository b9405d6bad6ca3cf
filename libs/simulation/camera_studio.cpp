#include "simulation/camera_studio.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <numbers>
#include <optional>
#include <utility>

#include "effects/drawn.h"
#include "image_files/bayer.h"
#include "image_files/jpeg.h"
#include "imaging/exposure_time.h"
#include "imaging/fingerprints.h"
#include "imaging/image_model.h"
#include "imaging/image_texture.h"
#include "imaging/lamp_glow.h"
#include "imaging/marine_snow.h"
#include "imaging/marker_blur.h"
#include "imaging/true_panel.h"
#include "render/scene.h"
#include "simulation/apparent_scene.h"

namespace fathom {
namespace {

constexpr double kSameRange_m = 1e-3;                            // of a panel, rendered twice
constexpr std::uint64_t kFlakesStream = std::uint64_t{1} << 61;  // of random numbers: far from all others

// Of what moves while the shutter is open.
constexpr double kUnseen_px = 0.03;  // an edge's blur of less than 1e-4 px²
constexpr double kStepsPerPixel = 2;
constexpr int kMostSteps = 64;
constexpr int kGrid_px = 16;  // at which its way in the image is looked at

/// The longest way in the image of what a view shows, while the shutter is open.
double longestWay_px(const View& view, const cv::Mat& rays, const TrueCamera& camera, double open_s) {
  double longest = 0;
  for (int v = 0; v < rays.rows; v += kGrid_px)
    for (int u = 0; u < rays.cols; u += kGrid_px) {
      const double range_m = view.range_m.at<float>(v, u);
      if (!std::isfinite(range_m)) continue;
      const cv::Vec3f& ray = rays.at<cv::Vec3f>(v, u);
      const Vector2d velocity_px_s =
          imageVelocity<double>(camera.lens, range_m * Vector3d(ray[0], ray[1], ray[2]),
                                camera.projector.velocity_camera, camera.projector.angular_velocity_camera);
      longest = std::max(longest, open_s * velocity_px_s.norm());
    }
  return longest;
}

/// The same so much later (negative: earlier).
CameraShot later(const CameraShot& shot, double seconds) {
  const CameraProjector<double>& moving = shot.camera.projector;
  const Pose T_camera_later{expSO3<double>(moving.angular_velocity_camera * seconds),
                            moving.velocity_camera * seconds};
  CameraShot moved = shot;
  moved.T_odom_robot = shot.T_odom_camera() * T_camera_later * shot.camera.T_robot_camera.inverse();
  moved.camera.projector.surface = moving.surface.seenAfter(T_camera_later.rotation, T_camera_later.position);
  return moved;
}

}  // namespace

/// What one thread needs for a lens.
struct CameraStudio::Eye {
  Renderer renderer;
  std::optional<Renderer> panels_alone;  // made where masks are asked for
  ImageModel model;
};

struct CameraStudio::Threads {
  tbb::enumerable_thread_specific<std::map<std::string, std::unique_ptr<Eye>>> eyes;
  std::mutex mutex;
  std::map<std::string, const Eye*> first;  // of each lens: what never changes of it, the others share
};

CameraStudio::CameraStudio(CameraWorld world, const CameraSheet& sheet, std::vector<LampSheet> lamps,
                           const EffectParameters<double>& effects)
    : world_(std::move(world)),
      sheet_(sheet),
      lamps_(std::move(lamps)),
      effects_(withoutDraws(effects)),
      panels_change_(changesPanels(effects)),
      scene_changes_(panels_change_ || anyActsAt<FlatPort<double>>(effects) ||
                     anyActsAt<DomePort<double>>(effects) || anyActsAt<WaterSurface<double>>(effects) ||
                     anyActsAt<Shutter<double>>(effects)),
      threads_(std::make_unique<Threads>()) {}

CameraStudio::~CameraStudio() = default;

CameraStudio::Eye& CameraStudio::eyeOf(const CameraModel& lens) const {
  const std::string fingerprint = fingerprintOf(lens);
  auto& eye = threads_->eyes.local()[fingerprint];
  if (eye) return *eye;
  const std::lock_guard lock(threads_->mutex);
  if (const Eye*& first = threads_->first[fingerprint]; first) {
    eye = std::make_unique<Eye>(Eye{first->renderer.another(), std::nullopt, first->model});
  } else {
    CameraSheet sheet = sheet_;
    sheet.model = lens;
    eye = std::make_unique<Eye>(
        Eye{Renderer(lens), std::nullopt, ImageModel(sheet, world_.environment.water, effects_)});
    first = eye.get();
  }
  if (!scene_changes_) eye->renderer.setScene(sceneOf(world_.panels, world_.sea_floor_odom));
  return *eye;
}

cv::Mat CameraStudio::rays(const CameraModel& lens) const { return eyeOf(lens).model.rays(); }

/// The panels where they truly are, on this sea floor, as a pinhole with the shot's lens would have to see
/// them.
Surface CameraStudio::asSeen(const CameraShot& shot, const Surface& sea_floor_odom) const {
  std::vector<PanelMap> moved;
  if (panels_change_)
    for (const PanelMap& panel : world_.panels) moved.push_back(truePanel(panel, effects_, shot.t_s));
  Surface scene = sceneOf(panels_change_ ? moved : world_.panels, sea_floor_odom);
  return shot.camera.bends() ? apparentScene(scene, shot.T_odom_camera(), shot.camera.projector) : scene;
}

const EffectParameters<double>& CameraStudio::effectsOn(const CameraShot& shot) const {
  return shot.effects ? *shot.effects : effects_;
}

SceneLight<double> CameraStudio::sceneLight(const CameraShot& shot, const Eigen::Vector2d& at_panel_m) const {
  SceneLight<double> light{at_panel_m};
  applyEffects(effectsOn(shot), shot.t_s, light);
  return light;
}

/// Whether daylight is another at each place of a panel.
bool CameraStudio::isUneven(const CameraShot& shot) const {
  return effectsOn(shot).isActive(kEffectIndex<IlluminationGradient>, shot.t_s) && !world_.panels.empty();
}

/// Multiplies by how much daylight there is at each pixel's place over that at the middle of the nearest
/// panel's face; beside the panel, as at its edge.
void CameraStudio::shedUnevenly(const CameraShot& shot, View& under_daylight) const {
  const double at_middle = sceneLight(shot).daylight;
  std::vector<Pose> T_panel_camera;
  std::vector<Eigen::Vector2d> reach_m;
  for (const PanelMap& panel : world_.panels) {
    T_panel_camera.push_back(truePanelPose(panel, effects_, shot.t_s).inverse() * shot.T_odom_camera());
    reach_m.push_back(panel.reach_m());
  }
  const cv::Mat& rays = eyeOf(shot.camera.lens).model.rays();
  for (int v = 0; v < rays.rows; ++v)
    for (int u = 0; u < rays.cols; ++u) {
      const double range_m = under_daylight.range_m.at<float>(v, u);
      if (!std::isfinite(range_m)) continue;
      const cv::Vec3f& ray = rays.at<cv::Vec3f>(v, u);
      const Vector3d point_camera = range_m * Vector3d(ray[0], ray[1], ray[2]);
      double nearest_m = std::numeric_limits<double>::infinity();
      Eigen::Vector2d at_panel_m = Eigen::Vector2d::Zero();
      for (std::size_t i = 0; i < T_panel_camera.size(); ++i) {
        const Vector3d point_panel = T_panel_camera[i] * point_camera;
        if (point_panel.norm() >= nearest_m) continue;
        nearest_m = point_panel.norm();
        at_panel_m = point_panel.head<2>().cwiseMax(-reach_m[i]).cwiseMin(reach_m[i]);
      }
      under_daylight.radiance.at<cv::Vec3f>(v, u) *=
          static_cast<float>(sceneLight(shot, at_panel_m).daylight / at_middle);
    }
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
cv::Mat CameraStudio::underLamp(const CameraShot& shot, const LampSheet& lamp, const Water& water) const {
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
      const Vector3d irradiance = lampIrradiance(lamp, point_robot, water.attenuation_per_m);
      for (int c = 0; c < 3; ++c) radiance[c] *= static_cast<float>(square * irradiance[c]);
    }
  return view.radiance;
}

View CameraStudio::render(const CameraShot& shot) const {
  const SceneLight<double> light = sceneLight(shot);
  const Lighting shining = lighting(shot.T_odom_robot, light.daylight);
  View view = render(shot, isUneven(shot) ? Lighting{shining.ambient, {}} : shining);
  if (isUneven(shot)) {
    shedUnevenly(shot, view);
    if (!shining.spots.empty())
      view.radiance += render(shot, Lighting{Eigen::Vector3f::Zero(), shining.spots}).radiance;
  }
  for (const LampSheet& lamp : lamps_)
    if (light.lamps > 0) view.radiance += light.lamps * underLamp(shot, lamp, world_.environment.water);
  return view;
}

View CameraStudio::renderAlbedo(const CameraShot& shot) const { return render(shot, Lighting{}); }

cv::Mat CameraStudio::panelMask(const CameraShot& shot, const View& view) const {
  cv::Mat hit = view.range_m < std::numeric_limits<float>::infinity();
  if (world_.sea_floor_odom.triangles.empty()) return hit;
  Eye& eye = eyeOf(shot.camera.lens);
  const bool first = !eye.panels_alone;
  if (first) eye.panels_alone.emplace(eye.renderer.another());
  if (first || scene_changes_) eye.panels_alone->setScene(asSeen(shot, {}));
  const View panels = eye.panels_alone->render(shot.T_odom_camera(), Lighting{});
  return hit & (panels.range_m <= view.range_m + kSameRange_m);  // not what is buried in the sand
}

/// Particles in the same daylight as the scene.
void CameraStudio::addSnow(const Environment& environment, const CameraShot& shot, const View& view,
                           cv::Mat& light) const {
  SuspendedParticles<double> particles;
  applyEffects(effectsOn(shot), shot.t_s, particles);
  if (particles.per_m3 <= 0) return;
  Environment lit = environment;
  lit.ambient *= sceneLight(shot).daylight;
  cv::Mat cosines;
  cv::extractChannel(eyeOf(shot.camera.lens).model.rays(), cosines, 2);
  drawSnow(light, view.range_m.mul(cosines), shot.camera.lens, lit, particles.per_m3,
           Random::stream(shot.particle_seed ^ std::bit_cast<std::uint64_t>(shot.t_s), kFlakesStream));
}

/// Of a lit view: radiance at the scene to light at the camera.
cv::Mat CameraStudio::throughWater(const Environment& environment, const CameraShot& shot,
                                   View&& view) const {
  Pose T_scene_camera = shot.T_odom_camera();
  if (!world_.panels.empty()) T_scene_camera.position -= world_.panels.front().T_odom_panel.position;
  const ImageModel model =
      eyeOf(shot.camera.lens).model.in(environment.water).with(effectsOn(shot)).at(T_scene_camera);
  cv::Mat light = std::exchange(view.radiance, {});
  model.throughWater(light, view.range_m, shot.t_s);
  if (const SceneLight<double> shining = sceneLight(shot); shining.lamps > 0)
    light += shining.lamps * shining.scattered *
             LampGlow(shot.camera.lens, shot.camera.T_robot_camera, lamps_, environment, shining.asymmetry)
                 .upTo(view.range_m);
  addSnow(environment, shot, view, light);
  return light;
}

/// The mean over the time for which the shutter is open.
cv::Mat CameraStudio::lightMeanwhile(const CameraShot& shot, View&& view) const {
  const double stated_s = sheet_.exposure_s;
  const double squared_s2 =
      exposureTime(beyondStated(effectsOn(shot), stated_s), shot.t_s, stated_s).squared_s2;
  const double open_s = std::sqrt(std::max(0.0, squared_s2));
  const double way_px = longestWay_px(view, eyeOf(shot.camera.lens).model.rays(), shot.camera, open_s);
  if (way_px < kUnseen_px) return throughWater(world_.environment, shot, std::move(view));
  const int steps = std::clamp(static_cast<int>(std::ceil(kStepsPerPixel * way_px)), 2, kMostSteps);
  // So far apart that so few steps scatter by as much as all times between.
  const double spread_s = open_s / std::sqrt(1 - 1.0 / (steps * steps));
  cv::Mat mean = std::exchange(view, {}).radiance;
  mean.setTo(0);
  for (int step = 0; step < steps; ++step) {
    const CameraShot then = later(shot, spread_s * ((step + 0.5) / steps - 0.5));
    cv::scaleAdd(throughWater(world_.environment, then, render(then)), 1.0 / steps, mean, mean);
  }
  return mean;
}

cv::Mat CameraStudio::lightIn(const Environment& environment, const CameraShot& shot,
                              const View& albedo) const {
  const SceneLight<double> light = sceneLight(shot);
  const Vector3d daylight = light.daylight * environment.ambient;
  // Matt surfaces: each colour's radiance goes with its daylight.
  View view{albedo.radiance.mul(cv::Scalar(daylight[0], daylight[1], daylight[2])), albedo.range_m};
  if (isUneven(shot)) shedUnevenly(shot, view);
  for (const LampSheet& lamp : lamps_)
    if (light.lamps > 0) view.radiance += light.lamps * underLamp(shot, lamp, environment.water);
  return throughWater(environment, shot, std::move(view));
}

cv::Mat CameraStudio::exposeLight(const CameraShot& shot, const cv::Mat& light, Random* noise) const {
  const cv::Mat image = eyeOf(shot.camera.lens).model.with(effectsOn(shot)).expose(light, noise, shot.t_s);
  const BayerPattern bayer = sheet_.model.bayer;
  const cv::Mat read = demosaiced(mosaic(image, bayer), bayer);
  ImageCoding<double> coding;
  applyEffects(effectsOn(shot), shot.t_s, coding);
  return read.depth() == CV_8U ? throughJpeg(read, codingQuality(coding)) : read;
}

}  // namespace fathom
