#include "recording/recorded_path.h"

#include <map>

#include "core/error.h"
#include "recording/rawlog.h"

namespace fathom {
namespace {

void addPose(const StampedPose& pose, RecordedPath& path) {
  if (fitsTum(pose, path.poses.empty() ? nullptr : &path.poses.back()))
    path.poses.push_back(pose);
  else
    ++path.left_out;
}

}  // namespace

RecordedPath recordedPath(const std::filesystem::path& file, const std::string& label) {
  if (file.extension() != ".rawlog") return {readTum(file), 0};
  RawlogReader reader(file);
  std::map<std::string, RecordedPath> paths;
  while (const auto sample = reader.next())
    if (const auto* pose = std::get_if<PoseSample>(&sample->reading); pose != nullptr)
      addPose({sample->time, pose->T_odom_robot.mean}, paths[sample->label]);
  std::string labels;
  for (const auto& [name, path] : paths) labels += (labels.empty() ? "" : ", ") + name;
  if (paths.empty()) throw Error(file.string(), label, "has no poses");
  if (label.empty() && paths.size() > 1)
    throw Error(file.string(), "", "has poses of several labels: " + labels);
  const auto found = label.empty() ? paths.begin() : paths.find(label);
  if (found == paths.end())
    throw Error(file.string(), label, "no such label with poses; there are " + labels);
  if (found->second.poses.empty())
    throw Error(file.string(), found->first, "has no pose that is finite and has a time from 1970 to 2477");
  return found->second;
}

}  // namespace fathom
