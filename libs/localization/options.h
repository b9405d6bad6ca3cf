#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "localization/error_state_filter.h"
#include "localization/regime.h"
#include "sensors/channels.h"
#include "sensors/vehicle.h"

namespace fathom {

/// When an innovation is too large to be believed.
struct Gate {
  enum class Kind {
    none,
    chi_square,  ///< NIS beyond the chi-square quantile of its degrees of freedom
    fixed,       ///< the paper's: a landmark pose farther than a distance or an angle from the prediction
  };
  Kind kind = Kind::chi_square;
  double probability = 0.9999;  ///< chi_square: a good reading is rejected once in 1/(1 - p)
  double max_position_m = 1.0;  ///< fixed (paper.md, T_L5)
  double max_angle_rad = radians(12);
};

/// How landmarks are fused.
struct LandmarkOptions {
  /// A robot pose averaged over single markers (the paper), or each panel's pose from all its markers at
  /// once.
  enum class Form { mean, joint } form = Form::joint;
  /// Of each axis of a mean: the paper's covariance is 1e-3 m², 1e-3 rad². A joint pose brings its own.
  double position_sigma_m = 0.0316, angle_sigma_rad = 0.0316;
};

/// The INS's biases, where they are known better than by the vehicle file.
struct BiasNoise {
  double gyro_sigma_rad_s = 0.0, accelerometer_sigma_m_s2 = 0.0, time_constant_s = 120.0;
};

/// When an estimate is said to be lost.
struct LostOptions {
  double position_sigma_m = 5.0;  ///< the filter's own sigma (root of the covariance's trace) is larger
  double angle_sigma_rad = radians(45.0);
  double contradiction_s = 10.0;  ///< readings of a channel have been rejected, or far too large, for so long
  double blind_s = 30.0;          ///< nothing has told the velocity or the position for so long
};

struct LocalizationOptions {
  std::string task = "TL2";  ///< names the results: EKF_TL2
  /// Which channels are fused; one that the recording lacks does no harm.
  std::vector<Channel> fuse{kChannel<Gyro>, kChannel<Accelerometer>, kChannel<Attitude>, kChannel<Dvl>,
                            kChannel<DvlBeams>};
  bool bias_states = true;  ///< 23 states instead of the paper's 15 (sigma and time constant: vehicle file)
  ProcessNoise noise;
  std::map<Regime, DrivingNoise> driven;  ///< where the vehicle travels or turns; absent: as `noise` has it
  RegimeLimits regimes;
  std::map<Channel, double> sigma_times;  ///< of a channel's measurements: times the vehicle file's
  std::optional<BiasNoise> biases;        ///< absent: the vehicle file's
  bool adapts_noise = true;  ///< follows what innovations show of all these noises, within bounds
  Gate gate;
  LandmarkOptions landmarks;
  LostOptions lost;
  double history_s = 2.0;        ///< a reading up to this late is fused at its own time
  double gap_s = 1.0;            ///< a longer pause of all sensors is named in the result
  double alignment_s = 2.0;      ///< initial alignment from the first seconds, where no start pose is given
  double first_fix_s = 5.0;      ///< and for so long it waits for three fixes, where any may come
  double output_rate_hz = 10.0;  ///< of trajectory and results; also, the instant of each landmark
  bool smooth = false;           ///< also run the RTS smoother; keeps every step in memory
};

/// Overwrites `base` by what a YAML file (config/defaults.yaml has every key) says. Its key `base` names
/// another such file, relative to it, that is applied first: config/TL5.yaml says only in what it differs
/// from TL4.yaml. Strict. Throws Error, also where files name each other in a circle.
LocalizationOptions readLocalizationOptions(const std::filesystem::path& file,
                                            const LocalizationOptions& base = {});

/// All options as YAML that reads back to the same.
std::string formatLocalizationOptions(const LocalizationOptions& options);

/// Where the vehicle starts, given from outside.
struct StartPose {
  Pose T_odom_robot;
  double position_sigma_m = 0.1;
  double angle_sigma_rad = radians(0.5);
  std::string source = "given";
};

}  // namespace fathom
