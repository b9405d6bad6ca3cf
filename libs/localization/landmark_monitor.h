#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "core/uncertain_pose.h"

namespace fathom {

/// A sighting of a panel, as the filter that rejected or fused it saw it.
struct JudgedFix {
  double t_s = 0.0;
  Pose T_odom_robot;                                ///< the filter's
  Vector6d pose_variance;                           ///< its own, of each coordinate
  UncertainPose T_robot_panel;                      ///< the sighting
  Pose T_odom_panel;                                ///< where the filter believes the panel to be
  Vector6d whitened_innovation = Vector6d::Zero();  ///< of unit covariance where all is as it should be
  bool panel_is_movable = false;                    ///< false: a fix that is not of one panel alone
  bool panel_is_estimated = false;
};

/// What a fix means that the filter's chi-square gate has rejected.
///
/// One rejected fix is an outlier; so are any number of them that disagree with each other. Fixes agree where
/// the panel that they show stands still in the filter's own dead reckoning: a filter that is off by a turn
/// and a shift sees a panel stand still (elsewhere), and so does a filter that is right, where the panel was
/// moved. kAgreeing fixes of a panel in a row that agree with each other are believed, against the filter or
/// against the panel's pose. Which of the two is decided so:
///
/// The panel has moved, if dead reckoning vouches for the robot's pose, that is if
/// 1. kConfirming fixes have been fused since the last reset: the filter was right then;
/// 2. the last of them, of any panel, was at most kVouching_s before the first rejected one;
/// 3. the push was sudden: innovations of the last fixes fused (kRecent at most), averaged with their signs
///    and in units of their sigma, were kSudden times smaller than those of the fixes rejected. A faulty gyro
///    or DVL pulls to one side before fixes are rejected;
/// 4. the panel stood still where it was seen then, by the slope of a line through the fixes. A faulty gyro
/// or
///    DVL makes it drift;
/// 5. no other panel that was seen meanwhile was rejected too: two panels are not pushed at once;
/// 6. the jump is larger than what the filter's sigma has grown by since the last fix fused (3 sigma) plus
///    what an odometry error that nobody knows of makes of the gap (kDoubt_m_s, kDoubt_rad_s).
///
/// Otherwise the filter is wrong (wrong start, a long time without landmarks, a faulty gyro or DVL): the
/// robot's pose is acquired anew. Each landmark is a measurement of its own, from an image of its own; that
/// several agree by chance is far less probable than one biased odometry, so landmarks that agree are
/// believed before gyro and DVL. For that, agreement is judged with the odometry's doubt added.
///
/// Where the odometry is so wrong that not even a panel's fixes agree by it, and none has been fused for
/// kPatience_s, fixes that are plausible by themselves (the robot that they show moves slower than
/// kPlausible_m_s, kPlausible_rad_s) lead: each sets the pose, until the filter agrees with them again. It is
/// lost meanwhile.
///
/// Where odom is what one fix says, because nothing else told it (OdomFrame), that fix may have been the
/// false one: until kAgreeing fixes have confirmed it, it takes as many that agree as outnumber those.
///
/// An estimated panel that fewer than kConfirming fixes have confirmed was attached by a false sighting: it
/// starts anew.
class LandmarkMonitor {
 public:
  static constexpr int kAgreeing = 5;
  static constexpr int kConfirming = 3;
  static constexpr std::size_t kRecent = 10;
  static constexpr double kSudden = 4.0;
  static constexpr double kVouching_s = 10.0;
  static constexpr double kDoubt_m_s = 0.05, kDoubt_rad_s = 0.01;

  static constexpr double kPatience_s = 10.0;
  static constexpr double kPlausible_m_s = 1.0, kPlausible_rad_s = 0.5;

  enum class Verdict { outlier, reacquire, panel_moved, panel_restart, lead };
  struct Judgement {
    Verdict verdict = Verdict::outlier;
    int agreeing = 1;                    ///< fixes in a row that agree, this one included
    double since_s = 0.0;                ///< time of the first of them
    std::optional<double> last_fused_s;  ///< of any panel, before them
    bool leads_already = false;          ///< it is not the first that leads
  };

  void fused(int panel, const JudgedFix& fix);
  Judgement rejected(int panel, const JudgedFix& fix);
  /// Before the first fix is fused, which says where odom is.
  /// `in_doubt`: and of the others that were seen by then none agrees with it.
  void startByFix(bool in_doubt) {
    by_fix_ = true;
    in_doubt_ = in_doubt;
  }
  /// Whether it still hangs on that fix alone, or on a few.
  bool isByFix() const { return by_fix_ && confirmations_ < kAgreeing; }
  /// And another contradicts it: one of them is false.
  bool isInDoubt() const {
    return isByFix() && (rejected_since_s_ || (in_doubt_ && confirmations_ < kConfirming));
  }
  /// After a reset, by which everything known of the robot's pose starts anew.
  void startAnew();

 private:
  struct Panel {
    int index = 0;
    std::vector<JudgedFix> streak;  ///< rejected ones that agree; kAgreeing at most
    int confirmations = 0;
    std::optional<double> last_fused_s;
  };
  Panel& panel(int index);
  int enough() const;
  Verdict verdict(const Panel& seen, const JudgedFix& fix) const;
  bool vouched(const Panel& seen) const;
  bool plausible(const JudgedFix& fix);

  std::vector<Panel> panels_;
  int confirmations_ = 0;
  bool by_fix_ = false, in_doubt_ = false;
  std::vector<Vector6d> recent_innovations_;  ///< of fused fixes
  std::optional<double> last_fused_s_;
  /// The robot's poses by the last fixes rejected, kAgreeing at most, since when, and whether they lead.
  std::vector<std::pair<double, Pose>> shown_;
  std::optional<double> rejected_since_s_;
  bool leading_ = false;
  Vector6d variance_then_ = Vector6d::Zero();
};

}  // namespace fathom
