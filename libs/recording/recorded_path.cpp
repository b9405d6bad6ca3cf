#include "recording/recorded_path.h"

#include <map>

#include "core/error.h"
#include "recording/rawlog.h"

namespace fathom {

std::vector<StampedPose> recordedPath(const std::filesystem::path& file, const std::string& label) {
  if (file.extension() != ".rawlog") return readTum(file);
  RawlogReader reader(file);
  std::map<std::string, std::vector<StampedPose>> paths;
  while (const auto sample = reader.next())
    if (const auto* pose = std::get_if<PoseSample>(&sample->reading); pose != nullptr)
      paths[sample->label].push_back({sample->time, pose->T_odom_robot.mean});
  std::string labels;
  for (const auto& [name, path] : paths) labels += (labels.empty() ? "" : ", ") + name;
  if (paths.empty()) throw Error(file.string(), label, "has no poses");
  if (label.empty() && paths.size() > 1)
    throw Error(file.string(), "", "has poses of several labels: " + labels);
  const auto found = label.empty() ? paths.begin() : paths.find(label);
  if (found == paths.end())
    throw Error(file.string(), label, "no such label with poses; there are " + labels);
  return found->second;
}

}  // namespace fathom
