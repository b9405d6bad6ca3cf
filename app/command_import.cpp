#include <iostream>
#include <memory>

#include "audit/audit.h"
#include "camera_tables/camera_alone.h"
#include "commands.h"
#include "common_options.h"
#include "core/files.h"
#include "imaging/camera_files.h"
#include "import_corners.h"
#include "import_target.h"
#include "import_tie_points.h"
#include "import_video.h"
#include "import_writer.h"
#include "ros_bag/import_bag.h"
#include "sea_trial/import_sea_trial.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct CsvOptions {
  std::string folder;
  int section = 0;
  SeaTrialOptions trial;
  std::vector<std::string> correct;
  ImportTarget target;
};

void importCsv(CsvOptions options, const RunContext& context) {
  if (options.target.name.empty()) options.target.name = "section" + std::to_string(options.section);
  options.trial.corrections = correctionsNamed(options.correct);
  const ImportedRecording imported =
      importSeaTrial(seaTrialFiles(options.folder, options.section), options.trial);
  ImportWriter writer(options.target, imported.header, {}, {});
  for (const Sample& sample : imported.samples) writer.write(sample);
  writer.finish(imported, context);
}

void addCsv(CLI::App& parent, const RunContext& context) {
  auto* command =
      parent.add_subcommand("csv", "From the tables of a sea trial (IMU, DVL and its navigation solution)");
  command->footer(
      "Reads IMU_trajectoryN.csv, DVL_trajectoryN.csv and GT_trajectoryN.csv (or .csv.gz). What the tables "
      "do\n"
      "not say (axes, signs, units, clocks) is found out by comparing them with each other; what was "
      "concluded,\n"
      "and how sure, is printed and stands in NAME_import.json.\n"
      "\n"
      "Examples:\n"
      "  fathom import csv tables --section 1 --out out/trial\n"
      "  fathom info out/trial/section1.rawlog");
  const auto options = std::make_shared<CsvOptions>();
  command->add_option("TABLES", options->folder, "The folder of the tables")
      ->required()
      ->type_name(values::kFolder);
  command->add_option("--section", options->section, "Which section, the N of the tables' names")->required();
  addImportTarget(*command, options->target, "sectionN");
  command->add_flag("--undo-stamp-stretch", options->trial.undo_stamp_stretch,
                    "Correct the stretch of the DVL's clock, where it is established");
  command->add_flag("--reference-as-published", options->trial.reference_as_published,
                    "Leave the reference on its own clock, at its own point, though both are established");
  addCorrect(*command, options->correct);
  command->callback([options, &context] { importCsv(*options, context); });
}

struct BagCommandOptions {
  std::string bag, topics;
  bool strict = false;
  std::vector<std::string> correct;
  ImportTarget target;
};

void importRosBag(BagCommandOptions options, const RunContext& context) {
  if (options.target.name.empty()) options.target.name = fs::path(options.bag).stem().string();
  const TopicMap map = readTopicMap(options.topics);
  Vehicle vehicle;
  vehicle.gravity_m_s2 = map.gravity_m_s2;
  ImportWriter writer(options.target, {"", "", map.description}, options.correct, vehicle);
  BagOptions bag_options;
  bag_options.image_folder = options.target.file("_Images");
  bag_options.strict = options.strict;
  const ImportedRecording imported = streamBag(
      options.bag, map, [&](Sample&& sample) { writer.write(std::move(sample)); }, bag_options);
  writer.finish(imported, context);
}

void addBag(CLI::App& parent, const RunContext& context) {
  auto* command = parent.add_subcommand("bag", "From a ROS 1 bag");
  command->footer(
      "TOPICS.yaml says which topic becomes what, and where each sensor sits; see config/husky_topics.yaml.\n"
      "A topic becomes one of these, from messages of these types:\n" +
      topicMapHelp() +
      "Keys of a topic: topic, as, pose; of INS use, orientation_of; of CAMERA intrinsics; of a REFERENCE "
      "from\n"
      "transforms frame, child_frame; `stamps: arrival` where the stamps in the messages' headers are of no "
      "use.\n"
      "\n"
      "Examples:\n"
      "  fathom import bag dive.bag --topics config/husky_topics.yaml --out out/dive\n"
      "  fathom info out/dive/dive.rawlog");
  const auto options = std::make_shared<BagCommandOptions>();
  command->add_option("BAG", options->bag, "The bag")->required()->type_name(values::kBag);
  command->add_option("--topics", options->topics, "Which topic becomes what")
      ->required()
      ->type_name(values::kYaml);
  command->add_flag("--strict", options->strict,
                    "Refuse the bag where a message cannot be used (default: leave it out, and say so)");
  addCorrect(*command, options->correct);
  addImportTarget(*command, options->target, "the bag's");
  command->callback([options, &context] { importRosBag(*options, context); });
}

struct CameraOptions {
  std::string file, camera, image_size;
  double rate_hz = 1, corner_sigma_px = 0.15;
  ImportTarget target;
};

void importCamera(CameraOptions options) {
  if (options.target.name.empty()) options.target.name = fs::path(options.file).stem().string();
  CameraFileOptions file_options{options.camera, {}};
  if (!options.image_size.empty())
    file_options.image_size_px = imageSizeOf("--image-size", options.image_size);
  const auto [camera, remarks] = readCameraFile(options.file, file_options);
  for (const std::string& remark : remarks) std::cout << "remark: " << remark << "\n";
  const std::string what = "camera of " + fs::path(options.file).filename().string();
  writeTextFile(options.target.file("_vehicle.yaml"),
                cameraAloneYaml(what, camera, options.rate_hz, options.corner_sigma_px));
  sayWritten(options.target, {"_vehicle.yaml"});
}

void addCamera(CLI::App& parent) {
  auto* command =
      parent.add_subcommand("camera", "A vehicle file's camera from a calibration: OpenCV, ROS, Kalibr");
  command->footer(
      "Reads the YAML that OpenCV's calibration, ROS's camera_info (its calibrator's, or as `topic echo` "
      "prints "
      "it)\n"
      "or Kalibr's camchain are written as, and writes\n"
      "NAME_vehicle.yaml with that camera alone: give it to --vehicle, or take its camera section into your "
      "own.\n"
      "Lenses: plumb bob, rational, fisheye (equidistant).\n"
      "Mounting, exposure and noise are not in such files: they are defaults there, to be corrected.\n"
      "\n"
      "Examples:\n"
      "  fathom import camera camera_info.yaml --out out/camera\n"
      "  fathom import camera camchain.yaml --camera cam1 --out out/camera");
  const auto options = std::make_shared<CameraOptions>();
  command->add_option("FILE", options->file, "The calibration")->required()->type_name(values::kYaml);
  command->add_option("--camera", options->camera,
                      "Which one of a file's several cameras (default: the only one, or cam0)");
  command->add_option("--image-size", options->image_size,
                      "WIDTHxHEIGHT in pixels, where the file does not say it, or says it wrongly");
  command->add_option("--rate-hz", options->rate_hz, "Images a second")
      ->check(positive())
      ->capture_default_str();
  command->add_option("--corner-sigma-px", options->corner_sigma_px, "Noise of a marker's corner, pixels")
      ->check(positive())
      ->capture_default_str();
  addImportTarget(*command, options->target, "the file's");
  command->callback([options] { importCamera(*options); });
}

}  // namespace

void addImport(const RunContext& context) {
  auto* command = context.root->add_subcommand("import", "Make a recording from another format");
  command->require_subcommand(1);
  command->footer(
      "Writes NAME.rawlog, NAME_vehicle.yaml, NAME_import.json and, where the source has a navigation "
      "solution\n"
      "of its own, NAME_reference.tum; that one never enters the recording.\n"
      "\n"
      "Examples:\n"
      "  fathom import csv tables --section 1 --out out/trial\n"
      "  fathom import bag dive.bag --topics config/husky_topics.yaml --out out/dive\n"
      "  fathom import corners corners.csv --camera camera.yaml --out out/tank\n"
      "  fathom import video dive.mp4 --stamps frames.csv --vehicle rov.yaml --out out/dive");
  addCsv(*command, context);
  addBag(*command, context);
  addImportCorners(*command, context);
  addImportTiePoints(*command, context);
  addImportVideo(*command, context);
  addCamera(*command);
}

}  // namespace fathom
