#include "import_corners.h"

#include <iostream>
#include <memory>
#include <optional>

#include "camera_tables/import_corners.h"
#include "core/error.h"
#include "core/text.h"
#include "imaging/camera_files.h"
#include "import_target.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct CornerOptions {
  std::string table, camera, calibrate, board, image_size;
  double square_m = 0, sigma_px = 0.1;
  ImportTarget target;
};

std::optional<Checkerboard> boardOf(const CornerOptions& options) {
  if (options.board.empty()) return std::nullopt;
  return checkerboardOf(options.board, options.square_m);
}

CameraModel cameraOf(const CornerOptions& options, const std::optional<Checkerboard>& board) {
  std::optional<std::array<int, 2>> size;
  if (!options.image_size.empty()) size = imageSizeOf("--image-size", options.image_size);
  if (!options.camera.empty()) return readIntrinsics(options.camera, size);
  if (options.calibrate.empty()) throw Error("--camera", "", "or --calibrate is needed");
  if (!size) throw Error("--image-size", "", "needed with --calibrate");
  const BoardCorners air = readBoardCorners(options.calibrate, board, options.sigma_px);
  try {
    const CameraFit fit =
        fitByOpenCv(boardViews(air, "air", false), {.width_px = (*size)[0], .height_px = (*size)[1]});
    std::cout << print("camera calibrated from %zu views: %.3f px rms\n", air.by_image.size(), fit.rms_px);
    return lensOf(fit.values, *fit.kind, fit.setting);
  } catch (const std::invalid_argument& e) {
    throw Error(options.calibrate, "", e.what());
  }
}

void importCornersTo(CornerOptions options, const RunContext& context) {
  ImportTarget& target = options.target;
  if (target.name.empty()) target.name = fs::path(options.table).stem().string();
  const std::optional<Checkerboard> board = boardOf(options);
  const CornerTable source{options.table, board, cameraOf(options, board), options.sigma_px};
  const CornerImport found = importCorners(source, target, RunInfo{.command_line = context.command_line});
  std::cout << print("%zu images of %zu board%s, %zu squares with all four corners\n", found.images,
                     found.boards, found.boards > 1 ? "s" : "", found.squares);
  sayWritten(target, {".rawlog", "_corners.csv", "_vehicle.yaml", "_import.json"});
  std::cout << "wrote " << found.map.string() << "\n";
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
  auto* camera =
      command
          ->add_option(
              "--camera", options->camera,
              "Intrinsics: fx_px, fy_px, cx_px, cy_px, distortion [k1, k2, p1, p2, k3]; above_water: "
              "true of a camera in air that looks down into water")
          ->type_name(values::kYaml);
  command
      ->add_option("--calibrate", options->calibrate,
                   "Intrinsics from another table of the same board, such as one in air")
      ->type_name(values::kCsv)
      ->excludes(camera);
  command->add_option("--image-size", options->image_size,
                      "WIDTHxHEIGHT, px (default: the principal point is in the middle)");
  command->add_option("--sigma-px", options->sigma_px, "Of a corner's coordinate")
      ->check(positive())
      ->capture_default_str();
  addImportTarget(*command, options->target, "the table's");
  command->callback([options, &context] { importCornersTo(*options, context); });
}

}  // namespace fathom
