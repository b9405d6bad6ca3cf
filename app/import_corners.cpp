#include "import_corners.h"

#include <iostream>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <regex>

#include "core/error.h"
#include "core/files.h"
#include "core/for_each.h"
#include "core/text.h"
#include "core/yaml.h"
#include "imaging/camera_files.h"
#include "import_target.h"
#include "landmarks/board_corners.h"
#include "landmarks/given_corners.h"
#include "recording/imported.h"
#include "recording/rawlog.h"
#include "render/images.h"
#include "report/run_info.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr double kMargin = 1;         // squares between the outer corners and the board's edge
constexpr double kInterval_s = 1;     // the tables have no times
constexpr double kBehind_m = 0.0005;  // the board's face behind its squares

struct CornerOptions {
  std::string table, camera, calibrate, board, image_size;
  double square_m = 0, sigma_px = 0.1;
  ImportTarget target;
};

/// "8x6".
std::array<int, 2> timesOf(const std::string& option, const std::string& text) {
  std::smatch parts;
  if (!std::regex_match(text, parts, std::regex("([0-9]{1,5})x([0-9]{1,5})")))
    throw Error(option, text, "must be WIDTHxHEIGHT");
  return {std::stoi(parts[1]), std::stoi(parts[2])};
}

std::optional<Checkerboard> boardOf(const CornerOptions& options) {
  if (options.board.empty()) return std::nullopt;
  const auto [columns, rows] = timesOf("--board", options.board);
  if (columns < 2 || rows < 2) throw Error("--board", options.board, "must be 2x2 or more");
  if (!(options.square_m > 0)) throw Error("--square-m", "", "needed with --board, greater than zero");
  return Checkerboard{columns, rows, options.square_m};
}

/// Intrinsics as such data sets publish them. Where no size stands there or in `size`, the principal point is
/// taken for the image's middle.
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
  if (size) std::tie(camera.width_px, camera.height_px) = std::tie((*size)[0], (*size)[1]);
  for (const int side_px : {camera.width_px, camera.height_px})
    if (!isImageSide(side_px))
      throw root.error(
          "cx_px", print("an image has sides of 1 to %d px; --image-size says them", kLargestImageSide_px));
  if (root.has("distortion")) {
    const std::vector<double> d = root.numbers("distortion");
    if (d.size() != 4 && d.size() != 5)
      throw root.error("distortion", "must be k1, k2, p1, p2 and perhaps k3, in OpenCV's order");
    setPlumbBob(d, camera);
  }
  yaml.rejectUnknownKeys();
  return camera;
}

CameraModel cameraOf(const CornerOptions& options, const std::optional<Checkerboard>& board) {
  std::optional<std::array<int, 2>> size;
  if (!options.image_size.empty()) {
    size = timesOf("--image-size", options.image_size);
    if (!isImageSide((*size)[0]) || !isImageSide((*size)[1]))
      throw Error("--image-size", options.image_size,
                  print("sides must be from 1 to %d px", kLargestImageSide_px));
  }
  if (!options.camera.empty()) return readIntrinsics(options.camera, size);
  if (options.calibrate.empty()) throw Error("--camera", "", "or --calibrate is needed");
  if (!size) throw Error("--image-size", "", "needed with --calibrate");
  const BoardCorners air = readBoardCorners(options.calibrate, board, options.sigma_px);
  try {
    const CalibratedCamera calibrated = calibrateCamera(air, (*size)[0], (*size)[1]);
    std::cout << print("camera calibrated from %zu views: %.3f px rms\n", air.by_image.size(),
                       calibrated.rms_px);
    return calibrated.camera;
  } catch (const std::invalid_argument& e) {
    throw Error(options.calibrate, "", e.what());
  }
}

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
std::map<std::string, std::vector<Detection>> byFile(const CornerOptions& options,
                                                     const BoardCorners& corners) {
  std::map<std::string, std::vector<Detection>> by_file;
  for (const auto& [image, squares] : corners.by_image)
    if (!by_file.emplace(fs::path(image).stem().string() + ".png", squares).second)
      throw Error(options.table, "image `" + image + "`", "has the name of another one but for the ending");
  return by_file;
}

void writeImages(const ImportTarget& target, const CameraModel& camera,
                 const std::map<std::string, std::vector<Detection>>& by_file) {
  const std::vector<std::pair<std::string, std::vector<Detection>>> images(by_file.begin(), by_file.end());
  forEachIndex(images.size(), "drawing", [&](std::size_t i) {
    writeTextFile(target.file("_Images") / images[i].first, pngBytes(drawn(camera, images[i].second)));
  });
}

void writeRawlog(const CornerOptions& options, const fs::path& map, const CameraModel& camera,
                 const std::map<std::string, std::vector<Detection>>& by_file) {
  const Time begin = timelessBegin();
  RawlogWriter rawlog(options.target.file(".rawlog"),
                      {fs::relative(map, options.target.folder).string(),
                       options.target.file("_vehicle.yaml").filename().string(),
                       "corners of " + fs::path(options.table).filename().string()},
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

void importCorners(CornerOptions options, const RunContext& context) {
  ImportTarget& target = options.target;
  if (target.name.empty()) target.name = fs::path(options.table).stem().string();
  const std::optional<Checkerboard> board = boardOf(options);
  const CameraModel camera = cameraOf(options, board);
  const BoardCorners corners = readBoardCorners(options.table, board, options.sigma_px);
  const auto by_file = byFile(options, corners);

  // The companions first, the rawlog last: where it is, all is.
  const fs::path map = writeMap(target, corners.boards);
  writeTextFile(target.file("_vehicle.yaml"),
                cameraAloneYaml("A camera by itself.", camera, 1 / kInterval_s, options.sigma_px));
  writeImages(target, camera, by_file);
  writeGivenCorners(cornersBeside(target.file(".rawlog")), by_file);
  nlohmann::ordered_json json;
  json["run"] = toJson(RunInfo{.command_line = context.command_line});
  json["images"] = by_file.size();
  json["boards"] = corners.boards.size();
  writeJson(target.file("_import.json"), json);
  writeRawlog(options, map, camera, by_file);

  std::size_t squares = 0;
  for (const auto& [file, of_image] : by_file) squares += of_image.size();
  std::cout << print("%zu images of %zu board%s, %zu squares with all four corners\n", by_file.size(),
                     corners.boards.size(), corners.boards.size() > 1 ? "s" : "", squares);
  sayWritten(target, {".rawlog", "_corners.csv", "_vehicle.yaml", "_import.json"});
  std::cout << "wrote " << map.string() << "\n";
}

}  // namespace

void addImportCorners(CLI::App& parent, const RunContext& context) {
  auto* command = parent.add_subcommand("corners", "From measured checkerboard corners, without images");
  command->footer(
      "Reads image,corner,u_px,v_px (corners numbered row by row on --board) or\n"
      "x_mm,y_mm,z_mm,u_px,v_px (one image of one or more boards). Every second square of a board is taken\n"
      "for a marker. Writes a recording with the squares drawn, a map of the boards, and\n"
      "NAME_corners.csv, which `smooth` and `diagnose` take instead of searching the images.\n"
      "\n"
      "Examples:\n"
      "  fathom import corners water.csv --board 8x6 --square-m 0.03 --calibrate air.csv \\\n"
      "    --image-size 1440x1080 --out out/dome\n"
      "  fathom import corners corners.csv --camera camera.yaml --out out/tank\n"
      "  fathom diagnose out/tank/corners.rawlog --out out/tank/diagnosis");
  const auto options = std::make_shared<CornerOptions>();
  command->add_option("TABLE", options->table, "The corners")->required()->type_name(values::kCsv);
  command->add_option("--board", options->board, "The board's inner corners, COLUMNSxROWS");
  command->add_option("--square-m", options->square_m, "Side of a square of the board, m");
  auto* camera = command
                     ->add_option("--camera", options->camera,
                                  "Intrinsics: fx_px, fy_px, cx_px, cy_px, distortion [k1, k2, p1, p2, k3]")
                     ->type_name(values::kYaml);
  command
      ->add_option("--calibrate", options->calibrate,
                   "Intrinsics from another table of the same board, such as one in air")
      ->type_name(values::kCsv)
      ->excludes(camera);
  command->add_option("--image-size", options->image_size,
                      "WIDTHxHEIGHT, px (default: the principal point is in the middle)");
  command->add_option("--sigma-px", options->sigma_px, "Of a corner's coordinate")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  addImportTarget(*command, options->target, "the table's");
  command->callback([options, &context] { importCorners(*options, context); });
}

}  // namespace fathom
