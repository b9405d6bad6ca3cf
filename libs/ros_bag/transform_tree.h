#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "recording/tum.h"

namespace fathom {

/// The frames that a bag's transforms (REP 105) join, and the path of one in another.
class TransformTree {
 public:
  /// parent and child as the message names them; a slash before a name (tf of before 2013) is none of it.
  /// for_good: of /tf_static.
  void add(const std::string& parent, const std::string& child, const StampedPose& T_parent_child,
           bool for_good);

  /// The poses of `child` in `parent`, whatever frames lie between, at the stamps of the fastest of the
  /// transforms on the way: the others are interpolated, and where one of them does not reach there is no
  /// pose. Both names empty: of the only transform there is that moves. Throws Error about `where` where
  /// nothing joins the two, where nothing on the way moves, and, with what there is, where it is not told
  /// which is meant.
  std::vector<StampedPose> path(const std::string& parent, const std::string& child, const std::string& file,
                                const std::string& where) const;

 private:
  struct Edge {
    std::vector<StampedPose> poses;  ///< of the child in the parent, as they came
    bool for_good = false;
  };
  struct Step {
    const Edge* edge;
    bool up;  ///< from child to parent
  };
  using Name = std::pair<std::string, std::string>;  ///< parent, child

  std::vector<Step> way(const std::string& from, const std::string& to) const;
  std::string text() const;

  std::map<Name, Edge> edges_;
};

}  // namespace fathom
