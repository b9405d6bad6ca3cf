#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "fiducials/detection.h"
#include "imaging/detected_corners.h"
#include "imaging/image_patch.h"
#include "imaging/image_texture.h"
#include "imaging/marine_snow.h"
#include "imaging/marker_blur.h"
#include "imaging/water.h"
#include "landmarks/tie_points.h"
#include "panel/panel_map.h"
#include "sensors/channels.h"
#include "sensors/vehicle.h"

/// What goes into the batch estimate: readings of a whole recording, typed and plain. Times are stamps in
/// seconds since the recording's first entry.
namespace fathom {

/// One measurement of an instrument's channel, or the mean of those in one knot interval: what a
/// preintegrated increment says, over its time.
///
/// The mean of a quadratic function of time over the samples' times is the mean of its values at the nodes,
/// the mean time plus and minus the times' standard deviation: so measurement and prediction are averaged
/// alike.
struct BatchReading {
  Channel channel = kChannel<Prior>;
  std::array<double, 2> node_s{};  ///< equal where there is one sample
  int samples = 1;
  Observation seen;  ///< of the mean; of a rotation about the middle sample's

  double t_s() const { return 0.5 * (node_s[0] + node_s[1]); }
};

/// One marker in one image.
struct BatchMarker {
  double t_s = 0;
  std::size_t image = 0;  ///< number of the recording's entry with an image, from 0
  std::size_t eye = 0;    ///< of a pair: 0 left, 1 right
  Instance instance{};    ///< of the vehicle's cameras
  std::size_t panel = 0;  ///< index in BatchData::panels
  Marker marker;          ///< as the panel's map has it
  Detection detection;
  CameraModel camera;   ///< of this eye
  Pose T_robot_camera;  ///< nominal mounting of the left one
  Pose T_left_right;    ///< of the left eye: identity
  EdgeLight light;      ///< as it would be at an estimate; set by BatchProblem
};

/// One point that both eyes of a pair see, wherever it is: their lines of sight should meet. A reading in
/// units of its sigma.
struct BatchTiePoint {
  double t_s = 0;
  std::size_t image = 0;
  TiePoint point;
  std::array<CameraModel, 2> cameras;
  Pose T_left_right;  ///< nominal
};

struct BatchData {
  Time time_zero;                  ///< the recording's first entry
  double first_s = 0, last_s = 0;  ///< of all that follows
  double knot_s = 0.2;             ///< the INS is averaged over [k knot_s, (k + 1) knot_s)
  Vehicle vehicle;
  std::vector<PanelMap> panels;

  std::array<std::vector<BatchReading>, kInstrumentChannelCount> readings;  ///< by channel, then by time
  std::vector<BatchMarker> markers;
  std::vector<BatchTiePoint> tie_points;
  std::vector<ImagePatch> patches;
  std::vector<MarkerBlur> blurs;
  std::vector<ImageSpecks> specks;
  std::vector<ImageTexture> textures;
  Environment water;  ///< that its fit starts from; its lamps are off

  /// How many readings are not there, by the reason: not-a-number, impossible, duplicate, no such marker …
  std::map<std::string, std::size_t> left_out;

  /// Whether the path between images is known; else each image has a pose by itself.
  bool hasMotion() const;
  template <class C>
  std::vector<BatchReading>& of() {
    return readings[indexOf(kChannel<C>)];
  }
  template <class C>
  const std::vector<BatchReading>& of() const {
    return readings[indexOf(kChannel<C>)];
  }
};

}  // namespace fathom
