#include <iostream>
#include <memory>
#include <set>
#include <stdexcept>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/shipped_file.h"
#include "inputs/known_effects.h"
#include "reports/handle_evaluation_report.h"
#include "reports/panel_evaluation_report.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct PanelOptions {
  std::string map, vehicle, calibration, folder, backend = "apriltag", preprocess = "none";
  std::vector<std::string> waters{"clear=config/water_clear.yaml", "moderate=config/water_moderate.yaml",
                                  "turbid=config/water_turbid.yaml"};
  bool no_fallback = false;
  double smallest_tilt_deg = degrees(ViewRanges{}.smallest_tilt_rad);
  double largest_tilt_deg = degrees(ViewRanges{}.largest_tilt_rad);
  double largest_roll_deg = degrees(ViewRanges{}.largest_roll_rad);
  PanelEvaluationOptions evaluation;
};

struct HandleOptions {
  std::string map, vehicle, folder;
  std::vector<std::string> waters = PanelOptions{}.waters;
  double largest_tilt_deg = degrees(HandleEvaluationOptions{}.ranges.largest_tilt_rad);
  HandleEvaluationOptions evaluation;
};

/// NAME=FILE; a file alone is named by its stem.
template <class Results>
Results waterOf(const std::string& text) {
  const auto equals = text.find('=');
  Results water;
  water.file = equals == std::string::npos ? text : text.substr(equals + 1);
  water.name = equals == std::string::npos ? fs::path(text).stem().string() : text.substr(0, equals);
  if (water.name.empty() || water.name.find_first_of(",\"\r\n") != std::string::npos)
    throw Error("--water", text, "the name must have a letter, and no comma or quote");
  return water;
}

template <class Results>
std::vector<Results> watersOf(const std::vector<std::string>& texts) {
  std::vector<Results> waters;
  std::set<std::string> names;
  for (const auto& text : texts) {
    waters.push_back(waterOf<Results>(text));
    if (!names.insert(waters.back().name).second) throw Error("--water", text, "this name is there twice");
  }
  return waters;
}

PanelEvaluationOptions evaluationOf(const PanelOptions& options) {
  PanelEvaluationOptions evaluation = options.evaluation;
  evaluation.ranges.smallest_tilt_rad = radians(options.smallest_tilt_deg);
  evaluation.ranges.largest_tilt_rad = radians(options.largest_tilt_deg);
  evaluation.ranges.largest_roll_rad = radians(options.largest_roll_deg);
  evaluation.backend = backendNamed(options.backend);
  evaluation.fallback = !options.no_fallback;
  for (const Preprocess kind : {Preprocess::stretch, Preprocess::clahe})
    if (options.preprocess == nameOf(kind)) evaluation.preprocess = kind;
  try {
    drawView(evaluation.ranges, evaluation.seed, 0);
  } catch (const std::invalid_argument& refused) {
    throw Error("command line",
                "--nearest, --farthest, --smallest-tilt, --largest-tilt, --largest-roll, --largest-aim",
                refused.what());
  }
  return evaluation;
}

PanelMap mapWithMarkers(const std::string& file, Backend backend) {
  PanelMap map = readPanelMap(file);
  if (map.markers.empty()) throw Error(file, "markers", "there are none, so no pose can be found");
  for (const Marker& marker : map.markers)
    if (!canRead(backend, marker.family))
      throw Error(file, "markers",
                  "the " + std::string(nameOf(backend)) + " backend cannot read " + marker.family);
  return map;
}

Vehicle vehicleWithCamera(const std::string& file) {
  Vehicle vehicle = readVehicle(file);
  if (!vehicle.camera) throw Error(file, "camera", "the vehicle has none");
  return vehicle;
}

void evaluatePanelPoses(const PanelOptions& options, const RunContext& context) {
  PanelEvaluationStory story;
  story.options = evaluationOf(options);
  story.run = {.command_line = context.command_line, .seed = story.options.seed};
  story.map = options.map;
  story.vehicle = options.vehicle;
  story.known = readKnownEffects(options.calibration);
  story.options.effects = story.known.effects;
  story.waters = watersOf<WaterResults>(options.waters);
  const PanelMap map = mapWithMarkers(options.map, story.options.backend);
  const Vehicle vehicle = vehicleWithCamera(options.vehicle);
  std::vector<Environment> environments;
  for (const auto& water : story.waters) environments.push_back(readEnvironment(shippedFile(water.file)));
  for (std::size_t i = 0; i < story.waters.size(); ++i)
    story.waters[i].views = evaluatePanel(map, vehicle, environments[i], story.options,
                                          "evaluating in " + story.waters[i].name + " water");
  if (story.known.given()) std::cout << story.known.inWords() << "\n\n";
  std::cout << formatTable(errorTable(story)) << "\n" << formatTable(honestyTable(story));
  if (options.folder.empty()) return;
  writeOutputs(story, options.folder);
  std::cout << "\nreport: " << (fs::path(options.folder) / "report.html").string() << "\n";
}

constexpr const char* kPanelHelp =
    "Draws views of the panel, makes their images by the simulator's forward model, finds the markers and "
    "solves\n"
    "for the panel's pose twice, from the same corners: as the paper does (mean of the poses of single "
    "markers)\n"
    "and jointly over all corners. Prints and writes errors, their ratio, flipped poses, and whether the "
    "stated\n"
    "covariance is honest (NEES, 6 expected). All waters have the same views; the same seed gives the same "
    "bytes.\n"
    "\n";

constexpr const char* kPanelExamples =
    "\n"
    "Examples:\n"
    "  fathom evaluate panel --map maps/dexrov/panel.yaml --vehicle config/rov.yaml --out out/panel\n"
    "  fathom evaluate panel --map maps/dexrov/panel.yaml --vehicle config/rov.yaml --views 200\n"
    "      --water config/water_moderate.yaml --nearest 2 --farthest 2\n"
    "  fathom evaluate panel --map maps/dexrov/panel.yaml --vehicle config/rov.yaml\n"
    "      --calibration out/dive/calibration.yaml --water out/water/dive_water.yaml";

void addPanel(CLI::App& parent, const RunContext& context) {
  auto* command =
      parent.add_subcommand("panel", "How far the panel's pose is from truth, in several waters (task T_P)");
  command->footer(kPanelHelp + std::string(kEffectsInViews) + kPanelExamples);
  const auto options = std::make_shared<PanelOptions>();
  PanelEvaluationOptions& evaluation = options->evaluation;
  ViewRanges& ranges = evaluation.ranges;
  command->add_option("--map", options->map, "The panel")->required()->type_name(values::kYaml);
  command->add_option("--vehicle", options->vehicle, "Its camera and lamps")
      ->required()
      ->type_name(values::kYaml);
  command->add_option("--water", options->waters, "Water and light, as NAME=FILE or FILE; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name(values::kYaml)
      ->capture_default_str();
  auto* calibration =
      addCalibrationOption(*command, options->calibration, "Effects that the images are to have");
  addTimeOption(*command, evaluation.t_s, calibration);
  command->add_option("--out", options->folder, "Where report.html, result.json and views.csv go")
      ->type_name(values::kFolder);
  command->add_option("--views", evaluation.views, "Number of views in each water")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", evaluation.seed, "Of views and noise")->capture_default_str();
  command->add_option("--nearest", ranges.nearest_m, "Camera to panel's centre, m")->capture_default_str();
  command->add_option("--farthest", ranges.farthest_m, "Likewise")->capture_default_str();
  command
      ->add_option("--smallest-tilt", options->smallest_tilt_deg,
                   "Between the panel's normal and the line of sight, degrees")
      ->capture_default_str();
  command->add_option("--largest-tilt", options->largest_tilt_deg, "Likewise")->capture_default_str();
  command
      ->add_option("--largest-roll", options->largest_roll_deg,
                   "Of the camera about its axis, degrees to both sides")
      ->capture_default_str();
  command
      ->add_option("--largest-aim", ranges.largest_aim_m,
                   "How far beside the panel's centre the camera looks, m in x and in y")
      ->capture_default_str();
  command->add_option("--backend", options->backend, "Library that searches first")
      ->check(CLI::IsMember(backendNames()))
      ->capture_default_str();
  command->add_option("--preprocess", options->preprocess, "Before the search: none, clahe or stretch")
      ->check(CLI::IsMember({"none", "clahe", "stretch"}))
      ->capture_default_str();
  command->add_flag("--no-fallback", options->no_fallback,
                    "Do not search with the other library for what the first one misses");
  command->callback([options, &context] { evaluatePanelPoses(*options, context); });
}

void evaluateHandleAngles(const HandleOptions& options, const RunContext& context) {
  HandleEvaluationStory story;
  story.options = options.evaluation;
  story.options.ranges.largest_tilt_rad = radians(options.largest_tilt_deg);
  story.run = {.command_line = context.command_line, .seed = story.options.seed};
  story.map = options.map;
  story.vehicle = options.vehicle;
  story.waters = watersOf<HandleWaterResults>(options.waters);
  const PanelMap map = mapWithMarkers(options.map, Backend::apriltag);
  if (map.handles.empty()) throw Error(options.map, "handles", "there are none");
  story.handles = map.handles;
  const Vehicle vehicle = vehicleWithCamera(options.vehicle);
  try {
    drawView(story.options.ranges, story.options.seed, 0);
  } catch (const std::invalid_argument& refused) {
    throw Error("command line", "--nearest, --farthest, --largest-tilt", refused.what());
  }
  std::vector<Environment> environments;
  for (const auto& water : story.waters) environments.push_back(readEnvironment(shippedFile(water.file)));
  for (std::size_t i = 0; i < story.waters.size(); ++i)
    story.waters[i].views = evaluateHandles(map, vehicle, environments[i], story.options,
                                            "evaluating in " + story.waters[i].name + " water");
  std::cout << formatTable(handleErrorTable(story)) << "\n" << formatTable(contourTable(story));
  if (const Table unread = unreadTable(story); !unread.rows.empty()) std::cout << "\n" << formatTable(unread);
  if (options.folder.empty()) return;
  writeOutputs(story, options.folder);
  std::cout << "\nreport: " << (fs::path(options.folder) / "report.html").string() << "\n";
}

void addHandleEvaluation(CLI::App& parent, const RunContext& context) {
  auto* command = parent.add_subcommand(
      "handles", "How far the handles' angles are from truth, in several waters (task T_H)");
  command->footer(
      "Draws views of a handle each, all handles turned at random, makes their images by the simulator's "
      "forward\n"
      "model (daylight, lamps off), finds the panel by its markers, and reads the handle twice: by the "
      "paper's\n"
      "chain (region of interest, contour led by a superellipse, Canny, Hough), and by rendering it at "
      "candidate\n"
      "angles. Prints and writes errors, whether the stated sigma is honest, why views have no angle, and "
      "how well\n"
      "the contour covers what the renderer says is the handle. The same seed gives the same bytes.\n"
      "\n"
      "Example:\n"
      "  fathom evaluate handles --map maps/dexrov/panel.yaml --vehicle config/rov.yaml --out out/handles");
  const auto options = std::make_shared<HandleOptions>();
  HandleEvaluationOptions& evaluation = options->evaluation;
  command->add_option("--map", options->map, "The panel")->required()->type_name(values::kYaml);
  command->add_option("--vehicle", options->vehicle, "Its camera")->required()->type_name(values::kYaml);
  command->add_option("--water", options->waters, "Water and light, as NAME=FILE or FILE; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name(values::kYaml)
      ->capture_default_str();
  command->add_option("--out", options->folder, "Where report.html, result.json and views.csv go")
      ->type_name(values::kFolder);
  command->add_option("--views", evaluation.views, "Number of views in each water")
      ->check(CLI::Range(1, 1000000))
      ->capture_default_str();
  command->add_option("--seed", evaluation.seed, "Of views, angles and noise")->capture_default_str();
  command->add_option("--nearest", evaluation.ranges.nearest_m, "Camera to handle, m")->capture_default_str();
  command->add_option("--farthest", evaluation.ranges.farthest_m, "Likewise")->capture_default_str();
  command
      ->add_option("--largest-tilt", options->largest_tilt_deg,
                   "Between the panel's normal and the line of sight, degrees")
      ->capture_default_str();
  command->callback([options, &context] { evaluateHandleAngles(*options, context); });
}

}  // namespace

void addEvaluate(const RunContext& context) {
  auto* command = context.root->add_subcommand("evaluate", "Judge estimators against truth");
  command->require_subcommand(1);
  addPanel(*command, context);
  addHandleEvaluation(*command, context);
}

}  // namespace fathom
