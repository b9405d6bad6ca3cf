#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "recording/tum.h"
#include "ros_bag/transform_checks.h"

namespace fathom {

/// The frames that a bag's transforms (REP 105) join, and the path of one in another.
class TransformTree {
 public:
  struct Path {
    std::vector<StampedPose> poses;
    std::vector<std::string> remarks;  ///< what contradicts itself on the way, one line each
  };

  /// parent and child as the message names them; a slash before a name (tf of before 2013) is none of it.
  /// for_good: of /tf_static.
  void add(const std::string& parent, const std::string& child, const StampedPose& T_parent_child,
           bool for_good);

  /// The poses of `child` in `parent`, whatever frames lie between, at the stamps of the fastest of the
  /// transforms on the way: the others are interpolated, and where one of them does not reach there is no
  /// pose. One that came once only stands still as a static one does. Both names empty: of the only transform
  /// there is that moves. Throws Error about `where` where nothing joins the two, where nothing on the way
  /// moves, and, with what there is, where it is not told which is meant.
  Path path(const std::string& parent, const std::string& child, const std::string& file,
            const std::string& where) const;

 private:
  struct Edge {
    std::vector<StampedPose> poses;  ///< of the child in the parent, as they came
    bool for_good = false;
    PosesApart said_otherwise;  ///< how far static ones are from those before
  };
  using Name = std::pair<std::string, std::string>;  ///< parent, child
  struct Step {
    const Name* name;
    const Edge* edge;
    bool up;                         ///< from child to parent
    std::vector<StampedPose> poses;  ///< the edge's, in time order
    bool stands() const { return edge->for_good || poses.size() == 1; }
    std::optional<Pose> at(Time time) const;
  };
  using Way = std::vector<Step>;

  static std::optional<Pose> poseAlong(const Way& way, Time time);
  static std::string text(const Name& name);
  static void remarkOnStep(const Step& step, std::vector<std::string>& remarks);
  Name nameOfTheOnlyOneThatMoves(const std::string& file, const std::string& where) const;
  void remarkOnOtherWay(const Name& ends, const Way& way, Path& path) const;
  Way way(const Name& ends, const Edge* avoided = nullptr) const;
  std::string text() const;

  std::map<Name, Edge> edges_;
};

}  // namespace fathom
