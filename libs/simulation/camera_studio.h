#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "core/random.h"
#include "imaging/true_camera.h"
#include "imaging/water.h"
#include "panel/panel_map.h"
#include "render/renderer.h"
#include "sensors/vehicle.h"

namespace fathom {

class ImageModel;

/// What a vehicle's camera sees: panels as their maps have them, on a sea floor or, where that is empty, in
/// endless water.
struct CameraWorld {
  std::vector<PanelMap> panels;
  Surface sea_floor_odom;
  Environment environment;
};

/// An image to be taken.
struct CameraShot {
  Pose T_odom_robot;
  TrueCamera camera;
  double t_s = 0;  ///< its stamp, after the recording's first entry
  /// In this very image, see drawnFor(); absent: the studio's, as if nothing had been drawn.
  std::optional<EffectParameters<double>> effects = {};
  /// With the stamp, of which flakes of marine snow are where.
  std::uint64_t particle_seed = 0;

  Pose T_odom_camera() const { return T_odom_robot * camera.T_robot_camera; }
};

/// The camera's forward model from the world to the numbers of an image, with the effects that are on at its
/// stamp: panels and markers where they truly are, lines of sight as the camera has them, daylight and the
/// vehicle's lamps (where the environment says so), water and what drifts in it, the time for which the
/// shutter is open, sensor. For many threads at once; each keeps a renderer of its own for each lens.
class CameraStudio {
 public:
  /// Of the sheet only the sensor counts: lens and mounting are each shot's own.
  CameraStudio(CameraWorld world, const CameraSheet& sheet, std::vector<LampSheet> lamps,
               const EffectParameters<double>& effects);
  ~CameraStudio();
  CameraStudio(const CameraStudio&) = delete;
  CameraStudio& operator=(const CameraStudio&) = delete;

  /// raysOf() a lens.
  cv::Mat rays(const CameraModel& lens) const;
  /// What would be seen without the water between it and the camera.
  View render(const CameraShot& shot) const;
  /// The same under full ambient light, lamps off: its radiance is the albedo.
  View renderAlbedo(const CameraShot& shot) const;
  /// CV_8UC1: 255 where a view that was rendered shows a panel, 0 elsewhere.
  cv::Mat panelMask(const CameraShot& shot, const View& view) const;
  /// The light that comes to the camera of a view that renderAlbedo() made, CV_32FC3: under this
  /// environment's daylight and through its water instead of the world's. Lamps shine as effects have them;
  /// nothing is smeared by motion.
  cv::Mat lightIn(const Environment& environment, const CameraShot& shot, const View& albedo) const;
  /// The numbers that become of light, see ImageModel; of a camera that measures one colour a pixel as
  /// readImage() gives them; where they have eight bits, through the compression that is on. Without
  /// `noise`: none.
  cv::Mat exposeLight(const CameraShot& shot, const cv::Mat& light, Random* noise) const;
  /// The image that becomes of a view.
  cv::Mat expose(const CameraShot& shot, const View& view, Random* noise) const {
    return exposeLight(shot, lightMeanwhile(shot, {view.radiance.clone(), view.range_m}), noise);
  }
  cv::Mat image(const CameraShot& shot, Random* noise) const {
    return exposeLight(shot, lightMeanwhile(shot, render(shot)), noise);
  }

 private:
  struct Eye;
  struct Threads;

  Eye& eyeOf(const CameraModel& lens) const;
  Surface asSeen(const CameraShot& shot, const Surface& sea_floor_odom) const;
  const EffectParameters<double>& effectsOn(const CameraShot& shot) const;
  void addSnow(const Environment& environment, const CameraShot& shot, const View& view,
               cv::Mat& light) const;
  SceneLight<double> sceneLight(const CameraShot& shot, const Eigen::Vector2d& at_panel_m = {0, 0}) const;
  bool isUneven(const CameraShot& shot) const;
  void shedUnevenly(const CameraShot& shot, View& under_daylight) const;
  View render(const CameraShot& shot, const Lighting& lighting) const;
  Lighting lighting(const Pose& T_odom_robot, double daylight) const;
  cv::Mat underLamp(const CameraShot& shot, const LampSheet& lamp, const Water& water) const;
  cv::Mat throughWater(const Environment& environment, const CameraShot& shot, View&& view) const;
  cv::Mat lightMeanwhile(const CameraShot& shot, View&& view) const;

  CameraWorld world_;
  CameraSheet sheet_;
  std::vector<LampSheet> lamps_;
  EffectParameters<double> effects_;
  bool panels_change_, scene_changes_;
  std::unique_ptr<Threads> threads_;
};

}  // namespace fathom
