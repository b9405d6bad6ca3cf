#pragma once

#include <optional>
#include <string>
#include <vector>

#include "landmarks/landmark_source.h"
#include "simulation/camera_studio.h"

/// Where each image of a recording was taken, as its own markers tell: the first half of the paper's
/// Algorithm 1 (markers -> panel pose -> robot pose).
namespace fathom {

/// One image; an entry with a pair gives two.
struct PosedImage {
  Time time;
  std::size_t number = 0;  ///< among all images of the recording, those that are not posed included
  std::size_t entry = 0;   ///< among the recording's entries with images
  std::size_t eye = 0;     ///< 0: the only or the left one
  CameraImage image;
  UncertainPose
      T_odom_robot;       ///< by the joint solution of the panel that is known best, its map's pose exact
  Pose T_robot_camera;    ///< of this very eye, as the recording has it
  TrueCamera camera;      ///< the same as it truly is
  double t_s = 0;         ///< since the recording's first entry; 0 where no effect is on
  std::size_t panel = 0;  ///< the panel that told the pose
  std::vector<Detection> detections;  ///< all that was found in it
  /// See CameraShot.
  std::optional<EffectParameters<double>> effects{};

  CameraShot shot() const { return {T_odom_robot.pose, camera, t_s, effects}; }
  Pose T_odom_camera() const { return shot().T_odom_camera(); }
};

/// From the camera to the centre of the panel that told its pose.
double range_m(const PosedImage& posed, const std::vector<PanelMap>& panels);

struct UnposedImage {
  Time time;
  std::size_t number = 0;
  std::filesystem::path file;
  std::string why;  ///< one line: not readable, no marker, ambiguous, …
};

struct PosedImages {
  std::vector<PosedImage> posed;      ///< in the order of the recording
  std::vector<UnposedImage> unposed;  ///< likewise
  std::vector<std::string> remarks;   ///< what a user should know, one line each
};

/// `sightings` are those of the entries (solveSightings), solved with the same calibration.
PosedImages posedImages(const std::vector<ImageEntry>& entries, const Detections& detections,
                        const Sightings& sightings, const std::vector<PanelMap>& panels,
                        const LandmarkCalibration& calibration = {});

/// The same from a rawlog: finds the markers in its images (they are kept beside it, see keepBeside), and
/// solves for the panels. Images in order of time, whatever the rawlog's. Throws Error where the rawlog
/// cannot be read or has no images; Interrupted.
PosedImages posedImages(const std::filesystem::path& rawlog, const Vehicle& vehicle,
                        const std::vector<PanelMap>& panels, const DetectionSettings& settings,
                        const EffectParameters<double>& effects = {});

/// Keeps those of so many moments, spread evenly over all that there are; both eyes of a pair. Returns how
/// many moments there were.
std::size_t keepSpread(std::vector<PosedImage>& posed, std::size_t moments);

}  // namespace fathom
