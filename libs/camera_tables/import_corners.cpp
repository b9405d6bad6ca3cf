#include "camera_tables/import_corners.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "camera_tables/camera_alone.h"
#include "core/error.h"
#include "core/files.h"
#include "core/for_each.h"
#include "core/text.h"
#include "core/yaml.h"
#include "image_files/encode_image.h"
#include "imaging/camera_files.h"
#include "landmarks/given_corners.h"
#include "recording/rawlog.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr double kMargin = 1;         // squares between the outer corners and the board's edge
constexpr double kInterval_s = 1;     // the tables have no times
constexpr double kBehind_m = 0.0005;  // the board's face behind its squares

/// A sheet behind the squares of a board, with some margin.
void writeSheet(const PanelMap& board, const fs::path& folder) {
  double low_x = 1e300, high_x = -1e300, low_y = 1e300, high_y = -1e300;
  for (const Marker& marker : board.markers)
    for (const Vector3d& corner : marker.corners_panel()) {
      low_x = std::min(low_x, corner.x());
      high_x = std::max(high_x, corner.x());
      low_y = std::min(low_y, corner.y());
      high_y = std::max(high_y, corner.y());
    }
  const double margin = kMargin * board.markers[0].size_m;
  std::string text = "mtllib " + board.name + ".mtl\no board\nusemtl board\n";
  for (const auto& [x, y] : {std::pair{low_x - margin, low_y - margin},
                             {high_x + margin, low_y - margin},
                             {high_x + margin, high_y + margin},
                             {low_x - margin, high_y + margin}})
    text += print("v %.9g %.9g %.9g\n", x, y, -kBehind_m);
  writeTextFile(folder / (board.name + ".obj"), text + "f 1 2 3 4\n");
  writeTextFile(folder / (board.name + ".mtl"), "newmtl board\nKd 0.8 0.8 0.8\n");
}

/// The map's file: of one board its own, of several their list.
fs::path writeMap(const ImportTarget& target, std::vector<PanelMap> boards) {
  const fs::path folder = target.file("_boards");
  std::string list;
  for (PanelMap& board : boards) {
    board.mesh_file = board.name + ".obj";
    writeSheet(board, folder);
    writeTextFile(folder / (board.name + ".yaml"), formatPanelMap(board));
    list += (list.empty() ? "" : ", ") + board.name + ".yaml";
  }
  if (boards.size() == 1) return folder / (boards[0].name + ".yaml");
  writeTextFile(folder / "boards.yaml", "panels: [" + list + "]\n");
  return folder / "boards.yaml";
}

/// The squares as they were seen, for whoever opens the recording.
cv::Mat drawn(const CameraModel& camera, const std::vector<Detection>& squares) {
  constexpr int kFraction = 4;  // bits of a pixel
  cv::Mat image(camera.height_px, camera.width_px, CV_8UC1, cv::Scalar(200));
  for (const Detection& square : squares) {
    std::vector<cv::Point> corners;
    for (const Vector2d& p : square.corners_px)
      corners.emplace_back(static_cast<int>(std::lround(p.x() * (1 << kFraction))),
                           static_cast<int>(std::lround(p.y() * (1 << kFraction))));
    cv::fillConvexPoly(image, corners, cv::Scalar(40), cv::LINE_AA, kFraction);
  }
  return image;
}

/// By the name of the file that an image gets.
std::map<std::string, std::vector<Detection>> byFile(const fs::path& table, const BoardCorners& corners) {
  std::map<std::string, std::vector<Detection>> by_file;
  for (const auto& [image, squares] : corners.by_image)
    if (!by_file.emplace(fs::path(image).stem().string() + ".png", squares).second)
      throw Error(table.string(), "image `" + image + "`", "has the name of another one but for the ending");
  return by_file;
}

void writeImages(const ImportTarget& target, const CameraModel& camera,
                 const std::map<std::string, std::vector<Detection>>& by_file) {
  const std::vector<std::pair<std::string, std::vector<Detection>>> images(by_file.begin(), by_file.end());
  forEachIndex(images.size(), "drawing", [&](std::size_t i) {
    writeTextFile(target.file("_Images") / images[i].first, pngBytes(drawn(camera, images[i].second)));
  });
}

void writeRawlog(const ImportTarget& target, const fs::path& table, const fs::path& map,
                 const CameraModel& camera, const std::map<std::string, std::vector<Detection>>& by_file) {
  const Time begin = timelessBegin();
  RawlogWriter rawlog(
      target.file(".rawlog"),
      {fs::relative(map, target.folder).string(), target.file("_vehicle.yaml").filename().string(),
       "corners of " + table.filename().string()},
      begin);
  double t_s = 0;
  for (const auto& [file, squares] : by_file) {
    rawlog.write({.time = after(begin, t_s),
                  .label = labels::kCamera,
                  .reading = ImageSample{Pose{}, recordedCamera(camera), file}});
    t_s += kInterval_s;
  }
  rawlog.finish();
}

}  // namespace

CornerImport importCorners(const CornerTable& source, const ImportTarget& target, const RunInfo& run) {
  BoardCorners corners = readBoardCorners(source.table, source.board, source.sigma_px);
  // Under water a board lies face up, where the table does not say how: odom's z axis is vertical.
  if (source.camera.above_water && source.board) corners.boards.front().T_odom_panel = {};
  const auto by_file = byFile(source.table, corners);
  CornerImport result;
  result.images = by_file.size();
  result.boards = corners.boards.size();
  for (const auto& [file, of_image] : by_file) result.squares += of_image.size();

  // The companions first, the rawlog last: where it is, all is.
  result.map = writeMap(target, corners.boards);
  writeTextFile(target.file("_vehicle.yaml"),
                cameraAloneYaml("A camera by itself.", source.camera, 1 / kInterval_s, source.sigma_px));
  writeImages(target, source.camera, by_file);
  writeGivenCorners(cornersBeside(target.file(".rawlog")), by_file);
  nlohmann::ordered_json json;
  json["run"] = toJson(run);
  json["images"] = result.images;
  json["boards"] = result.boards;
  writeJson(target.file("_import.json"), json);
  writeRawlog(target, source.table, result.map, source.camera, by_file);
  return result;
}

CameraModel readIntrinsics(const fs::path& file, const std::optional<std::array<int, 2>>& size) {
  const YamlFile yaml(file);
  const YamlMap& root = yaml.root();
  CameraModel camera;
  readPinhole(root, camera);
  const auto sideAround = [](double middle_px) {
    return static_cast<int>(std::lround(std::clamp(2 * middle_px + 1, 0.0, kLargestImageSide_px + 1.0)));
  };
  camera.width_px = sideAround(camera.cx_px);
  camera.height_px = sideAround(camera.cy_px);
  root.read("width_px", camera.width_px);
  root.read("height_px", camera.height_px);
  root.read("above_water", camera.above_water);
  if (size) std::tie(camera.width_px, camera.height_px) = std::tie((*size)[0], (*size)[1]);
  for (const int side_px : {camera.width_px, camera.height_px})
    if (!isImageSide(side_px))
      throw root.error(
          "cx_px", print("an image has sides of 1 to %d px; --image-size says them", kLargestImageSide_px));
  if (root.has("distortion")) {
    const std::vector<double> d = root.numbers("distortion");
    if (d.size() != 4 && d.size() != 5)
      throw root.error("distortion", "must be k1, k2, p1, p2 and perhaps k3, in OpenCV's order");
    setLens(d, camera);
  }
  yaml.rejectUnknownKeys();
  return camera;
}

}  // namespace fathom
