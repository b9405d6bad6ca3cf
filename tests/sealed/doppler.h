#pragma once

#include <array>

#include "core/random.h"
#include "dive.h"
#include "ordinary.h"
#include "recording/samples.h"
#include "sealed_case.h"
#include "sound.h"
#include "vehicle.h"

namespace fathom::sealed {

/// A Doppler velocity log, beam by beam: four Janus beams ping a flat floor, each hears its own echo, and the
/// velocity is what fits their shifts best.
class DopplerLog {
 public:
  DopplerLog(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive, double floor_depth_m);

  /// To be called for one ping after the other.
  DvlSample read(double t_s);

 private:
  static constexpr std::size_t kBeams = 4;

  Pose T_robot_dvl(double stamp_s) const;
  double missingShare(std::size_t beam, double stamp_s) const;
  double echoTime_s(const Pose& T_odom_dvl, const Vector3d& beam_dvl) const;
  Vector3d velocity_dvl(double t_s, double stamp_s) const;
  double beamSpeed_m_s(std::size_t beam, double sent_s, double stamp_s) const;
  double nextNoise_m_s(std::size_t beam);
  Vector3d unnamedError_m_s(const Vector3d& velocity_m_s);

  const Vehicle& vehicle_;
  const SealedCase& sealed_;
  const Dive& dive_;
  double floor_depth_m_;
  double electronics_scale_;  ///< what no sea water's sound speed explains
  SoundProfile sound_;
  Random random_, random_outliers_;
  std::array<SmoothField, 3> bias_;             ///< of each axis, by its speed
  Eigen::Matrix<double, kBeams, 3> beams_dvl_;  ///< a row each, unit length
  std::array<double, kBeams> noise_m_s_{};
};

}  // namespace fathom::sealed
