#include <iostream>
#include <memory>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "core/text.h"
#include "panel/panel_maps.h"
#include "recording/export_csv.h"
#include "recording/export_kml.h"
#include "recording/rawlog.h"
#include "recording/recorded_path.h"
#include "sil/export_colmap.h"
#include "tasks/companions.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct ExportOptions {
  std::string from, label, out, map;
  double latitude_deg = 0, longitude_deg = 0, height_m = 0, x_heading_deg = 90, spacing_s = 1;
};

/// "50 entries (LABEL, class), …"
std::string leftOutText(const CsvExport& tables) {
  std::string text;
  for (const auto& [what, count] : tables.left_out)
    text += (text.empty() ? "" : ", ") + std::to_string(count) + (count == 1 ? " entry (" : " entries (") +
            what + ")";
  return text;
}

void exportTables(const ExportOptions& options) {
  const CsvExport tables = [&] {
    Progress progress("exporting");
    return exportCsv(options.from, options.out, [&](double share) { progress.update(share); });
  }();
  if (tables.files.empty())
    throw Error(options.from, "",
                "holds nothing that becomes a table" +
                    (tables.left_out.empty() ? "" : ", only " + leftOutText(tables)) +
                    (tables.loss ? "; " + describe(*tables.loss) : ""));
  if (!tables.left_out.empty()) std::cout << "no table of " << leftOutText(tables) << "\n";
  if (tables.loss) std::cout << "the recording is damaged: " << describe(*tables.loss) << "\n";
  for (const auto& file : tables.files) std::cout << "wrote " << file.string() << "\n";
}

/// What cannot stand in a path is left out, and said.
std::vector<StampedPose> pathToExport(const ExportOptions& options) {
  RecordedPath path = recordedPath(options.from, options.label);
  if (path.left_out > 0)
    std::cout << "left out " << path.left_out << " of " << path.left_out + path.poses.size()
              << " poses: not finite, without a time, or not later than one before\n";
  return std::move(path.poses);
}

void exportTum(const ExportOptions& options) {
  const std::vector<StampedPose> path = pathToExport(options);
  writeTum(options.out, path);
  std::cout << "wrote " << path.size() << " poses to " << options.out << "\n";
}

void exportKml(const ExportOptions& options) {
  const GeoReference reference{radians(options.latitude_deg), radians(options.longitude_deg),
                               options.height_m, radians(options.x_heading_deg)};
  const std::vector<StampedPose> path = pathToExport(options);
  if (const auto why = whyOnNoMap(path, reference)) throw Error(options.from, "", *why);
  writeTextFile(options.out,
                formatKml(path, reference, options.spacing_s, fs::path(options.from).stem().string()));
  std::cout << "wrote " << options.out << "\n";
}

void exportImagePoses(const ExportOptions& options) {
  const RecordingHeader header = RawlogReader(options.from).header();
  const fs::path map = neededPanelMapFile(options.map, options.from, header);
  const auto vehicle = vehicleFile("", options.from, header);
  const std::vector<PanelMap> panels = readPanelMaps(map);
  const DetectionSettings detection = settingsFor(panels);
  if (detection.families.empty()) throw Error(map.string(), "markers", "there are none");
  const PosedImages images =
      posedImages(options.from, vehicle ? readVehicle(*vehicle) : Vehicle(), panels, detection);
  for (const std::string& remark : images.remarks) std::cout << remark << "\n";
  if (images.posed.empty()) throw Error(options.from, "", "no image shows where the panel is");
  std::cout << "wrote " << exportColmap(images, panels, options.out) << " images to " << options.out << "; "
            << images.unposed.size() << " do not show where they were taken\n";
}

void addLabel(CLI::App& command, ExportOptions& options) {
  command.add_option("--label", options.label, "Of the poses: TRUTH, EKF_TL2, … (default: the only one)");
}

void addCsv(CLI::App& parent) {
  auto* command = parent.add_subcommand("csv", "A recording's entries as tables, one a sensor");
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("RECORDING", options->from, "The recording")->required()->type_name(values::kRawlog);
  command->add_option("--out", options->out, "Where the tables go")->required()->type_name(values::kFolder);
  command->callback([options] { exportTables(*options); });
}

void addTum(CLI::App& parent) {
  auto* command = parent.add_subcommand("tum", "A path as TUM text, for `evo` and its kin");
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("RECORDING", options->from, "The recording")->required()->type_name(values::kRawlog);
  addLabel(*command, *options);
  command->add_option("--out", options->out, "The text")->required()->type_name(values::kTum);
  command->callback([options] { exportTum(*options); });
}

void addKml(CLI::App& parent) {
  auto* command = parent.add_subcommand("kml", "A path on the map, for Google Earth and its kin");
  command->footer(
      "odom is put on the Earth by where its origin is and where its x axis points. Heights are over the "
      "sea;\n"
      "a dive's are negative.");
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("FILE", options->from, "A recording, or a path as TUM text")
      ->required()
      ->type_name("FILE.{rawlog,tum}");
  addLabel(*command, *options);
  command->add_option("--latitude", options->latitude_deg, "Of odom's origin, degrees, WGS 84")
      ->required()
      ->check(CLI::Range(-90.0, 90.0));
  command->add_option("--longitude", options->longitude_deg, "Likewise, east is positive")
      ->required()
      ->check(CLI::Range(-180.0, 180.0));
  command->add_option("--height", options->height_m, "Of odom's origin over the sea, m")
      ->check(CLI::Range(kLowestHeight_m, kHighestHeight_m))
      ->capture_default_str();
  command
      ->add_option("--x-heading", options->x_heading_deg,
                   "Where odom's x axis points, degrees from north by east")
      ->capture_default_str();
  command->add_option("--spacing", options->spacing_s, "Between poses at least, s")
      ->check(notNegative())
      ->capture_default_str();
  command->add_option("--out", options->out, "The map")->required()->type_name("FILE.kml");
  command->callback([options] { exportKml(*options); });
}

void addColmap(CLI::App& parent) {
  auto* command =
      parent.add_subcommand("colmap", "Where images were taken, by their markers, as COLMAP's text model");
  command->footer(
      "cameras.txt, images.txt and points3D.txt (the markers' corners). For reconstructions that are to\n"
      "begin with known poses, and for radiance fields.");
  const auto options = std::make_shared<ExportOptions>();
  command->add_option("RECORDING", options->from, "The recording, with images")
      ->required()
      ->type_name(values::kRawlog);
  command->add_option("--map", options->map, "Panel map; without it, the recording's own")
      ->type_name(values::kYaml);
  command->add_option("--out", options->out, "Where the model goes")->required()->type_name(values::kFolder);
  command->callback([options] { exportImagePoses(*options); });
}

}  // namespace

void addExport(const RunContext& context) {
  auto* command = context.root->add_subcommand("export", "Write a recording, or a path, in another format");
  command->footer(
      "Examples:\n"
      "  fathom export csv rawlogs/dive/dive.rawlog --out out/tables\n"
      "  fathom export tum rawlogs/dive/dive.rawlog --label TRUTH --out out/truth.tum\n"
      "  fathom export kml out/truth.tum --latitude 43.2 --longitude 5.1 --out out/dive.kml\n"
      "  fathom export colmap rawlogs/trial/trial.rawlog --out out/colmap");
  command->require_subcommand(1);
  addCsv(*command);
  addTum(*command);
  addKml(*command);
  addColmap(*command);
}

}  // namespace fathom
