#include <iostream>
#include <memory>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/shipped_file.h"
#include "inputs/known_effects.h"
#include "panel/panel_maps.h"
#include "recording/rawlog.h"
#include "reports/water_report.h"
#include "tasks/companions.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct FitWaterOptions {
  std::string recording, vehicle, map, calibration, folder;
  std::string water = "config/water_clear.yaml", backend = "apriltag", gain = "auto";
  WaterStudyOptions study;
};

WaterFitOptions::Gain gainNamed(const std::string& name) {
  if (name == "on") return WaterFitOptions::Gain::fitted;
  return name == "off" ? WaterFitOptions::Gain::fixed : WaterFitOptions::Gain::detected;
}

Environment defaultWater(const std::string& file) {
  Environment environment = readEnvironment(shippedFile(file));
  if (environment.lamps_irradiance_1m)
    throw Error(file, "lamps_irradiance_1m",
                "water is fitted in daylight only; take a default without lamps");
  return environment;
}

void printStory(const WaterStory& story, const fs::path& water, const fs::path& folder) {
  const WaterStudy& study = story.study;
  for (const std::string& remark : story.remarks) std::cout << remark << "\n";
  if (story.known.given()) std::cout << story.known.inWords() << "\n";
  std::cout << study.fit.images << " images fitted, " << study.fit.patches << " patches, "
            << study.fit.outliers << " of them left out; " << study.choice.held_out.size()
            << " images held out\n\n"
            << formatTable(parameterTable(story)) << "\n";
  for (const std::string& warning : study.fit.warnings) std::cout << "warning: " << warning << "\n";
  std::cout << formatTable(heldOutTable(story)) << "\nrecommended: " << study.recommendedWater().name << "\n";
  if (study.panel_poses) std::cout << "\n" << formatTable(panelPoseTable(story));
  std::cout << "\nwater: " << water.string() << "\nreport: " << (folder / "report.html").string() << "\n";
}

void fitWaterTo(const FitWaterOptions& options, const RunContext& context) {
  WaterStory story{.run = {.command_line = context.command_line, .seed = options.study.seed},
                   .recording = options.recording,
                   .map = {},
                   .vehicle = {},
                   .default_water = options.water,
                   .known = readKnownEffects(options.calibration),
                   .study = {},
                   .remarks = {}};
  const RecordingHeader header = RawlogReader(options.recording).header();
  story.vehicle = neededVehicleFile(options.vehicle, options.recording, header);
  story.map = neededPanelMapFile(options.map, options.recording, header);
  KnownWorld world{readVehicle(story.vehicle), readPanelMaps(story.map), defaultWater(options.water),
                   story.known.effects, seaFloorOf(options.recording)};
  if (!world.vehicle.camera) throw Error(story.vehicle, "camera", "the vehicle has none");
  const DetectionSettings detection = settingsFor(world.panels, backendNamed(options.backend));
  if (detection.families.empty()) throw Error(story.map, "markers", "there are none");

  WaterStudyOptions how = options.study;
  how.fit.start = world.environment;
  how.fit.gain = gainNamed(options.gain);
  how.panel_poses.backend = detection.backend;
  story.remarks = disagreements(inspectRecording(options.recording), world.vehicle);
  const PosedImages images =
      posedImages(options.recording, world.vehicle, world.panels, detection, world.effects);
  const PairMaker maker(world, PairOptions{}, detection);
  story.study = studyWater(options.recording, images, maker, how);
  const auto& more = story.study.remarks;
  story.remarks.insert(story.remarks.end(), more.begin(), more.end());
  printStory(story, writeOutputs(story, options.folder), options.folder);
}

constexpr const char* kFitWaterHelp =
    "Where an image was taken follows from its markers; the panel is rendered from there without water, and\n"
    "what it loses and gains on its way to the camera is fitted, for red, green and blue: attenuation a, "
    "veil b\n"
    "and ambient light E in   radiance = gain (albedo E exp(-a z) + (1 - exp(-a z)) b).   Baseline: the "
    "paper's\n"
    "search for the a and b of largest FSIM, from the default water. Images that neither has seen decide "
    "which\n"
    "water is recommended. Writes NAME_water.yaml, which simulate --water takes, result.json, report.html\n"
    "and waters.png. The same seed gives the same bytes.\n"
    "\n"
    "With --calibration (a file as `fathom diagnose` writes it), images are posed, rendered and fitted with "
    "the\n"
    "effects in it, which are active when they say: lamps, another response, a veil of its own, a lens that "
    "is\n"
    "not as stated. What is drawn for each image is not known: gains make up for it. The panel's pose "
    "errors\n"
    "(task T_P) are those expected with the effects, of estimators that know nothing of them.\n"
    "\n"
    "Examples:\n"
    "  fathom fit-water rawlogs/trial/trial.rawlog --out out/water\n"
    "  fathom fit-water dive.rawlog --water config/water_moderate.yaml --exposure-gain on --out out/water\n"
    "  fathom fit-water dive.rawlog --calibration out/dive/calibration.yaml --out out/water\n"
    "  fathom simulate --trajectory dive_truth.tum --vehicle rov.yaml --map panel.yaml\n"
    "      --water out/water/dive_water.yaml --out out/again";

}  // namespace

void addFitWater(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "fit-water", "The water and light of a recording, from its images of the panel (task T_E)");
  command->footer(kFitWaterHelp);
  const auto options = std::make_shared<FitWaterOptions>();
  WaterStudyOptions& study = options->study;
  command->add_option("recording", options->recording, "Its images must show a panel")
      ->required()
      ->type_name(values::kRawlog);
  command->add_option("--out", options->folder, "Where the water and the report go")
      ->required()
      ->type_name(values::kFolder);
  command->add_option("--water", options->water, "The default water: where the paper's search begins")
      ->type_name(values::kYaml)
      ->capture_default_str();
  addCalibrationOption(*command, options->calibration, "Effects that the recording is known to have");
  command->add_option("--map", options->map, "Panel or panels (default: what the recording names)")
      ->type_name(values::kYaml);
  command->add_option("--vehicle", options->vehicle, "Vehicle file (default: what the recording names)")
      ->type_name(values::kYaml);
  command->add_option("--images", study.choice.images, "To fit on, at most")
      ->check(CLI::Range(3, 100000))
      ->capture_default_str();
  command->add_option("--held-out", study.choice.held_out, "To judge on, at most")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command
      ->add_option("--exposure-gain", options->gain,
                   "One gain an image: on, off, or auto (where images turn out to differ)")
      ->check(CLI::IsMember({"auto", "on", "off"}))
      ->capture_default_str();
  command->add_option("--search-steps", study.search.evaluations, "Waters that the paper's search tries")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--backend", options->backend, "Which library finds the markers")
      ->check(CLI::IsMember(backendNames()))
      ->capture_default_str();
  command->add_option("--seed", study.seed, "Of the noise in simulated images")->capture_default_str();
  command->callback([options, &context] { fitWaterTo(*options, context); });
}

}  // namespace fathom
