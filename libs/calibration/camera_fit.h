#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera_kinds.h"
#include "core/random.h"

/// Cameras from views of a board whose points are known: bundle adjustment over the camera and one pose a
/// view (Zhang 2000), ports included.
namespace fathom {

/// One image of a board.
struct BoardView {
  std::string name;                ///< no other has it
  std::vector<Vector3d> points_m;  ///< board frame
  std::vector<Vector2d> pixels;    ///< of each
  bool in_water = false;

  /// Every second point, from the first or the second on.
  BoardView half(std::size_t from) const;
};

struct CameraFit {
  const CameraKind* kind = nullptr;
  CameraSetting setting;
  CameraValues values = CameraValues::Zero();
  std::vector<std::size_t> unknowns;           ///< that were estimated, see cameraUnknowns()
  Eigen::MatrixXd covariance;                  ///< of these, by how views differ; poses being unknown
  std::map<std::string, Pose> T_camera_board;  ///< by the view's name
  double sigma_px = 0;                         ///< of a coordinate, by the residuals
  double rms_px = 0;                           ///< of a point
  std::size_t points = 0, outliers = 0;

  CameraProjector<double> projector(bool in_water) const {
    return projectorOf(values.data(), *kind, setting, in_water);
  }
  /// 0 of what was not estimated.
  double sigmaOf(std::size_t unknown) const;
};

/// From a fit of another kind, or of other views, or else from OpenCV's of all that are in air, if any is.
/// Points that lie off by more than five sigmas are left out. Throws std::invalid_argument: fewer than three
/// views, or one of fewer than six points.
CameraFit fitCamera(const std::vector<BoardView>& views, const CameraKind& kind, const CameraSetting& setting,
                    const std::optional<CameraFit>& start = {});

/// Pinhole and plumb-bob lens as cv::calibrateCamera() finds them, with its sigmas: what others have.
CameraFit fitByOpenCv(const std::vector<BoardView>& views, const CameraSetting& setting);

/// Where a camera stands that sees the view so: by least squares, from the pose that fits a pinhole.
Pose poseOfView(const CameraFit& camera, const BoardView& view);

}  // namespace fathom
