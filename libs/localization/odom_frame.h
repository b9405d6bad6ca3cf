#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/uncertain_pose.h"
#include "localization/frame_move.h"
#include "sensors/channels.h"

namespace fathom {

/// Which of a pose's coordinates in odom. (Roll and pitch are against gravity, in any frame.)
struct FrameCoordinates {
  bool position = false;  ///< x and y
  bool height = false, heading = false;
  bool any() const { return position || height || heading; }
};

/// The move of the frame after which a pose has the free coordinates of another. They are as good as unknown,
/// for a fix to tell them: the heading no more so than a linear update bears.
FrameMove moveTo(const Pose& there, const Pose& T_odom_robot, const FrameCoordinates& free);

/// What one reading says of where the robot is: a panel of known pose, USBL, GNSS, pressure.
struct PoseFix {
  double t_s = 0.0;
  std::string by;  ///< "panel P0"
  Channel channel = kChannel<Landmark>;
  FrameCoordinates tells;  ///< of the others the pose is the filter's own
  UncertainPose T_odom_robot;
};

/// Where odom is. What no reading of the first seconds told is zero, and defines odom. That holds until a fix
/// says where odom is: it contradicts nothing, it moves the frame, and with it all that was estimated in it.
///
/// A panel's pose tells all coordinates at once. A position alone does not tell the heading: each shifts the
/// frame, until the path that the robot has come shows by how much it has to be turned (the rotation that
/// turns one set of points into another best: Horn 1987, in the plane).
class OdomFrame {
 public:
  OdomFrame() = default;  ///< told by a start pose: never moved
  explicit OdomFrame(const FrameCoordinates& defined) : defined_(defined) {}

  const FrameCoordinates& defined() const { return defined_; }
  /// Positions have been seen, in a frame whose heading nobody knows.
  bool isTurned() const { return track_ != nullptr; }

  struct Meeting {
    std::optional<FrameMove> move;
    bool is_used_up = false;  ///< the fix is in it, and is not to be fused as well
  };
  /// What a fix makes of it. `T_odom_robot`: the filter's pose then.
  Meeting meet(const Pose& T_odom_robot, const PoseFix& fix);

 private:
  /// The robot's position by its own dead reckoning, whatever shifts there were, and by a fix.
  struct Place {
    Eigen::Vector2d reckoned, fixed;
    double sigma_m;
  };
  using Track = std::vector<Place>;
  Meeting shift(const Pose& T_odom_robot, const PoseFix& fix);

  FrameCoordinates defined_;
  Eigen::Vector2d shifted_ = Eigen::Vector2d::Zero();  ///< since the track began
  std::shared_ptr<const Track> track_;                 ///< while positions are known, but not the heading
};

/// A fix and where the filter would be by then by dead reckoning alone.
struct ReckonedFix {
  PoseFix fix;
  Pose T_odom_robot;
};

/// How the frame of the first seconds has to be moved, for most of their fixes to agree with the path there.
struct FrameConsensus {
  FrameMove move;
  const PoseFix* by = nullptr;  ///< the first of those that agree, among what was given
  std::size_t agreeing = 0, of = 0;
  /// Of several each says something else; the move's sigma is what they differ by.
  bool isInDoubt() const { return agreeing == 1 && of > 1; }
};
/// Nothing where no fix tells a coordinate that is defined only. Fixes agree within their covariances and
/// what dead reckoning may be off by.
std::optional<FrameConsensus> consensus(const OdomFrame& frame, const std::vector<ReckonedFix>& fixes);

}  // namespace fathom
