#include <algorithm>
#include <iostream>
#include <memory>

#include "commands.h"
#include "core/error.h"
#include "core/files.h"
#include "core/shipped_file.h"
#include "effects/calibration.h"
#include "panel/panel_maps.h"
#include "reports/sil_report.h"
#include "simulation/copy_panel_map.h"
#include "tasks/companions.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct SilCommandOptions {
  std::string recording, vehicle, map, calibration, folder;
  std::string water = "config/water_clear.yaml", backend = "apriltag";
  std::optional<double> sea_floor_z_m;
  std::uint64_t sand_seed = 1;
  bool no_noise = false, no_video = false;
  SilOptions sil;
};

std::optional<KnownSeaFloor> seaFloor(const SilCommandOptions& options) {
  if (options.sea_floor_z_m) return KnownSeaFloor{*options.sea_floor_z_m, options.sand_seed};
  return seaFloorOf(options.recording);
}

/// The rawlog of pairs is a recording of its own, with its vehicle and panel beside it.
SilTarget targetOf(const SilStory& story, const fs::path& folder) {
  const std::string name = fs::path(story.recording).stem().string();
  const std::string vehicle = name + "_pairs_vehicle.yaml", panel = name + "_pairs_panel";
  writeTextFile(folder / vehicle, readTextFile(story.vehicle));
  const fs::path map = copyPanelMap(story.map, folder / panel);
  return {story.recording,
          folder,
          name,
          {map.lexically_relative(folder).generic_string(), vehicle,
           "pairs of recorded (CAMERA) and simulated (SIMULATED) images of " + name}};
}

void sil(const SilCommandOptions& options, const RunContext& context) {
  SilStory story{.run = {.command_line = context.command_line, .seed = options.sil.pairs.seed},
                 .recording = options.recording,
                 .map = {},
                 .vehicle = {},
                 .water = options.water,
                 .calibration = options.calibration,
                 .sea_floor = seaFloor(options),
                 .options = options.sil,
                 .results = {},
                 .remarks = {},
                 .sheet = {}};
  const RecordingHeader header = RawlogReader(options.recording).header();
  story.vehicle = neededVehicleFile(options.vehicle, options.recording, header);
  story.map = neededPanelMapFile(options.map, options.recording, header);
  story.options.pairs.noise = !options.no_noise;
  story.options.video = !options.no_video;

  KnownWorld world{readVehicle(story.vehicle),
                   readPanelMaps(story.map),
                   readEnvironment(shippedFile(options.water)),
                   {},
                   story.sea_floor};
  if (!world.vehicle.camera) throw Error(story.vehicle, "camera", "the vehicle has none");
  if (!options.calibration.empty()) world.effects = readCalibration(options.calibration);
  story.options.detection = settingsFor(world.panels, backendNamed(options.backend));
  if (story.options.detection.families.empty()) throw Error(story.map, "markers", "there are none");
  const PairMeasurer known(options.sil.measures);  // complains of others before anything takes long

  const fs::path folder = options.folder;
  const PosedImages images =
      posedImages(options.recording, world.vehicle, world.panels, story.options.detection, world.effects);
  story.remarks = images.remarks;
  const PairMaker maker(world, story.options.pairs, story.options.detection);
  const SilTarget target = targetOf(story, folder);
  story.results = runSil(images, maker, story.options, target);
  story.sheet = silSheet(story.results, maker, story.options, target);
  writeOutputs(story, folder);

  for (const std::string& remark : story.remarks) std::cout << remark << "\n";
  std::cout << story.results.pairs.size() << " pairs";
  if (story.results.taken_over > 0)
    std::cout << ", " << story.results.taken_over << " of them from an earlier run";
  std::cout << "\n\n" << formatTable(measureTable(story));
  if (!story.results.unpaired.empty())
    std::cout << "\n"
              << story.results.unpaired.size() << " images are not paired\n\n"
              << formatTable(unpairedTable(story));
  std::cout << "\nreport: " << (folder / "report.html").string()
            << "\npairs: " << (folder / (target.name + "_pairs.rawlog")).string()
            << "\nimages: " << (folder / "contact_sheet.png").string() << "\n";
}

constexpr const char* kSilHelp =
    "Simulation in the loop: for every image, markers -> panel's pose -> robot's pose -> render from there\n"
    "through the given water -> pair of recorded and simulated image -> measures.\n"
    "\n"
    "Writes NAME_pairs.rawlog (CAMERA: recorded, SIMULATED: simulated, MARKERS: the robot's pose), with\n"
    "NAME_pairs_Images (recorded images copied, simulated ones, and masks of the panel), NAME_pairs_panel "
    "and\n"
    "NAME_pairs_vehicle.yaml; measures.csv, unpaired.csv, contact_sheet.png, NAME_pairs.avi, result.json,\n"
    "report.html; with --frames, NAME_frames. Interrupted and started again, the same command goes on; what\n"
    "an earlier run of the same inputs has made is taken over.\n"
    "\n"
    "A recording made by `fathom simulate` says where its sea floor is (NAME_simulation.json); else, and\n"
    "without --sea-floor-z, only the panels are rendered, and only they are compared.\n"
    "\n"
    "Measures:\n";

constexpr const char* kSilExamples =
    "\n"
    "Examples:\n"
    "  fathom sil rawlogs/trial/trial.rawlog --water config/water_turbid.yaml --out out/sil\n"
    "  fathom sil rawlogs/trial/trial.rawlog --measure fsim,fsimc --every 10 --frames --out out/sil";

}  // namespace

void addSil(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "sil", "Render every image of a recording from where it was taken, and compare the two");
  std::string measures;
  for (const RegisteredMeasure& measure : kMeasures)
    measures += "  " + std::string(measure.id) + ": " + std::string(measure.about) + "\n";
  command->footer(kSilHelp + measures + kSilExamples);
  const auto options = std::make_shared<SilCommandOptions>();
  SilOptions& sil_options = options->sil;
  command->add_option("RECORDING", options->recording, "The recording, with images")
      ->required()
      ->type_name(values::kRawlog);
  command->add_option("--out", options->folder, "Where results go")->required()->type_name(values::kFolder);
  command->add_option("--water", options->water, "Water and light to simulate with")
      ->type_name(values::kYaml)
      ->capture_default_str();
  command
      ->add_option("--calibration", options->calibration, "Effects to switch on, as the recording had them")
      ->type_name(values::kYaml);
  command->add_option("--vehicle", options->vehicle, "Vehicle file (default: the one the recording names)")
      ->type_name(values::kYaml);
  command->add_option("--map", options->map, "Panel map (default: the one the recording names)")
      ->type_name(values::kYaml);
  command->add_option("--measure", sil_options.measures, "Measures, separated by commas (default: all)")
      ->delimiter(',')
      ->expected(1)
      ->allow_extra_args(false)
      ->take_all();
  command->add_option("--every", sil_options.every, "Only every so many-th image")
      ->check(CLI::Range(std::size_t{1}, std::size_t{1} << 30))
      ->type_name("N")
      ->capture_default_str();
  command->add_option("--seed", sil_options.pairs.seed, "Of the simulated images' noise")
      ->capture_default_str();
  command->add_flag("--no-noise", options->no_noise, "No sensor noise in the simulated images");
  auto* floor =
      command->add_option("--sea-floor-z", options->sea_floor_z_m,
                          "Height of a flat sea floor in odom, m (default: as the recording was made)");
  command->add_option("--sand-seed", options->sand_seed, "Of its sand")->needs(floor)->capture_default_str();
  command->add_option("--backend", options->backend, "Which library finds the markers")
      ->check(CLI::IsMember(backendNames()))
      ->capture_default_str();
  command
      ->add_option("--residual-scale", sil_options.residual.full_scale,
                   "Difference of light, of full scale, that is shown in full colour")
      ->check(CLI::Range(1e-4, 1.0))
      ->capture_default_str();
  command->add_flag("--frames", sil_options.frames, "Write each pair as a picture too");
  command->add_flag("--no-video", options->no_video, "Write no video");
  command->callback([options, &context] { sil(*options, context); });
}

}  // namespace fathom
