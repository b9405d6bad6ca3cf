#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "estimation/batch_data.h"
#include "estimation/forward_point.h"

/// What each reading of a batch should have been, and how that changes with motion, panel and effects: the
/// forward model of libs/sensors, differentiated.
namespace fathom {

/// The model of one reading.
class ReadingModel {
 public:
  virtual ~ReadingModel() = default;

  /// When it was valid, as these effects have it: seconds after its stamp.
  virtual double validity_s(const ForwardPoint& effects) const = 0;
  virtual Eigen::VectorXd predict(const ForwardPoint& point) const = 0;
  /// The same, and its derivative by the columns asked for.
  virtual Eigen::VectorXd differentiate(const ForwardPoint& point, const std::vector<int>& columns,
                                        Eigen::MatrixXd& derivative) const = 0;
  /// The motion's columns that it depends on where no effect carries the motion on (a latency, a shutter).
  virtual const std::vector<int>& motionColumns() const = 0;
  /// Whether this effect can change it.
  virtual bool dependsOn(std::size_t effect) const = 0;
};

/// Of an instrument's channel. The vehicle is referred to and must outlive it.
std::unique_ptr<ReadingModel> channelModel(const BatchReading& reading, const Vehicle& vehicle);
/// x0, y0, x1, …; not finite where a corner is behind the camera.
std::unique_ptr<ReadingModel> markerModel(const BatchMarker& reading);
/// By how much the eyes contradict each other, in units of sigma: contradiction().
std::unique_ptr<ReadingModel> tiePointModel(const BatchTiePoint& reading);
/// Of the colours that count.
std::unique_ptr<ReadingModel> patchModel(const ImagePatch& reading, const Vehicle& vehicle);
/// Variances of a normal blur.
std::unique_ptr<ReadingModel> blurModel(const MarkerBlur& reading);
/// Numbers of specks, by class.
std::unique_ptr<ReadingModel> specksModel(const ImageSpecks& reading);
/// Logarithms of the ratios of variances of an image's noise.
std::unique_ptr<ReadingModel> textureModel(const ImageTexture& reading);
/// Acceleration in odom and angular acceleration, both in robot axes: what a vehicle does little of.
std::unique_ptr<ReadingModel> accelerationModel(double t_s);
/// Position, and the rotation vector from a reference attitude in odom axes, of which z is the heading.
std::unique_ptr<ReadingModel> poseModel(const Pose& T_odom_robot, double t_s);

}  // namespace fathom
