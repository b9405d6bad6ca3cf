#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.h"
#include "core/uncertain_pose.h"
#include "localization/odom_frame.h"
#include "localization/options.h"
#include "recording/samples.h"

/// What the filter has to say.
namespace fathom {

/// The filter's answer at one time.
struct Estimate {
  Time time;
  double t_s = 0.0;  ///< since the recording's first entry
  NavigationState<double> state;
  Eigen::Matrix<double, 6, 6> pose_covariance;  ///< position (odom, m), rotation vector (robot axes, rad)
  Vector3d velocity_sigma_robot_m_s = Vector3d::Zero();
  bool lost = false;         ///< not to be relied on: event `lost` says why
  FrameCoordinates defined;  ///< that nothing has told yet: zero at the start, and they define odom
};

/// MRPT's Gaussian pose with its covariance in MRPT's order and angles.
YawPitchRollPose posePdf(const Estimate& estimate);

/// One innovation: kept for the report whether it was fused or not.
struct Innovation {
  double t_s = 0.0;
  Channel channel = kChannel<Gyro>;
  int degrees_of_freedom = 0;
  double nis = 0.0;  ///< normalized innovation squared; chi-square distributed where the filter is consistent
  bool fused = false;
  int rejected_in_a_row = 0;  ///< of its channel, this one included
  double determinant = 0.0;   ///< of its covariance
  bool contradicts = false;   ///< the filter: see NoiseAdaptation::contradicts()
};

/// Something about the input that must not pass in silence.
struct Event {
  double t_s = 0.0;
  /// start, frame-moved, from-the-future, gap, silent, time-jump, duplicate, not-a-number, impossible,
  /// too-late, rejected; of landmarks: fix-rejected, reacquired, panel-moved, panel-prior, panel-restarted,
  /// unknown-panel; lost, found, bias
  std::string kind;
  std::string text;
};

struct ChannelSummary {
  int degrees_of_freedom = 0;
  std::size_t fused = 0, gated = 0;                    ///< gated: not fused
  double nis_mean = 0.0;                               ///< over fused and gated
  double nis_band95_low = 0.0, nis_band95_high = 0.0;  ///< where the mean lies if the filter is consistent
  double sigma_times = 1.0;  ///< its noise at the end, times what options and vehicle file have
};

/// A panel that was pushed while the robot worked.
struct PanelMove {
  double t_s = 0.0;              ///< of the first fix that shows it
  UncertainPose T_before_after;  ///< offset and rotation in axes of the panel as it was
};

struct PanelResult {
  enum class State {
    known,      ///< exact from the start, and not moved
    unseen,     ///< to be estimated, and never seen
    estimated,  ///< a state of the filter
  };
  std::string name;
  State state = State::unseen;
  UncertainPose T_odom_panel;  ///< at the end; of a panel unseen: the prior's pose
  std::vector<PanelMove> moves;
};

struct LocalizationSummary {
  bool started = false;  ///< false: no estimate was made; `failure` says why
  std::string failure = "not run";
  std::string start_source;  ///< where the first pose came from
  double start_t_s = 0.0, end_t_s = 0.0;
  std::size_t samples = 0, late_fused = 0;
  std::map<Channel, ChannelSummary> channels;
  /// Of what drives turning rate and acceleration, at the end: root of the density, times the options'.
  double turning_times = 1.0, pushing_times = 1.0;
  std::map<std::string, std::size_t> event_counts;
  std::vector<PanelResult> panels;     ///< as in the setup
  std::optional<double> lost_since_s;  ///< where it ends lost
  std::string lost_reason;
};

/// Receives results in time order, as soon as they are final (history_s behind the newest reading).
struct LocalizationSink {
  std::function<void(const Estimate&)> estimate = [](const Estimate&) {};
  std::function<void(const Estimate&)> smoothed = [](const Estimate&) {};
  std::function<void(const Innovation&)> innovation = [](const Innovation&) {};
  std::function<void(const Event&)> event = [](const Event&) {};
};

}  // namespace fathom
