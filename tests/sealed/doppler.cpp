#include "doppler.h"

#include <Eigen/LU>
#include <array>
#include <cmath>

#include "streams.h"

namespace fathom::sealed {
namespace {

constexpr double kUsualDepth_m = 4.4;             // where the assumed sound speed holds
constexpr double kRichGradient_celsius_m = -0.1;  // of a rich recording: 0.3 m/s a metre
constexpr double kRichNoiseKept = 0.5;            // from ping to ping: AR(1)
constexpr double kNearestOutlier_m_s = 0.1, kFarthestOutlier_m_s = 0.5;

/// A scale error that is always there is the water's sound speed: v_read = v c_assumed / c. One that comes
/// and goes can only be the electronics'.
double waterSpeed_m_s(const Vehicle& vehicle, const SealedCase& sealed) {
  double error = 0.0;
  for (const HiddenEffect& effect : sealed.effects)
    if (effect.id == "dvl-scale" && effect.active_s.empty())
      error = effect.parameters.find("scale_error")->second.front();
  return vehicle.dvl.assumed_sound_speed_m_s / (1 + error);
}

double passingScale(const SealedCase& sealed, double stamp_s) {
  const HiddenEffect* scale = sealed.find("dvl-scale", stamp_s);
  return scale && !scale->active_s.empty() ? 1 + scale->parameters.find("scale_error")->second.front() : 1.0;
}

}  // namespace

DopplerLog::DopplerLog(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive,
                       double floor_depth_m)
    : vehicle_(vehicle),
      sealed_(sealed),
      dive_(dive),
      floor_depth_m_(floor_depth_m),
      electronics_scale_(1.0),
      sound_(SoundProfile::through(waterSpeed_m_s(vehicle, sealed), kUsualDepth_m,
                                   sealed.rich ? kRichGradient_celsius_m : 0.0)),
      random_(stream(sealed.seed, Stream::dvl)),
      random_outliers_(stream(sealed.seed, Stream::dvl_outliers)) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    bias_[axis] = ordinaryField(sealed, kOrdinary.dvl_m_s, kOrdinary.dvl_length_m_s, Stream::dvl_bias, axis);
  electronics_scale_ = sound_.speedAt(kUsualDepth_m) / waterSpeed_m_s(vehicle, sealed);
  const double angle_rad = radians(vehicle.dvl.beam_angle_deg);
  for (std::size_t i = 0; i < kBeams; ++i) {
    const double azimuth_rad = radians(vehicle.dvl.beam_azimuths_deg[i]);
    beams_dvl_.row(static_cast<Eigen::Index>(i)) << std::sin(angle_rad) * std::cos(azimuth_rad),
        std::sin(angle_rad) * std::sin(azimuth_rad), -std::cos(angle_rad);
    noise_m_s_[i] = vehicle.dvl.beam_sigma_m_s * random_.normal();
  }
}

Pose DopplerLog::T_robot_dvl(double stamp_s) const {
  Pose pose = vehicle_.dvl.pose.pose();
  pose.rotation *= sealed_.rotation("dvl-misalignment", "rotation_deg", stamp_s);
  pose.position += sealed_.vector("dvl-lever-arm", "offset_m", stamp_s);
  return pose;
}

/// From ping to echo, down to the floor and back.
double DopplerLog::echoTime_s(const Pose& T_odom_dvl, const Vector3d& beam_dvl) const {
  const double angle_rad = std::acos(-(T_odom_dvl.rotation * beam_dvl).z());
  return 2 * sound_.travelTime_s(-T_odom_dvl.position.z(), floor_depth_m_, angle_rad);
}

/// Of the log against what its echoes come from, in its own axes.
Vector3d DopplerLog::velocity_dvl(double t_s, double stamp_s) const {
  const Motion motion = dive_.at(t_s);
  const Pose mounting = T_robot_dvl(stamp_s);
  const Vector3d current_odom = sealed_.vector("water-current", "current_m_s", stamp_s);
  const Vector3d velocity_robot =
      motion.velocityOf(mounting.position) - motion.T_odom_robot.rotation.transpose() * current_odom;
  return mounting.rotation.transpose() * velocity_robot;
}

/// The exact Doppler shift of sender, resting floor and receiver (e.g. Pierce 1989, sec. 1.9), turned back
/// into a speed with the sound speed that the log assumes. Its ping left at `sent_s`.
double DopplerLog::beamSpeed_m_s(std::size_t beam, double sent_s, double stamp_s) const {
  const Vector3d beam_dvl = beams_dvl_.row(static_cast<Eigen::Index>(beam));
  const Pose T_odom_dvl = dive_.poseAt(sent_s) * T_robot_dvl(stamp_s);
  const double heard_s = sent_s + echoTime_s(T_odom_dvl, beam_dvl);
  const double sound_m_s = sound_.speedAt(-T_odom_dvl.position.z());
  const double sending_m_s = velocity_dvl(sent_s, stamp_s).dot(beam_dvl);
  const double hearing_m_s = velocity_dvl(heard_s, stamp_s).dot(beam_dvl);
  const double pitch = (sound_m_s + hearing_m_s) / (sound_m_s - sending_m_s);
  return passingScale(sealed_, stamp_s) * electronics_scale_ * vehicle_.dvl.assumed_sound_speed_m_s *
         (pitch - 1) / (pitch + 1);
}

/// White; in a rich recording each ping keeps half of the last one's noise, at the same sigma.
double DopplerLog::nextNoise_m_s(std::size_t beam) {
  if (!sealed_.noise) return 0.0;
  const double kept = sealed_.rich ? kRichNoiseKept : 0.0;
  noise_m_s_[beam] =
      kept * noise_m_s_[beam] + std::sqrt(1 - kept * kept) * vehicle_.dvl.beam_sigma_m_s * random_.normal();
  return noise_m_s_[beam];
}

/// Of its speed, that a beam does not tell.
double DopplerLog::missingShare(std::size_t beam, double stamp_s) const {
  constexpr std::array<const char*, kBeams> kMissing{"missing_1", "missing_2", "missing_3", "missing_4"};
  return sealed_.number("beam-missing", kMissing[beam], stamp_s);
}

/// What is ordinary, and outliers.
Vector3d DopplerLog::unnamedError_m_s(const Vector3d& velocity_m_s) {
  const double fraction = sealed_.outsideSize("dvl-outliers") + sealed_.ordinary * kOrdinary.outliers;
  Vector3d error_m_s = outlier<3>(fraction, kNearestOutlier_m_s, kFarthestOutlier_m_s, random_outliers_);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Eigen::Index>(axis);
    error_m_s[i] += bias_[axis].at(velocity_m_s[i]);
  }
  return error_m_s;
}

DvlSample DopplerLog::read(double t_s) {
  const double valid_s =
      sealed_.trueTime_s(labels::kDvl, t_s) - sealed_.number("dvl-latency", "latency_s", t_s);
  const Pose T_odom_dvl = dive_.poseAt(valid_s) * T_robot_dvl(t_s);
  const double sent_s = valid_s - echoTime_s(T_odom_dvl, -Vector3d::UnitZ()) / 2;
  Eigen::Vector4d speeds_m_s;
  for (std::size_t i = 0; i < kBeams; ++i)
    speeds_m_s[static_cast<Eigen::Index>(i)] =
        beamSpeed_m_s(i, sent_s, t_s) * (1 - missingShare(i, t_s)) + nextNoise_m_s(i);
  speeds_m_s.head<3>() += sealed_.vector("beam-bias", "bias_m_s", t_s);

  const Matrix3d normal_equations = beams_dvl_.transpose() * beams_dvl_;
  const Vector3d velocity_read = normal_equations.inverse() * (beams_dvl_.transpose() * speeds_m_s);
  const double quadratic = 1 + sealed_.outsideSize("dvl-quadratic") * velocity_read.norm();
  return {vehicle_.dvl.pose.pose(), Vector3d(quadratic * velocity_read + unnamedError_m_s(velocity_read))};
}

}  // namespace fathom::sealed
