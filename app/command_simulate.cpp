#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/shipped_file.h"
#include "core/text.h"
#include "effects/calibration.h"
#include "imaging/camera_check.h"
#include "report/run_info.h"
#include "report/table.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct SimulateOptions {
  std::string trajectory, vehicle, calibration, map, water, folder, name;
  std::vector<std::string> without;
  std::string image_format = "png";
  bool no_noise = false;
  SimulationOptions simulation;
};

/// Sections of the vehicle file: "ins", "dvl", …
std::vector<std::string> sectionsOfSensors() {
  std::vector<std::string> sections;
  forEachInstrument([&]<class Instrument>() {
    if (std::find(sections.begin(), sections.end(), Instrument::section) == sections.end())
      sections.emplace_back(Instrument::section);
  });
  sections.emplace_back("camera");
  return sections;
}

/// One of them, or an instance of one: "dvl.2".
CLI::Validator sensorCheck() {
  const CLI::Validator kinds = CLI::IsMember(sectionsOfSensors());
  return {[kinds](std::string& name) {
            std::string kind(baseOf(name));
            return kinds(kind);
          },
          kinds.get_description()};
}

void leaveOut(const std::vector<std::string>& sensors, Vehicle& vehicle) {
  for (const auto& sensor : sensors) {
    const auto leaveOutOf = [&](const Instance& instance, SensorsOnBoard& on_board) {
      forEachInstrument([&]<class Instrument>() {
        if (sensor == instance.label(Instrument::section)) (on_board.*Instrument::on_board).reset();
      });
      if (sensor == instance.label("camera")) on_board.camera.reset();
    };
    const Instance instance = Instance::of(sensor);
    if (instance.isFirst()) {
      leaveOutOf(instance, vehicle);
      continue;
    }
    const auto other = vehicle.others.find(instance);
    if (other == vehicle.others.end()) throw Error("--without", sensor, "the vehicle has none");
    leaveOutOf(instance, other->second);
  }
}

/// Throws Error, where of a camera no image can be drawn.
void requireUnfolded(const SimulateOptions& options) {
  options.simulation.vehicle.forEachInstance([&](const Instance& instance, const SensorsOnBoard& on_board) {
    if (!on_board.camera) return;
    if (const auto fold = foldOf(on_board.camera->model))
      throw Error(
          options.vehicle, instance.label("camera") + ".distortion",
          print("turns back %.0f px from the principal point: %.0f %% of the pixels have no line of sight",
                fold->radius_px, 100 * fold->blind_share));
  });
}

/// Why there are no images, though something that is for images was given.
std::string lackingForImages(const SimulateOptions& options) {
  const bool camera = hasCamera(options.simulation.vehicle);
  if (options.water.empty() && options.map.empty() && !camera) return "";
  if (!camera) return "the vehicle has no camera";
  if (options.map.empty() && options.water.empty()) return "they need --map and --water";
  if (options.map.empty()) return "they need --map, what there is to see";
  return options.water.empty() ? "they need --water, e.g. config/water_clear.yaml" : "";
}

nlohmann::ordered_json toJson(const Environment& environment) {
  const auto colour = [](const Vector3d& c) { return nlohmann::ordered_json{c[0], c[1], c[2]}; };
  nlohmann::ordered_json json;
  json["attenuation_per_m"] = colour(environment.water.attenuation_per_m);
  json["veil"] = colour(environment.water.veil);
  json["ambient"] = colour(environment.ambient);
  if (environment.lamps_irradiance_1m) json["lamps_irradiance_1m"] = colour(*environment.lamps_irradiance_1m);
  return json;
}

void simulate(SimulateOptions options, const RunContext& context) {
  SimulationOptions& simulation = options.simulation;
  simulation.vehicle = readVehicle(options.vehicle);
  leaveOut(options.without, simulation.vehicle);
  if (!options.calibration.empty()) simulation.effects = readCalibration(options.calibration);
  requireInstances(simulation.effects, simulation.vehicle, options.calibration);
  simulation.noise = !options.no_noise;
  if (options.image_format == "jpg") simulation.image_format.kind = ImageFormat::Kind::jpeg;
  const auto& camera = simulation.vehicle.camera;
  if (camera && camera->pipeline == CameraPipeline::raw && options.image_format == "jpg")
    throw Error(options.vehicle, "camera.pipeline", "raw images are stored as PNG");
  const Trajectory trajectory = readTrajectory(shippedFile(options.trajectory));

  const std::string name = options.name.empty() ? fs::path(options.trajectory).stem().string() : options.name;
  RecordingTarget target{options.folder, name, options.vehicle, options.map, "simulated by fathom", {}};
  if (!options.water.empty()) target.environment = readEnvironment(options.water);
  if (lackingForImages(options).empty()) requireUnfolded(options);
  const RecordingFiles files = simulateRecording(simulation, trajectory, target);

  const double duration_s = simulatedDuration_s(simulation, trajectory);
  nlohmann::ordered_json json;
  json["run"] = toJson(RunInfo{.command_line = context.command_line, .seed = simulation.seed});
  json["rawlog"] = files.rawlog.filename().string();
  json["vehicle"] = files.vehicle.filename().string();
  json["truth"] = files.truth.filename().string();
  if (!files.panel_map.empty()) json["panel_map"] = fs::relative(files.panel_map, options.folder);
  if (!files.images.empty()) {
    json["images"] = files.images.filename().string();
    json["image_entries"] = files.image_entries;
    if (simulation.image_format.kind == ImageFormat::Kind::jpeg)
      json["jpeg_quality"] = simulation.image_format.jpeg_quality;
    json["environment"] = toJson(*target.environment);
  }
  json["duration_s"] = duration_s;
  json["sea_floor_z_m"] = simulation.sea_floor_z_m;
  json["noise"] = simulation.noise;
  json["calibration"] = formatCalibration(simulation.effects);
  const fs::path summary = fs::path(options.folder) / (name + "_simulation.json");
  writeJson(summary, json);
  std::cout << "simulated " << fixed(duration_s, 1) << " s with seed " << simulation.seed << "\n";
  for (const auto& file : {files.rawlog, files.vehicle, files.truth, files.panel_map, files.images, summary})
    if (!file.empty()) std::cout << "wrote " << file.string() << "\n";
  if (const std::string lacking = lackingForImages(options); !lacking.empty())
    std::cout << "no images: " << lacking << "\n";
}

constexpr const char* kSimulateHelp =
    "Runs the sensors' forward model along the path and adds the vehicle file's noise. Effects that the\n"
    "nominal model leaves out (a wrong sound speed, a misaligned DVL, ...) are switched on by a calibration\n"
    "file. Writes NAME.rawlog, NAME_vehicle.yaml, NAME_truth.tum and NAME_simulation.json. The same seed\n"
    "gives the same bytes.\n"
    "\n"
    "With --map and --water the vehicle's camera sees the panel on the sea floor through that water: "
    "NAME_Images\n"
    "and NAME_panel too. Interrupted and started again, the same command keeps the images it has made.\n"
    "\n"
    "Examples:\n"
    "  fathom simulate --trajectory config/dive_trajectory.yaml --vehicle config/rov.yaml --out out/sim\n"
    "  fathom simulate --trajectory config/trajectory_survey.yaml --vehicle config/rov.yaml\n"
    "      --map maps/dexrov/panel.yaml --water config/water_turbid.yaml --out out/survey\n"
    "  fathom simulate --trajectory truth.tum --vehicle rov.yaml --calibration cal.yaml --seed 7 --out "
    "out/sim";

}  // namespace

void addSimulate(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "simulate", "Make the recording that a vehicle on a given path would bring home");
  command->footer(kSimulateHelp);
  const auto options = std::make_shared<SimulateOptions>();
  SimulationOptions& simulation = options->simulation;
  command
      ->add_option(
          "--trajectory", options->trajectory,
          "The path: waypoints, a station or a survey (.yaml), or poses (TUM text, a rawlog's truth)")
      ->required()
      ->type_name(values::kFile);
  command->add_option("--vehicle", options->vehicle, "Which sensors there are, how good, and where")
      ->required()
      ->type_name(values::kYaml);
  command->add_option("--out", options->folder, "Where the recording goes")
      ->required()
      ->type_name(values::kFolder);
  addNameOption(*command, options->name, "the trajectory's");
  command->add_option("--seed", simulation.seed, "Of all randomness")->capture_default_str();
  command->add_option("--calibration", options->calibration, "Effects to switch on")
      ->type_name(values::kYaml);
  command
      ->add_option("--map", options->map, "Panel on the sea floor, or a list of panels; copied to NAME_panel")
      ->type_name(values::kYaml);
  command->add_option("--water", options->water, "Water and light that the camera sees through")
      ->type_name(values::kYaml);
  command->add_option("--image-format", options->image_format, "Of the images: exact, or small")
      ->check(CLI::IsMember({"png", "jpg"}))
      ->capture_default_str();
  command->add_option("--jpeg-quality", simulation.image_format.jpeg_quality, "1 to 100")
      ->check(CLI::Range(1, 100))
      ->type_name("QUALITY")
      ->capture_default_str();
  command->add_option("--sea-floor-z", simulation.sea_floor_z_m, "Height of the flat sea floor in odom, m")
      ->capture_default_str();
  command->add_option("--begin", simulation.begin_s, "Where on the trajectory to begin, s")
      ->capture_default_str();
  command->add_option("--duration", simulation.duration_s, "How long, s (default: to the end)");
  command
      ->add_option("--without", options->without,
                   "A sensor to leave out, or one of several (dvl.2); may be repeated")
      ->check(sensorCheck())
      ->expected(1)
      ->take_all();
  command->add_flag("--no-noise", options->no_noise, "No white noise, no random biases");
  command->callback([options, &context] { simulate(*options, context); });
}

}  // namespace fathom
