#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "audit/audit.h"
#include "commands.h"
#include "core/error.h"
#include "core/progress.h"
#include "core/text.h"
#include "recording/recording_info.h"
#include "report/run_info.h"
#include "tasks/companions.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct InfoOptions {
  std::string rawlog, vehicle;
  bool json = false;
};

RecordingInfo inspect(const std::string& rawlog) {
  Progress progress("reading");
  return inspectRecording(rawlog, {}, [&](double share) { progress.update(share); });
}

/// The vehicle file to compare with, or why the one that the recording names is none: other commands refuse
/// such a recording, and this is the command to find out what one has.
struct ComparedFile {
  std::optional<fs::path> file;
  std::string missing;
};
ComparedFile comparedFile(const InfoOptions& options, const RecordingHeader& header) {
  try {
    return {vehicleFile(options.vehicle, options.rawlog, header), ""};
  } catch (const Error& missing) {
    return {std::nullopt, missing.where + " " + missing.why + ": compared with defaults"};
  }
}

void info(const InfoOptions& options) {
  const RecordingInfo recording = inspect(options.rawlog);
  const auto [vehicle_file, missing] = comparedFile(options, recording.header);
  const auto differences =
      vehicle_file ? disagreements(recording, readVehicle(*vehicle_file)) : std::vector<std::string>{};

  RecordingSource source(options.rawlog);
  const std::vector<Finding> findings = audit(source, vehicle_file ? readVehicle(*vehicle_file) : Vehicle{});

  if (options.json) {
    nlohmann::json json = toJson(recording);
    json["compared_with"] = vehicle_file ? nlohmann::json(vehicle_file->string()) : nlohmann::json(nullptr);
    json["disagreements"] = differences;
    if (!missing.empty()) json["remarks"].push_back(missing);
    json["findings"] = nlohmann::json::array();
    for (const Finding& f : findings)
      json["findings"].push_back({{"name", f.name},
                                  {"label", f.label},
                                  {"sure", f.certainty == Finding::Certainty::sure},
                                  {"what", f.what},
                                  {"corrected", f.corrected},
                                  {"correction", f.correction}});
    std::cout << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << "\n";
    return;
  }
  std::cout << describe(recording);
  if (!missing.empty()) std::cout << "  ! " << printable(missing) << "\n";
  if (vehicle_file)
    std::cout << "compared with " << vehicle_file->string() << ":\n"
              << (differences.empty() ? "  mountings and intrinsics agree\n" : "");
  for (const auto& line : differences) std::cout << "  ! " << line << "\n";
  std::cout << "compared with physics and with each other:\n"
            << (findings.empty() ? "  the streams agree\n" : "");
  for (const Finding& f : findings) std::cout << "  ! " << toText(f) << "\n";
}

}  // namespace

void addInfo(const RunContext& context) {
  auto* command =
      context.root->add_subcommand("info", "Tell what is in a recording, and what is wrong with it");
  command->footer(
      "Tells of each sensor its rate, gaps, jitter, mounting and intrinsics; of the whole its duration, "
      "order\n"
      "in time and damage. With a vehicle file, tells where that and the recording disagree; the "
      "recording's\n"
      "values are the nominal ones. Streams are compared with physics and with each other (units, signs, "
      "axes,\n"
      "clocks, images): what is sure must be corrected or accepted by name (--correct, --accept) before "
      "other\n"
      "commands believe the recording; what is likely is a warning.\n"
      "\n"
      "Examples:\n"
      "  fathom info rawlogs/dive/dive.rawlog\n"
      "  fathom info dive.rawlog --json | jq .labels");
  const auto options = std::make_shared<InfoOptions>();
  command->add_option("RECORDING", options->rawlog, "The recording")->required()->type_name(values::kRawlog);
  command
      ->add_option("--vehicle", options->vehicle,
                   "Vehicle file to compare with (default: the one that the recording names)")
      ->type_name(values::kYaml);
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options] { info(*options); });
}

}  // namespace fathom
