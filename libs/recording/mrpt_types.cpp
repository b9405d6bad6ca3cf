#include "recording/mrpt_types.h"

#include <type_traits>

namespace fathom {

static_assert(std::is_same_v<mrpt::Clock::period, UtcClock::period> &&
              std::is_same_v<mrpt::Clock::rep, UtcClock::rep>);
mrpt::poses::CPose3D toMrpt(const Pose& pose) {
  mrpt::math::CMatrixDouble33 R;
  R.asEigen() = pose.rotation;
  mrpt::math::CVectorFixedDouble<3> t;
  t.asEigen() = pose.position;
  return {R, t};
}

Pose fromMrpt(const mrpt::poses::CPose3D& pose) {
  return {pose.getRotationMatrix().asEigen(), Vector3d(pose.x(), pose.y(), pose.z())};
}

mrpt::poses::CPose3DPDFGaussian toMrpt(const YawPitchRollPose& pose) {
  return {toMrpt(pose.mean), mrpt::math::CMatrixDouble66(pose.covariance)};
}

YawPitchRollPose fromMrpt(const mrpt::poses::CPose3DPDFGaussian& pdf) {
  return {fromMrpt(pdf.mean), pdf.cov.asEigen()};
}

mrpt::img::TCamera toMrpt(const RecordedCamera& camera) {
  const CameraModel& m = camera.model;
  mrpt::img::TCamera mrpt;
  mrpt.ncols = static_cast<std::uint32_t>(m.width_px);
  mrpt.nrows = static_cast<std::uint32_t>(m.height_px);
  mrpt.setIntrinsicParamsFromValues(m.fx_px, m.fy_px, m.cx_px, m.cy_px);
  using mrpt::img::DistortionModel;
  mrpt.distortion = camera.is_undistorted          ? DistortionModel::none
                    : m.lens == LensModel::fisheye ? DistortionModel::kannala_brandt
                                                   : DistortionModel::plumb_bob;
  mrpt.dist = {m.k1, m.k2, m.p1, m.p2, m.k3, m.k4, m.k5, m.k6};
  mrpt.focalLengthMeters = camera.focal_length_m;
  mrpt.cameraName = camera.name;
  return mrpt;
}

RecordedCamera fromMrpt(const mrpt::img::TCamera& mrpt) {
  RecordedCamera camera;
  camera.model = {static_cast<int>(mrpt.ncols),
                  static_cast<int>(mrpt.nrows),
                  mrpt.fx(),
                  mrpt.fy(),
                  mrpt.cx(),
                  mrpt.cy(),
                  mrpt.k1(),
                  mrpt.k2(),
                  mrpt.p1(),
                  mrpt.p2(),
                  mrpt.k3(),
                  {},
                  mrpt.k4(),
                  mrpt.k5(),
                  mrpt.k6()};
  using mrpt::img::DistortionModel;
  camera.is_undistorted = mrpt.distortion == DistortionModel::none;
  if (mrpt.distortion == DistortionModel::kannala_brandt)
    camera.model.lens = LensModel::fisheye;
  else if (mrpt.k4() != 0 || mrpt.k5() != 0 || mrpt.k6() != 0)
    camera.model.lens = LensModel::rational;
  camera.focal_length_m = mrpt.focalLengthMeters;
  camera.name = mrpt.cameraName;
  return camera;
}

mrpt::Clock::time_point toMrpt(Time time) { return mrpt::Clock::time_point(time.time_since_epoch()); }

Time fromMrpt(mrpt::Clock::time_point time) { return Time(time.time_since_epoch()); }

}  // namespace fathom
