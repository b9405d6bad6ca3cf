#include <iostream>
#include <memory>

#include "commands.h"
#include "core/error.h"
#include "effects/calibration.h"
#include "report/run_info.h"
#include "report/table.h"
#include "simulation/read_trajectory.h"
#include "simulation/simulate_recording.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct SimulateOptions {
  std::string trajectory, vehicle, calibration, map, folder, name;
  std::vector<std::string> without;
  bool no_noise = false;
  SimulationOptions simulation;
};

void leaveOut(const std::vector<std::string>& sensors, Vehicle& vehicle) {
  for (const auto& sensor : sensors) {
    if (sensor == "ins") vehicle.ins.reset();
    if (sensor == "dvl") vehicle.dvl.reset();
    if (sensor == "depth") vehicle.depth.reset();
    if (sensor == "usbl") vehicle.usbl.reset();
  }
}

void simulate(SimulateOptions options, const RunContext& context) {
  SimulationOptions& simulation = options.simulation;
  simulation.vehicle = readVehicle(options.vehicle);
  leaveOut(options.without, simulation.vehicle);
  if (!options.calibration.empty()) simulation.effects = readCalibration(options.calibration);
  simulation.noise = !options.no_noise;
  const Trajectory trajectory = readTrajectory(options.trajectory);

  const std::string name = options.name.empty() ? fs::path(options.trajectory).stem().string() : options.name;
  const std::string map =
      options.map.empty() ? "" : fs::relative(options.map, options.folder).generic_string();
  const RecordingTarget target{options.folder, name, options.vehicle, map, "simulated by fathom"};
  const RecordingFiles files = simulateRecording(simulation, trajectory, target);

  const double duration_s = simulatedDuration_s(simulation, trajectory);
  nlohmann::ordered_json json;
  json["run"] = toJson(RunInfo{.command_line = context.command_line, .seed = simulation.seed});
  json["rawlog"] = files.rawlog.filename().string();
  json["vehicle"] = files.vehicle.filename().string();
  json["truth"] = files.truth.filename().string();
  json["duration_s"] = duration_s;
  json["sea_floor_z_m"] = simulation.sea_floor_z_m;
  json["noise"] = simulation.noise;
  json["calibration"] = formatCalibration(simulation.effects);
  const fs::path summary = fs::path(options.folder) / (name + "_simulation.json");
  writeJson(summary, json);
  std::cout << "simulated " << fixed(duration_s, 1) << " s with seed " << simulation.seed << "\n";
  for (const auto& file : {files.rawlog, files.vehicle, files.truth, summary})
    std::cout << "wrote " << file.string() << "\n";
}

}  // namespace

void addSimulate(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "simulate", "Make the recording that a vehicle on a given path would bring home");
  command->footer(
      "Runs the sensors' forward model along the path and adds the vehicle file's noise. Effects that the\n"
      "nominal model leaves out (a wrong sound speed, a misaligned DVL, ...) are switched on by a "
      "calibration\n"
      "file. Writes NAME.rawlog, NAME_vehicle.yaml, NAME_truth.tum and NAME_simulation.json. The same seed\n"
      "gives the same bytes.\n"
      "\n"
      "Examples:\n"
      "  fathom simulate --trajectory config/dive_trajectory.yaml --vehicle config/rov.yaml --out out/sim\n"
      "  fathom simulate --trajectory truth.tum --vehicle rov.yaml --calibration cal.yaml --seed 7 --out "
      "out/sim");
  const auto options = std::make_shared<SimulateOptions>();
  SimulationOptions& simulation = options->simulation;
  command->add_option("--trajectory", options->trajectory, "The path: waypoints (.yaml) or poses (TUM text)")
      ->required()
      ->type_name(values::kFile);
  command->add_option("--vehicle", options->vehicle, "Which sensors there are, how good, and where")
      ->required()
      ->type_name(values::kYaml);
  command->add_option("--out", options->folder, "Where the recording goes")
      ->required()
      ->type_name(values::kFolder);
  command->add_option("--name", options->name, "NAME of the files (default: the trajectory's)");
  command->add_option("--seed", simulation.seed, "Of all randomness")->capture_default_str();
  command->add_option("--calibration", options->calibration, "Effects to switch on")
      ->type_name(values::kYaml);
  command->add_option("--map", options->map, "Panel map that the recording is to name")
      ->type_name(values::kYaml);
  command->add_option("--sea-floor-z", simulation.sea_floor_z_m, "Height of the flat sea floor in odom, m")
      ->capture_default_str();
  command->add_option("--begin", simulation.begin_s, "Where on the trajectory to begin, s")
      ->capture_default_str();
  command->add_option("--duration", simulation.duration_s, "How long, s (default: to the end)");
  command->add_option("--without", options->without, "A sensor to leave out; may be repeated")
      ->check(CLI::IsMember({"ins", "dvl", "depth", "usbl"}))
      ->expected(1)
      ->take_all();
  command->add_flag("--no-noise", options->no_noise, "No white noise, no random biases");
  command->callback([options, &context] { simulate(*options, context); });
}

}  // namespace fathom
