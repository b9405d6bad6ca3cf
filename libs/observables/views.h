#pragma once

#include <cstdint>
#include <opencv2/core.hpp>

#include "simulation/camera_studio.h"

/// Views of a panel from all around, and what the vehicle's camera makes of them: the images on which
/// estimators are judged.
namespace fathom {

/// The map of a panel that stands at odom's origin, as views of it have it.
PanelMap atOrigin(PanelMap map);
/// Throws std::invalid_argument where the vehicle has none.
const CameraSheet& cameraOf(const Vehicle& vehicle);

/// Where a camera stands and where it looks.
struct CameraView {
  std::uint64_t number = 0;  ///< of its random numbers
  double range_m = 0;        ///< camera to panel's centre
  double tilt_rad = 0;       ///< between the panel's normal and the line from its centre to the camera
  double azimuth_rad = 0;    ///< of that line about the normal, from the panel's x axis towards its y axis
  double roll_rad = 0;  ///< of the camera about its optical axis; 0: the panel's y axis is up in the image
  /// Where the optical axis meets the face, m: the panel's centre, or somewhat beside it.
  Vector2d aim_panel = Vector2d::Zero();
  double t_s = 0;  ///< since a recording's first entry: which effects are active

  Pose T_panel_camera() const;
};

/// What views are drawn from, each quantity uniformly, the aim uniformly in a square.
struct ViewRanges {
  double nearest_m = 1.0, farthest_m = 4.0;
  double smallest_tilt_rad = 0.0, largest_tilt_rad = radians(60);
  double largest_roll_rad = radians(30);  ///< to both sides
  double largest_aim_m = 0.15;            ///< in x and in y, to both sides
};

/// View number k of a seed: the same whichever others are drawn. Throws std::invalid_argument where ranges
/// are empty, not positive, or a tilt or roll is not in [0, 89] or [0, 180] degrees.
CameraView drawView(const ViewRanges& ranges, std::uint64_t seed, std::uint64_t number);

/// The view of a camera that stands in front of the face (z > 0) and looks at it; its number is 0. Throws
/// std::invalid_argument where it does not.
CameraView viewOf(const Pose& T_panel_camera);

/// Whether a marker lies in the image whole, quiet zone of an eighth of its side included, with its face
/// towards the camera.
bool isWhole(const Marker& marker, const CameraModel& camera, const Pose& T_panel_camera);
/// The same through a camera's true lines of sight. Of `camera`, the size counts.
bool isWhole(const Marker& marker, const CameraModel& camera, const CameraProjector<double>& projector,
             const Pose& T_panel_camera);
/// How many of a map's markers do.
std::size_t wholeMarkers(const PanelMap& map, const CameraModel& camera, const Pose& T_panel_camera);

/// Makes the camera's image of a panel that stands alone in endless water, by the simulator's forward model
/// (CameraStudio). Lamps are on where the environment or an effect says so, and move with the camera as they
/// do on the vehicle. For many threads at once.
///
/// With effects, lens, light, markers and sensor are as they truly are then. The camera truly is where the
/// view has it, before the panel where that truly is, and stands still: effects on its mounting, on the
/// panel's pose and on time do nothing. What is drawn for each image is drawn for each view, by the seed and
/// its number.
class ViewStudio {
 public:
  /// Throws std::invalid_argument where the vehicle has no camera.
  ViewStudio(const PanelMap& map, const Vehicle& vehicle, const Environment& environment,
             const EffectParameters<double>& effects = {});

  /// Blue, green, red; CV_8UC3, or CV_16UC3 where the sheet has more than 8 bits. The noise depends on the
  /// seed and the view's number only.
  cv::Mat image(const CameraView& view, std::uint64_t seed) const;
  /// Without noise, and as if nothing had been drawn.
  cv::Mat imageWithoutNoise(const CameraView& view) const;

  /// What is taken of a view; nothing is drawn for it yet.
  CameraShot shot(const CameraView& view) const;
  CameraShot shot(const CameraView& view, std::uint64_t seed) const;
  const CameraStudio& studio() const { return studio_; }

 private:
  CameraSheet sheet_;
  EffectParameters<double> effects_;
  CameraStudio studio_;  ///< whose odom frame is the panel's
};

}  // namespace fathom
