#include <iostream>
#include <memory>

#include "camera_tables/board_corners.h"
#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/text.h"
#include "import_target.h"
#include "reports/camera_report.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct CalibrateOptions {
  std::string air, water, board, image_size;
  double square_m = 0;
  CameraSetting setting;
  SelectionOptions selection;
  fs::path folder;
};

std::vector<BoardView> viewsOf(const CalibrateOptions& options) {
  const Checkerboard board = checkerboardOf(options.board, options.square_m);
  std::vector<BoardView> views;
  for (const auto& [table, in_water] : {std::pair{options.air, false}, std::pair{options.water, true}}) {
    if (table.empty()) continue;
    const auto own = boardViews(readBoardCorners(table, board, 1), in_water ? "water" : "air", in_water);
    views.insert(views.end(), own.begin(), own.end());
  }
  return views;
}

void calibrateCamera(CalibrateOptions options, const RunContext& context) {
  if (options.air.empty() && options.water.empty()) throw Error("--air", "", "or --water is needed");
  for (const std::string& id : options.selection.kinds)
    if (findCameraKind(id) == nullptr) throw Error("--kind", id, "no such kind of camera");
  const auto [width_px, height_px] = imageSizeOf("--image-size", options.image_size);
  options.setting.width_px = width_px;
  options.setting.height_px = height_px;
  const std::vector<BoardView> views = viewsOf(options);
  CameraStory story;
  story.run = {.command_line = context.command_line, .seed = options.selection.seed};
  for (const BoardView& view : views) ++(view.in_water ? story.views_in_water : story.views_in_air);
  try {
    story.selection = selectCamera(views, options.setting, options.selection);
  } catch (const std::invalid_argument& e) {
    throw Error(options.water.empty() ? options.air : options.water, "", e.what());
  }
  writeCameraStory(story, options.folder);
  std::cout << print("%zu views in air, %zu under water\n\n", story.views_in_air, story.views_in_water)
            << formatTable(kindTable(story)) << "\n"
            << formatTable(cameraTable(story)) << "\n";
  for (const auto& [kind, why] : story.selection.failed) std::cout << "note: " << kind << ": " << why << "\n";
  std::cout << "wrote " << (options.folder / "report.html").string()
            << ", camera.yaml, result.json beside it\n";
}

void addCamera(CLI::App& parent, const RunContext& context) {
  auto* command = parent.add_subcommand("camera", "A camera and its port, from corners of a checkerboard");
  command->footer(
      "Tables have image,corner,u_px,v_px, corners numbered row by row on --board. Each kind of camera is\n"
      "fitted: those with a port to all views, their lens being that in air; those without to the views\n"
      "under water, where there are any. Each is judged on images that were left out, and the simplest is\n"
      "taken that no other is clearly better than. camera.yaml is ROS's camera_info; calibration.yaml has\n"
      "the port, for simulate, smooth and diagnose.\n"
      "\n"
      "Examples:\n"
      "  fathom calibrate camera --air air.csv --board 8x6 --square-m 0.03 --image-size 1440x1080 --out "
      "out/air\n"
      "  fathom calibrate camera --air air.csv --water water.csv --board 8x6 --square-m 0.03 \\\n"
      "    --image-size 1440x1080 --out out/dome");
  const auto options = std::make_shared<CalibrateOptions>();
  command->add_option("--air", options->air, "Corners seen in air")->type_name(values::kCsv);
  command->add_option("--water", options->water, "Corners seen under water")->type_name(values::kCsv);
  command->add_option("--board", options->board, "The board's inner corners, COLUMNSxROWS")->required();
  command->add_option("--square-m", options->square_m, "Side of a square of the board, m")->required();
  command->add_option("--image-size", options->image_size, "WIDTHxHEIGHT, px")->required();
  command->add_option("--out", options->folder, "Where the results go")
      ->required()
      ->type_name(values::kFolder);
  command
      ->add_option("--kind", options->selection.kinds,
                   "Only these: pinhole, fisheye, rational, flat-port, dome-port (default: all)")
      ->delimiter(',');
  command->add_option("--glass-m", options->setting.glass_m, "Thickness of the port, m")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--folds", options->selection.folds, "Into so many parts of which one is left out")
      ->check(CLI::Range(2, 100))
      ->capture_default_str();
  command->add_option("--range-m", options->selection.range_m,
                      "Where it is told how well the camera is known (default: at the views' distance)");
  command->add_option("--seed", options->selection.seed, "Of the draws that tell it")->capture_default_str();
  command->callback([options, &context] { calibrateCamera(*options, context); });
}

}  // namespace

void addCalibrate(const RunContext& context) {
  auto* command = context.root->add_subcommand("calibrate", "Calibrate an instrument by itself");
  command->require_subcommand(1);
  addCamera(*command, context);
}

}  // namespace fathom
