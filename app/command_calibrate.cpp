#include <iostream>
#include <memory>
#include <utility>

#include "camera_tables/board_corners.h"
#include "camera_tables/panel_views.h"
#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/text.h"
#include "import_target.h"
#include "panel/panel_maps.h"
#include "recording/rawlog.h"
#include "reports/camera_report.h"
#include "tasks/companions.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct CalibrateOptions {
  std::string air, water, board, image_size;
  std::string recording, vehicle, map;
  bool recording_in_air = false;
  std::size_t images = 100;
  double square_m = 0;
  CameraSetting setting;
  SelectionOptions selection;
  fs::path folder;
};

std::vector<BoardView> viewsOfBoard(CalibrateOptions& options) {
  for (const auto& [option, is_given] :
       {std::pair{"--board", !options.board.empty()}, std::pair{"--square-m", options.square_m > 0},
        std::pair{"--image-size", !options.image_size.empty()}})
    if (!is_given) throw Error(option, "", "is needed with --air and --water");
  const auto [width_px, height_px] = imageSizeOf("--image-size", options.image_size);
  options.setting.width_px = width_px;
  options.setting.height_px = height_px;
  const Checkerboard board = checkerboardOf(options.board, options.square_m);
  std::vector<BoardView> views;
  for (const auto& [table, in_water] : {std::pair{options.air, false}, std::pair{options.water, true}}) {
    if (table.empty()) continue;
    const auto own = boardViews(readBoardCorners(table, board, 1), in_water ? "water" : "air", in_water);
    views.insert(views.end(), own.begin(), own.end());
  }
  return views;
}

std::vector<BoardView> viewsOfRecording(CalibrateOptions& options) {
  const RecordingHeader header = RawlogReader(options.recording).header();
  const auto vehicle = readVehicle(neededVehicleFile(options.vehicle, options.recording, header));
  const auto panels = readPanelMaps(neededPanelMapFile(options.map, options.recording, header));
  PanelViews seen = panelViews(options.recording, vehicle, panels, !options.recording_in_air, options.images);
  options.setting.width_px = seen.nominal.width_px;
  options.setting.height_px = seen.nominal.height_px;
  std::cout << print("%zu images looked at, %zu views of two markers or more\n", seen.images,
                     seen.views.size());
  return std::move(seen.views);
}

void calibrateCamera(CalibrateOptions options, const RunContext& context) {
  const bool of_board = !options.air.empty() || !options.water.empty();
  if (of_board != options.recording.empty())
    throw Error("--recording", "", "is needed, or --air or --water; not both");
  for (const std::string& id : options.selection.kinds)
    if (findCameraKind(id) == nullptr) throw Error("--kind", id, "no such kind of camera");
  const std::vector<BoardView> views = of_board ? viewsOfBoard(options) : viewsOfRecording(options);
  CameraStory story;
  story.run = {.command_line = context.command_line, .seed = options.selection.seed};
  for (const BoardView& view : views) ++(view.in_water ? story.views_in_water : story.views_in_air);
  try {
    story.selection = selectCamera(views, options.setting, options.selection);
  } catch (const std::invalid_argument& e) {
    for (const std::string& source : {options.recording, options.water, options.air})
      if (!source.empty()) throw Error(source, "", e.what());
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
  auto* command = parent.add_subcommand(
      "camera", "A camera and its port, from corners of a checkerboard or a recording's own panel");
  command->footer(
      "Tables have image,corner,u_px,v_px, corners numbered row by row on --board. Each kind of camera is\n"
      "fitted: those with a port to all views, their lens being that in air; those without to the views\n"
      "under water, where there are any. Each is judged on images that were left out, and the simplest is\n"
      "taken that no other is clearly better than. camera.yaml is ROS's camera_info; calibration.yaml has\n"
      "the port, for simulate, smooth and diagnose. --recording takes markers' corners in its images "
      "instead,\n"
      "with their places as the panel map has them: what the panel is off by is taken for the camera.\n"
      "\n"
      "Examples:\n"
      "  fathom calibrate camera --air air.csv --board 8x6 --square-m 0.03 --image-size 1440x1080 --out "
      "out/air\n"
      "  fathom calibrate camera --air air.csv --water water.csv --board 8x6 --square-m 0.03 \\\n"
      "    --image-size 1440x1080 --out out/dome\n"
      "  fathom calibrate camera --recording dive.rawlog --out out/camera");
  const auto options = std::make_shared<CalibrateOptions>();
  command->add_option("--air", options->air, "Corners seen in air")->type_name(values::kCsv);
  command->add_option("--water", options->water, "Corners seen under water")->type_name(values::kCsv);
  command->add_option("--board", options->board, "The board's inner corners, COLUMNSxROWS");
  command->add_option("--square-m", options->square_m, "Side of a square of the board, m");
  command->add_option("--image-size", options->image_size, "WIDTHxHEIGHT, px");
  command->add_option("--recording", options->recording, "A rawlog whose images show a panel")
      ->type_name(values::kRawlog);
  command->add_option("--map", options->map, "Its panel map; without it, the recording's own")
      ->type_name(values::kYaml);
  command->add_option("--vehicle", options->vehicle, "Its vehicle file; without it, the recording's own")
      ->type_name(values::kYaml);
  command->add_flag("--recording-in-air", options->recording_in_air, "It was not taken under water");
  command->add_option("--images", options->images, "Of the recording: at most so many, evenly spread")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
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
