#include "ros_bag/transform_tree.h"

#include <algorithm>
#include <deque>
#include <optional>
#include <tuple>

#include "core/error.h"

namespace fathom {
namespace {

std::string withoutSlash(const std::string& frame) {
  return frame.starts_with('/') ? frame.substr(1) : frame;
}

/// In time order; of equal stamps the first.
std::vector<StampedPose> sorted(std::vector<StampedPose> poses) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.time < b.time; });
  poses.erase(std::unique(poses.begin(), poses.end(),
                          [](const StampedPose& a, const StampedPose& b) { return a.time == b.time; }),
              poses.end());
  return poses;
}

}  // namespace

void TransformTree::add(const std::string& parent, const std::string& child,
                        const StampedPose& T_parent_child, bool for_good) {
  Edge& edge = edges_[{withoutSlash(parent), withoutSlash(child)}];
  edge.for_good = for_good;
  if (for_good) edge.poses.clear();  // said again
  edge.poses.push_back(T_parent_child);
}

std::vector<StampedPose> TransformTree::path(const std::string& parent, const std::string& child,
                                             const std::string& file, const std::string& where) const {
  std::string from = withoutSlash(parent), to = withoutSlash(child);
  if (to.empty()) {
    const auto moves = [](const auto& edge) { return !edge.second.for_good; };
    if (std::count_if(edges_.begin(), edges_.end(), moves) != 1)
      throw Error(file, where,
                  "which of its transforms is meant, `frame` and `child_frame` must tell: " + text());
    std::tie(from, to) = std::find_if(edges_.begin(), edges_.end(), moves)->first;
  }
  const std::vector<Step> steps = way(from, to);
  if (steps.empty()) throw Error(file, where, "nothing joins " + to + " to " + from + "; it has " + text());

  std::vector<std::vector<StampedPose>> poses;  // of each step
  const std::vector<StampedPose>* fastest = nullptr;
  for (const Step& step : steps) poses.push_back(sorted(step.edge->poses));
  for (std::size_t k = 0; k < steps.size(); ++k)
    if (!steps[k].edge->for_good && (fastest == nullptr || poses[k].size() > fastest->size()))
      fastest = &poses[k];
  if (fastest == nullptr) throw Error(file, where, to + " stands still in " + from + ": all of it is static");

  std::vector<StampedPose> path;
  for (const StampedPose& at : *fastest) {
    std::optional<Pose> T_from_to = Pose{};
    for (std::size_t k = 0; k < steps.size() && T_from_to; ++k) {
      const auto T = steps[k].edge->for_good ? poses[k].front().T_odom_robot : poseAt(poses[k], at.time);
      T_from_to = T ? std::optional(*T_from_to * (steps[k].up ? T->inverse() : *T)) : std::nullopt;
    }
    if (T_from_to) path.push_back({at.time, *T_from_to});
  }
  if (path.empty())
    throw Error(file, where, "its transforms between " + from + " and " + to + " have no time in common");
  return path;
}

/// The shortest way, breadth first; empty where there is none.
std::vector<TransformTree::Step> TransformTree::way(const std::string& from, const std::string& to) const {
  std::map<std::string, std::vector<Step>> ways{{from, {}}};
  std::deque<std::string> waiting{from};
  while (!waiting.empty()) {
    const std::string here = waiting.front();
    waiting.pop_front();
    for (const auto& [name, edge] : edges_) {
      const bool up = name.second == here;
      if (!up && name.first != here) continue;
      const std::string& there = up ? name.first : name.second;
      if (ways.contains(there)) continue;
      ways[there] = ways.at(here);
      ways[there].push_back({&edge, up});
      waiting.push_back(there);
    }
  }
  const auto found = ways.find(to);
  return found == ways.end() ? std::vector<Step>{} : found->second;
}

std::string TransformTree::text() const {
  std::string all;
  for (const auto& [name, edge] : edges_)
    all += (all.empty() ? "" : ", ") + name.first + " to " + name.second + (edge.for_good ? " (static)" : "");
  return all;
}

}  // namespace fathom
