#include "simulation/read_trajectory.h"

#include <map>
#include <stdexcept>

#include "core/files.h"
#include "recording/rawlog.h"
#include "recording/recorded_path.h"
#include "simulation/trajectory_kinds.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

using ReadPlan = MotionPlan (*)(const YamlMap&);
const std::map<std::string, ReadPlan>& plannedKinds() {
  static const std::map<std::string, ReadPlan> kinds{
      {"waypoints", readWaypoints}, {"station", readStation}, {"survey", readSurvey}};
  return kinds;
}

Trajectory asRecorded(const fs::path& file) {
  return Trajectory::fromTum(readRecordedPoses(file), file.string());
}

Trajectory asPlanned(const YamlFile& yaml, ReadPlan read, const fs::path& file) {
  try {
    const MotionPlan plan = read(yaml.root());
    yaml.rejectUnknownKeys();
    return plan.trajectory(file.string());
  } catch (const std::length_error& too_long) {
    throw Error(file.string(), "", too_long.what());
  }
}

}  // namespace

std::vector<StampedPose> readRecordedPoses(const fs::path& file) {
  RecordedPath path = recordedPath(file, labels::kTruth);
  if (path.left_out > 0)
    throw Error(
        file.string(), std::string(labels::kTruth),
        std::to_string(path.left_out) + " of " + std::to_string(path.left_out + path.poses.size()) +
            " poses are not finite, without a time, or not later than one before; `fathom export tum` "
            "leaves them out");
  return std::move(path.poses);
}

Trajectory readTrajectory(const fs::path& file) {
  if (file.extension() != ".yaml") return asRecorded(file);
  const YamlFile yaml(file);
  const YamlMap& y = yaml.root();
  const std::string kind = y.has("kind") ? y.text("kind") : "waypoints";
  if (const auto planned = plannedKinds().find(kind); planned != plannedKinds().end())
    return asPlanned(yaml, planned->second, file);
  if (kind != "recorded") throw y.error("kind", "must be waypoints, station, survey or recorded");
  const fs::path recorded = file.parent_path() / y.text("file");
  yaml.rejectUnknownKeys();
  if (!isThere(recorded)) throw y.error("file", "names " + recorded.string() + ", which is not there");
  return asRecorded(recorded);
}

}  // namespace fathom
