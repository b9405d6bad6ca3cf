#include "camera_tables/import_tie_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "camera_tables/camera_alone.h"
#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "landmarks/tie_points.h"
#include "recording/csv.h"
#include "recording/rawlog.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr double kFrame_s = 1;  // the tables have no times
const std::vector<std::string> kDetectionColumns{"camera", "frame", "id", "u_px", "v_px"};

/// By frame, id and eye. Where an eye has an id more than once, which one it is nobody knows.
using Seen = std::map<int, std::map<int, std::array<std::vector<Vector2d>, 2>>>;

Seen readDetections(const fs::path& file) {
  const TextTable table = readTable(file, kDetectionColumns);
  Seen seen;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    const int camera = table.wholeNumber(row, 0);
    if (camera != 1 && camera != 2) throw table.error(row, "camera must be 1, the left one, or 2");
    const std::size_t eye = camera == 1 ? 0 : 1;
    seen[table.wholeNumber(row, 1)][table.wholeNumber(row, 2)][eye].emplace_back(table.number(row, 3),
                                                                                 table.number(row, 4));
  }
  return seen;
}

/// All that a camera sees, its window's corners too.
std::vector<Vector2d> allSeenBy(std::size_t eye, const Seen& seen, const WatchedWindow& window) {
  std::vector<Vector2d> pixels = window.corners_px;
  for (const auto& [frame, points] : seen)
    for (const auto& [id, eyes] : points) pixels.insert(pixels.end(), eyes[eye].begin(), eyes[eye].end());
  return pixels;
}

std::string imageName(int frame, std::size_t eye) {
  return print("frame%06d_%s.png", frame, eye == 0 ? "left" : "right");
}

TiePoints tiePointsOf(const Seen& seen, const std::array<WatchedWindow, 2>& windows, const StereoRig& rig,
                      double sigma_px) {
  TiePoints points;
  for (const auto& [frame, by_id] : seen)
    for (const auto& [id, eyes] : by_id) {
      if (eyes[0].size() != 1 || eyes[1].size() != 1) continue;
      TiePoint point;
      point.id = id;
      for (std::size_t eye = 0; eye < 2; ++eye) {
        const StraightPixel straight = windows[eye].straightened(eyes[eye][0], rig.cameras[eye]);
        point.pixels[eye] = straight.pixel;
        point.sigma_px[eye] = sigma_px * straight.stretch;
      }
      points[imageName(frame, 0)].push_back(point);
    }
  return points;
}

std::size_t ambiguousIn(const Seen& seen) {
  std::size_t count = 0;
  for (const auto& [frame, by_id] : seen)
    for (const auto& [id, eyes] : by_id) count += std::max(eyes[0].size(), eyes[1].size()) > 1;
  return count;
}

std::string windowLine(const char* key, const Window& window) {
  return print("  %s: {distance_m: %.9g, tilt_deg: %.9g, tilt_y_deg: %.9g}\n", key, window.distance_m,
               degrees(window.tilt_x_rad), degrees(window.tilt_y_rad));
}

std::string pairYaml(const StereoRig& rig, double sigma_px) {
  return cameraAloneYaml("A pair of cameras by itself, each before a window.", rig.cameras[0], 1 / kFrame_s,
                         sigma_px) +
         "  # From the windows' corners.\n  right_pose: " + yamlPose(rig.T_left_right) + "\n" +
         print("  right_pose_sigma: {position_m: %.9g, angle_deg: %.9g}\n", rig.position_sigma_m,
               degrees(rig.angle_sigma_rad)) +
         windowLine("window", rig.cameras[0].window) + windowLine("right_window", rig.cameras[1].window);
}

void writePairs(const ImportTarget& target, const fs::path& table, const StereoRig& rig, const Seen& seen) {
  const Time begin = timelessBegin();
  RawlogWriter rawlog(
      target.file(".rawlog"),
      {"", target.file("_vehicle.yaml").filename().string(), "tie points of " + table.filename().string()},
      begin);
  const int first = seen.begin()->first;
  for (const auto& [frame, points] : seen)
    rawlog.write(
        {.time = after(begin, kFrame_s * (frame - first)),
         .label = labels::kStereo,
         .reading = StereoSample{Pose{}, rig.T_left_right, recordedCamera(rig.cameras[0]),
                                 recordedCamera(rig.cameras[1]), imageName(frame, 0), imageName(frame, 1)}});
  rawlog.finish();
}

}  // namespace

TiePointImport importTiePoints(const TiePointTable& source, const ImportTarget& target, const RunInfo& run) {
  const Seen seen = readDetections(source.table);
  const std::array windows{readWatchedWindow(source.left), readWatchedWindow(source.right)};
  TiePointImport result;
  StereoRig& rig = result.rig;
  try {
    rig = placeCameras(windows, source.sigma_px,
                       {allSeenBy(0, seen, windows[0]), allSeenBy(1, seen, windows[1])});
  } catch (const std::invalid_argument& e) {
    throw Error(source.left.string() + " and " + source.right.string(), "", e.what());
  }
  const TiePoints points = tiePointsOf(seen, windows, rig, source.sigma_px);
  if (points.empty()) throw Error(source.table.string(), "", "nothing is seen by both cameras");
  result.frames = seen.size();
  for (const auto& [image, of_image] : points) result.points += of_image.size();
  result.ambiguous = ambiguousIn(seen);

  // The companions first, the rawlog last: where it is, all is.
  writeTextFile(target.file("_vehicle.yaml"), pairYaml(rig, source.sigma_px));
  writeTiePoints(tiePointsBeside(target.file(".rawlog")), points);
  nlohmann::ordered_json json;
  json["run"] = toJson(run);
  json["frames"] = result.frames;
  json["tie_points"] = result.points;
  json["ambiguous"] = result.ambiguous;
  json["corner_rms_px"] = rig.corner_rms_px;
  json["right_pose_sigma"] = {{"position_m", rig.position_sigma_m},
                              {"angle_deg", degrees(rig.angle_sigma_rad)}};
  writeJson(target.file("_import.json"), json);
  writePairs(target, source.table, rig, seen);
  return result;
}

}  // namespace fathom
