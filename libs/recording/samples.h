#pragma once

#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/camera_model.h"
#include "core/geometry.h"
#include "core/time.h"
#include "core/uncertain_pose.h"
#include "sensors/all_instruments.h"

/// One entry of a recording as typed data, in the frames and units of the recording convention: right-handed,
/// metres, radians, z up; T_robot_sensor is the mounting.
namespace fathom {

namespace labels {
inline constexpr const char* kIns = Ins::label;
inline constexpr const char* kDvl = Dvl::label;
inline constexpr const char* kDvlBeams = DvlBeams::label;
inline constexpr const char* kDepth = Depth::label;
inline constexpr const char* kUsbl = Usbl::label;
inline constexpr const char* kCamera = "CAMERA";
inline constexpr const char* kStereo = "STEREO";
inline constexpr const char* kTruth = "TRUTH";
// Results, never recorded.
inline constexpr const char* kSimulated = "SIMULATED";         ///< image made for the CAMERA entry before it
inline constexpr const char* kMarkers = "MARKERS";             ///< robot pose from markers
inline constexpr const char* kPanel = "PANEL";                 ///< panels as seen from the camera
inline constexpr const char* kHandles = "HANDLES";             ///< handles as seen from the camera
inline constexpr const char* kMarkerSights = "MARKER_SIGHTS";  ///< where single markers were seen
}  // namespace labels

/// First entry of a recording: section [recording].
struct RecordingHeader {
  std::string panel_map;  ///< path relative to the rawlog's folder; empty: none
  std::string vehicle;    ///< likewise, the vehicle file
  std::string description;
};

/// A camera as rawlogs keep it: what this program computes with, and what it only passes on.
struct RecordedCamera {
  /// Its window, its Bayer pattern, and whether it is above water, are not kept.
  CameraModel model;
  bool is_undistorted = false;  ///< said so; else its model's lens
  double focal_length_m = 0;
  std::string name = "camera1";

  friend bool operator==(const RecordedCamera&, const RecordedCamera&) = default;
};

inline RecordedCamera recordedCamera(CameraModel model) {
  model.window = {};
  model.bayer = {};
  model.above_water = false;
  return {model};
}

struct ImageSample {
  Pose T_robot_camera;
  RecordedCamera intrinsics;
  std::string file;  ///< external file's name, relative to the recording's image folder
};

struct StereoSample {
  Pose T_robot_left, T_left_right;
  RecordedCamera left_intrinsics, right_intrinsics;
  std::string left_file, right_file;
};

/// Derived: panels seen in one image, or in both of a pair; under the label HANDLES, a panel's handles.
struct SeenPanel {
  int panel = 0;  ///< index in the list of panels that the recording is read with, or in the map's of handles
  /// From a joint solution over all its markers. Stored with its information matrix: none where the
  /// covariance is not positive definite, which reads back as NaN.
  UncertainPose T_camera_panel;
};
struct PanelSample {
  Pose T_robot_camera;  ///< of a pair, the left one
  std::vector<SeenPanel> panels;
};

/// Derived: single markers seen in an image, as RawLogViewer draws them.
struct SeenMarker {
  int id = 0;  ///< -1: not told apart; of two with the same id in one entry the second is stored so
  /// Of its centre, in a frame with x along the optical axis, z up. MRPT's order of rotations, so that a
  /// positive pitch is down: the centre is at range * (cos yaw cos pitch, sin yaw cos pitch, -sin pitch).
  /// Stored as floats.
  double range_m = 0, yaw_rad = 0, pitch_rad = 0;
  Matrix3d covariance = Matrix3d::Zero();  ///< of range, yaw, pitch; m and rad
};
struct MarkersSample {
  Pose T_robot_camera_forward;  ///< that frame on the robot
  std::vector<SeenMarker> markers;
};

/// An entry the convention does not know. It is counted by `fathom info` and otherwise left alone. Where its
/// fields cannot be read either (a class or version of a later MRPT), its label is empty and its time is that
/// of the entry before it.
struct UnknownSample {
  std::string mrpt_class;
  std::string unreadable = {};  ///< why its fields cannot be read, one line; empty where they can
};

namespace detail {
/// A pose by whichever instrument; an image's; what is derived.
template <class... Instruments>
auto readingOf(std::tuple<Instruments...>*)
    -> std::variant<typename Instruments::Sample..., ImageSample, StereoSample, PanelSample, MarkersSample,
                    RecordingHeader, UnknownSample>;
}  // namespace detail
using Reading = decltype(detail::readingOf(static_cast<AllInstruments*>(nullptr)));

struct Sample {
  Time time;          ///< of validity; Time{} where the entry has none
  std::string label;  ///< MRPT sensorLabel
  Reading reading;
};

}  // namespace fathom
