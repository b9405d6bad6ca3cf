#pragma once

#include <memory>

#include "estimation/batch_estimate.h"
#include "estimation/linearization.h"
#include "imaging/camera_geometry.h"
#include "simulation/navigation_simulator.h"
#include "support/detections.h"
#include "support/motions.h"
#include "support/shipped.h"
#include "support/streams.h"

/// Recordings for the batch estimate: navigation sensors simulated, markers' corners straight from the
/// camera's forward model, without an image.
namespace fathom::test {

/// 2 to 4 m before a panel at x = 6 m: turning, sidling, diving; a second a period of the fastest part.
Pose beforePanel(double t);

Trajectory pathBeforePanel(double duration_s);

struct BatchRun {
  Vehicle vehicle;
  EffectParameters<double> effects;  ///< what is true
  double duration_s;
  bool noise = true;
  double corner_sigma_px = 0.15;
  std::uint64_t seed = 1;
  PanelMap panel;       ///< as the map has it
  bool pixels = false;  ///< black, white and edges of each marker, open water, specks and texture, straight
                        ///< from the forward models

  // What no effect describes.
  std::optional<PanelMap> true_panel;  ///< where it is not as the map has it
  double corner_tail_dof = 0;          ///< of Student's t instead of a normal, of the same sigma; 0: normal
  double camera_shake_rad = 0;         ///< the mounting turns anew with every image; one axis

  explicit BatchRun(double seconds = 40.0) : BatchRun(seconds, pathBeforePanel(seconds + 10.0)) {}
  /// The path begins 4 s before the recording and goes on for 4 s or more after it.
  BatchRun(double seconds, Trajectory path);

  std::vector<Sample> samples() const;
  Detections detections() const;
  std::vector<ImagePatch> patches() const;
  std::vector<MarkerBlur> blurs() const;
  std::vector<ImageSpecks> specks() const;
  std::vector<ImageTexture> textures() const;
  BatchInput input(const EffectParameters<double>& calibration = {}) const {
    return input(samples(), calibration);
  }
  /// With other samples than its own.
  BatchInput input(const std::vector<Sample>& all, const EffectParameters<double>& calibration = {}) const;
  /// The robot's pose t_s after the first entry.
  Pose truth(double t_s) const {
    const auto state = path_.at(kBegin_s + t_s);
    return {state.R_odom_robot, state.position_odom};
  }

 private:
  static constexpr double kBegin_s = 4.0;  ///< the path's own beginning has no acceleration
  SimulationOptions options() const;
  KinematicState<double> stateAtImage(double t_s) const;
  std::vector<ImagePatch> emptyPatches() const;  ///< one an image, with what all of its patches share
  Vector3d readingOf(const ImagePatch& patch, Random& random) const;
  std::vector<ImagePatch> patchesOfMarkers() const;
  std::vector<ImagePatch> patchesOfWater() const;
  Vector8d cornerErrors(Random& random) const;
  Trajectory path_;
};

/// A coastal water, as waterParameters().
Vector9d coastalWater();

}  // namespace fathom::test
