#pragma once

#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "fiducials/detection.h"
#include "fiducials/panel_pose.h"
#include "imaging/camera_geometry.h"
#include "panel/panel_map.h"

/// How well markers were found in an image, where truth is known.
namespace fathom {

/// Where a marker of the map truly shows.
struct MarkerPlace {
  const Marker* marker = nullptr;  ///< of the map
  std::array<Vector2d, 4> corners_px{};
  /// In the image whole, quiet zone of an eighth of its side included, its face towards the camera, nothing
  /// in front of it.
  bool visible = false;
};

/// The map's markers that are whole in front of the camera. `range_m` is the View's at this pose (see
/// render/renderer.h) and tells what hides a marker; empty: nothing does. The pointers are into the map.
std::vector<MarkerPlace> placesOf(const PanelMap& map, const CameraModel& camera, const Pose& T_camera_panel,
                                  const cv::Mat& range_m);
/// The same through a camera's true lines of sight; all rows are read at once. Of `camera`, the size counts.
std::vector<MarkerPlace> placesOf(const PanelMap& map, const CameraModel& camera,
                                  const CameraProjector<double>& projector, const Pose& T_camera_panel,
                                  const cv::Mat& range_m);

/// One image read once. Detections of markers that are not visible (a handle hides a corner), in their right
/// place, count neither for nor against.
struct ImageScore {
  int visible = 0;         ///< markers that should be found
  int found = 0;           ///< those whose corners are all within the tolerance
  int wrong = 0;           ///< detections that are not on the map, farther off, or of a marker found already
  int unknown = 0;         ///< of the wrong ones, those that are not on the map
  double squares_px2 = 0;  ///< sum of the squared distances of found markers' corners, four each
  bool posed = false;      ///< whether the panel's pose was solved; otherwise the next two are 0
  double position_error_m = 0;
  double angle_error_rad = 0;
};

ImageScore scoreDetections(const std::vector<Detection>& detections, const std::vector<MarkerPlace>& places,
                           double tolerance_px);
/// Solves the panel's pose from all detections and adds its errors.
void scorePose(const std::vector<Detection>& detections, const PanelMap& map, const CameraModel& camera,
               const Pose& T_camera_panel, ImageScore& score);

/// The 95 % interval of a rate of which `hits` of `count` were seen (Wilson 1927); [0, 1] where count is 0.
std::pair<double, double> wilsonInterval(std::size_t hits, std::size_t count);

/// Scores of many images together; NaN where there is nothing to tell.
class ScoreTally {
 public:
  void add(const ImageScore& score);

  std::size_t images() const { return images_; }
  std::size_t visible() const { return visible_; }
  std::size_t found() const { return found_; }
  std::size_t wrong() const { return wrong_; }
  std::size_t unknown() const { return unknown_; }
  std::size_t posed() const { return position_errors_m_.size(); }
  double detectionRate() const;
  std::pair<double, double> detectionRate95() const { return wilsonInterval(found_, visible_); }
  double cornerRms_px() const;  ///< root mean square distance of a found marker's corners
  double medianPositionError_m() const;
  double medianAngleError_rad() const;

 private:
  std::size_t images_ = 0, visible_ = 0, found_ = 0, wrong_ = 0, unknown_ = 0;
  double squares_px2_ = 0;
  std::vector<double> position_errors_m_, angle_errors_rad_;
};

}  // namespace fathom
