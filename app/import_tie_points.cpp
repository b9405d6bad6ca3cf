#include "import_tie_points.h"

#include <algorithm>
#include <cmath>
#include <iostream>
#include <memory>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "import_target.h"
#include "landmarks/tie_points.h"
#include "landmarks/watched_window.h"
#include "recording/csv.h"
#include "recording/imported.h"
#include "recording/rawlog.h"
#include "report/run_info.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr double kFrame_s = 1;  // the tables have no times
const std::vector<std::string> kDetectionColumns{"camera", "frame", "id", "u_px", "v_px"};

struct TiePointOptions {
  std::string table, left, right;
  double sigma_px = 1;
  ImportTarget target;
};

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

void writePairs(const TiePointOptions& options, const StereoRig& rig, const Seen& seen) {
  const Time begin = timelessBegin();
  RawlogWriter rawlog(options.target.file(".rawlog"),
                      {"", options.target.file("_vehicle.yaml").filename().string(),
                       "tie points of " + fs::path(options.table).filename().string()},
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

void importTiePoints(TiePointOptions options, const RunContext& context) {
  ImportTarget& target = options.target;
  if (target.name.empty()) target.name = fs::path(options.table).stem().string();
  const Seen seen = readDetections(options.table);
  const std::array windows{readWatchedWindow(options.left), readWatchedWindow(options.right)};
  StereoRig rig;
  try {
    rig = placeCameras(windows, options.sigma_px,
                       {allSeenBy(0, seen, windows[0]), allSeenBy(1, seen, windows[1])});
  } catch (const std::invalid_argument& e) {
    throw Error(options.left + " and " + options.right, "", e.what());
  }
  const TiePoints points = tiePointsOf(seen, windows, rig, options.sigma_px);
  if (points.empty()) throw Error(options.table, "", "nothing is seen by both cameras");

  // The companions first, the rawlog last: where it is, all is.
  writeTextFile(target.file("_vehicle.yaml"), pairYaml(rig, options.sigma_px));
  writeTiePoints(tiePointsBeside(target.file(".rawlog")), points);
  std::size_t count = 0;
  for (const auto& [image, of_image] : points) count += of_image.size();
  const std::size_t ambiguous = ambiguousIn(seen);
  nlohmann::ordered_json json;
  json["run"] = toJson(RunInfo{.command_line = context.command_line});
  json["frames"] = seen.size();
  json["tie_points"] = count;
  json["ambiguous"] = ambiguous;
  json["corner_rms_px"] = rig.corner_rms_px;
  json["right_pose_sigma"] = {{"position_m", rig.position_sigma_m},
                              {"angle_deg", degrees(rig.angle_sigma_rad)}};
  writeJson(target.file("_import.json"), json);
  writePairs(options, rig, seen);

  std::cout << print("%zu frames, %zu points seen by both cameras, once by each (%zu left out: twice)\n",
                     seen.size(), count, ambiguous)
            << print(
                   "windows %.3f and %.3f m before the cameras, whose corners fit to %.1f and %.1f px: the "
                   "right camera is known to %.1f mm and %.2f degrees\n",
                   rig.cameras[0].window.distance_m, rig.cameras[1].window.distance_m, rig.corner_rms_px[0],
                   rig.corner_rms_px[1], 1000 * rig.position_sigma_m, degrees(rig.angle_sigma_rad));
  sayWritten(target, {".rawlog", "_points.csv", "_vehicle.yaml", "_import.json"});
}

}  // namespace

void addImportTiePoints(CLI::App& parent, const RunContext& context) {
  auto* command =
      parent.add_subcommand("tie-points", "From what two cameras see of the same points, without images");
  command->footer(
      "Reads camera,frame,id,u_px,v_px: what has the same frame and id is the same point (an id twice in a\n"
      "frame of one camera is left out). Each camera's file has fx_px, fy_px, cx_px, cy_px, distortion in\n"
      "OpenCV's order, and reference_corners, the corners {u_px, v_px, x_cm, y_cm, z_cm} of the window that\n"
      "it looks through, which say where it stands. Writes a recording of pairs without their images,\n"
      "pinholes for cameras, and NAME_points.csv, which `diagnose` and `smooth` take: lines of sight of one\n"
      "point should meet.\n"
      "\n"
      "Example:\n"
      "  fathom import tie-points detections.csv --left camera1.yaml --right camera2.yaml \\\n"
      "    --out out/two_view\n"
      "  fathom diagnose out/two_view/detections.rawlog --out out/two_view/diagnosis");
  const auto options = std::make_shared<TiePointOptions>();
  command->add_option("TABLE", options->table, "What was seen")->required()->type_name(values::kCsv);
  command->add_option("--left", options->left, "Camera 1")->required()->type_name(values::kYaml);
  command->add_option("--right", options->right, "Camera 2")->required()->type_name(values::kYaml);
  command->add_option("--sigma-px", options->sigma_px, "Of a coordinate of a point; of a corner, at least")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  addImportTarget(*command, options->target, "the table's");
  command->callback([options, &context] { importTiePoints(*options, context); });
}

}  // namespace fathom
