#include "ros_bag/transform_tree.h"

#include <algorithm>
#include <deque>

#include "core/error.h"
#include "core/text.h"

namespace fathom {
namespace {

std::string withoutSlash(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

std::vector<StampedPose> sorted(std::vector<StampedPose> poses) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  return poses;
}

/// Of equal stamps the first.
void dropRepeated(std::vector<StampedPose>& poses) {
  poses.erase(std::unique(poses.begin(), poses.end(),
                          [](const StampedPose& a, const StampedPose& b) { return a.time == b.time; }),
              poses.end());
}

}  // namespace

void TransformTree::add(const std::string& parent, const std::string& child,
                        const StampedPose& T_parent_child, bool for_good) {
  Edge& edge = edges_[{withoutSlash(parent), withoutSlash(child)}];
  edge.for_good = for_good;
  if (for_good && !edge.poses.empty()) {  // said again
    edge.said_otherwise =
        largest(edge.said_otherwise, apart(edge.poses.back().T_odom_robot, T_parent_child.T_odom_robot));
    edge.poses.clear();
  }
  edge.poses.push_back(T_parent_child);
}

TransformTree::Path TransformTree::path(const std::string& parent, const std::string& child,
                                        const std::string& file, const std::string& where) const {
  Name ends{withoutSlash(parent), withoutSlash(child)};
  if (ends.second.empty()) ends = nameOfTheOnlyOneThatMoves(file, where);
  const auto& [from, to] = ends;
  if (from == to) throw Error(file, where, "`frame` and `child_frame` are the same, " + from);
  Way steps = way(ends);
  if (steps.empty()) throw Error(file, where, "nothing joins " + to + " to " + from + "; it has " + text());

  Path path;
  for (Step& step : steps) {
    remarkOnStep(step, path.remarks);
    dropRepeated(step.poses);
  }
  const auto fastest = std::max_element(steps.begin(), steps.end(), [](const Step& a, const Step& b) {
    return std::pair(!a.edge->for_good, a.poses.size()) < std::pair(!b.edge->for_good, b.poses.size());
  });
  if (fastest->edge->for_good)
    throw Error(file, where, to + " stands still in " + from + ": all of it is static");
  for (const Step& step : steps)
    if (step.stands() && !step.edge->for_good && &step != &*fastest)
      path.remarks.push_back(text(*step.name) + ": it came once only, and is taken as standing still");
  for (const StampedPose& moment : fastest->poses)
    if (const auto T_from_to = poseAlong(steps, moment.time)) path.poses.push_back({moment.time, *T_from_to});
  if (path.poses.empty())
    throw Error(file, where, "its transforms between " + from + " and " + to + " have no time in common");
  const std::size_t lost = fastest->poses.size() - path.poses.size();
  if (lost > fastest->poses.size() / 10)
    path.remarks.push_back(print("%zu of %zu poses of ", lost, fastest->poses.size()) + text(*fastest->name) +
                           " are left out: other transforms on the way do not reach their time");
  remarkOnOtherWay(ends, steps, path);
  return path;
}

std::optional<Pose> TransformTree::Step::at(Time time) const {
  const auto T = stands() ? poses.front().T_odom_robot : poseAt(poses, time);
  return T && up ? std::optional(T->inverse()) : T;
}

std::optional<Pose> TransformTree::poseAlong(const Way& way, Time time) {
  Pose T_from_to;
  for (const Step& step : way) {
    const auto T = step.at(time);
    if (!T) return {};
    T_from_to = T_from_to * *T;
  }
  return T_from_to;
}

/// Before repeated stamps are dropped, among which others may be.
void TransformTree::remarkOnStep(const Step& step, std::vector<std::string>& remarks) {
  constexpr double kSame_m = 0.001, kSame_deg = 0.1;
  if (const auto jumping = jumpingPoses(step.poses))
    remarks.push_back(
        text(*step.name) + print(": %zu of %zu poses jump by ", jumping->count, step.poses.size()) +
        jumping->typical.text() + " (median) from those before and after, which agree, as of two publishers");
  if (step.edge->said_otherwise.exceeds(kSame_m, kSame_deg))
    remarks.push_back(text(*step.name) + ": it is static, yet said again up to " +
                      step.edge->said_otherwise.text() + " off: the last is taken");
}

/// A tree has one way between two frames. What has two should say the same on both.
void TransformTree::remarkOnOtherWay(const Name& ends, const Way& steps, Path& path) const {
  constexpr double kSame_m = 0.1, kSame_deg = 2;  // what is interpolated is off by less
  for (const Step& step : steps) {
    Way other = way(ends, step.edge);
    PosesApart off;
    for (Step& s : other) dropRepeated(s.poses);
    for (const StampedPose& at : path.poses)
      if (const auto T = other.empty() ? std::nullopt : poseAlong(other, at.time))
        off = largest(off, apart(*T, at.T_odom_robot));
    if (!off.exceeds(kSame_m, kSame_deg)) continue;
    std::string over;
    for (const Step& s : other) over += (over.empty() ? "" : ", ") + text(*s.name);
    path.remarks.push_back(text(*step.name) + ": another way (" + over + ") says up to " + off.text() +
                           " otherwise; the shorter is taken");
    return;
  }
}

TransformTree::Name TransformTree::nameOfTheOnlyOneThatMoves(const std::string& file,
                                                             const std::string& where) const {
  const auto moves = [](const auto& edge) { return !edge.second.for_good; };
  if (std::count_if(edges_.begin(), edges_.end(), moves) != 1)
    throw Error(file, where,
                "which of its transforms is meant, `frame` and `child_frame` must tell: " + text());
  return std::find_if(edges_.begin(), edges_.end(), moves)->first;
}

/// The shortest way, breadth first; empty where there is none.
TransformTree::Way TransformTree::way(const Name& ends, const Edge* avoided) const {
  struct Hop {
    const Name* name;
    const Edge* edge;
    bool up;
  };
  std::map<std::string, std::vector<Hop>> ways{{ends.first, {}}};
  std::deque<std::string> waiting{ends.first};
  while (!waiting.empty()) {
    const std::string here = waiting.front();
    waiting.pop_front();
    for (const auto& [name, edge] : edges_) {
      const bool up = name.second == here;
      if (&edge == avoided || (!up && name.first != here)) continue;
      const std::string& there = up ? name.first : name.second;
      if (ways.contains(there)) continue;
      ways[there] = ways.at(here);
      ways[there].push_back({&name, &edge, up});
      waiting.push_back(there);
    }
  }
  Way steps;
  for (const Hop& hop : ways[ends.second])
    steps.push_back({hop.name, hop.edge, hop.up, sorted(hop.edge->poses)});
  return steps;
}

std::string TransformTree::text(const Name& name) { return name.first + " to " + name.second; }

std::string TransformTree::text() const {
  std::string all;
  for (const auto& [name, edge] : edges_)
    all += (all.empty() ? "" : ", ") + text(name) + (edge.for_good ? " (static)" : "");
  return all.empty() ? "no transform" : all;
}

}  // namespace fathom
