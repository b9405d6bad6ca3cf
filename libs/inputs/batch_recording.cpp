#include "inputs/batch_recording.h"

#include <memory>

#include "core/files.h"
#include "core/fingerprint.h"
#include "core/text.h"
#include "effects/catalogue.h"
#include "environment/water_fit.h"
#include "image_files/jpeg.h"
#include "landmarks/given_corners.h"
#include "landmarks/tie_points.h"
#include "observables/image_patches.h"
#include "panel/panel_maps.h"
#include "recording/tum.h"
#include "tasks/companions.h"
#include "tasks/start_pose.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// The table of corners beside a recording, where there is one.
std::optional<fs::path> givenCornersOf(const fs::path& rawlog) {
  const fs::path file = cornersBeside(rawlog);
  return isThere(file) ? std::optional(file) : std::nullopt;
}

/// Remarks: also what of the recording is lost, now that it was read to its end.
FoundMarkers findMarkers(const fs::path& rawlog, const Vehicle& vehicle, const std::vector<PanelMap>& panels,
                         std::vector<std::string>& remarks) {
  RecordingSource source(rawlog);
  FoundMarkers found{imageEntries(source, vehicle), {}};
  if (source.loss()) remarks.push_back("The recording is damaged: " + describe(*source.loss()));
  if (panels.empty()) return found;
  Detections& detections = found.detections;
  if (const auto given = givenCornersOf(rawlog)) {
    remarks.push_back("Corners are those of " + given->filename().string() + ": images are not searched.");
    detections = readGivenCorners(*given, source.imageFolder());
    return found;
  }
  detections =
      detectImages(imagesOf(found.entries), settingsFor(panels, Backend::apriltag), keepBeside(rawlog));
  if (!detections.not_kept_why.empty())
    remarks.push_back("detections are not kept: " + detections.not_kept_why);
  for (const UnreadableImage& image : detections.unreadable)
    remarks.push_back(image.file.string() + ": " + image.why);
  return found;
}

/// Points that both eyes of a pair see, where a table beside the recording has them.
TiePoints tiePointsOf(const fs::path& rawlog, std::vector<std::string>& remarks) {
  const fs::path file = tiePointsBeside(rawlog);
  if (!isThere(file)) return {};
  remarks.push_back("Tie points are those of " + file.filename().string() + ".");
  return readTiePoints(file);
}

/// The images where they show panels, reduced to patches.
void addPatches(const EffectParameters<double>& effects, const BatchRecordingOptions& options,
                BatchRecording& recording) {
  const FoundMarkers& found = recording.found;
  BatchData& data = recording.input.data;
  const std::vector<PanelMap>& panels = data.panels;
  if (!data.vehicle.camera || data.markers.empty()) return;
  const LandmarkCalibration calibration{effects, data.time_zero};
  const Sightings sightings = solveSightings(found.entries, found.detections, panels, calibration);
  PosedImages images = posedImages(found.entries, found.detections, sightings, panels, calibration);
  if (images.posed.empty()) return;
  if (const auto quality = jpegQuality(images.posed.front().image.file)) {
    // Its blocks err alike, by several times the noise of a patch.
    recording.remarks.push_back(
        print("images are JPEG of quality %d: their pixels are not compared", *quality));
    return;
  }
  if (const std::size_t all = keepSpread(images.posed, options.most_lit); all > options.most_lit)
    recording.remarks.push_back(print(
        "light is compared in %zu images of %zu, spread evenly (--light-images)", options.most_lit, all));
  const CleanPairMaker maker({data.vehicle, panels, {}, effects, {}});
  ImagePatches patches = imagePatches(images.posed, maker, data.time_zero, startWater, options.open_water);
  if (!patches.rejected.empty())
    recording.remarks.push_back(print("pixels of %zu images are not compared; %s: %s",
                                      patches.rejected.size(), patches.rejected[0].file.filename().c_str(),
                                      patches.rejected[0].why.c_str()));
  data.patches = std::move(patches.patches);
  data.blurs = std::move(patches.blurs);
  data.specks = std::move(patches.specks);
  data.textures = std::move(patches.textures);
  data.water = patches.start;
}

std::vector<InputFile> filesOf(const BatchRecordingOptions& options, const BatchRecording& recording) {
  std::vector<InputFile> files{inputFile(options.rawlog), inputFile(recording.vehicle)};
  if (const auto given = givenCornersOf(options.rawlog)) files.push_back(inputFile(*given));
  if (const fs::path points = tiePointsBeside(options.rawlog); isThere(points))
    files.push_back(inputFile(points));
  if (recording.map)
    for (const fs::path& map : panelMapFiles(*recording.map)) files.push_back(inputFile(map));
  return files;
}

}  // namespace

InputFile inputFile(const fs::path& file) { return {file, Fingerprint().add(readTextFile(file)).hex()}; }

BatchRecording readBatchRecording(const BatchRecordingOptions& options,
                                  const EffectParameters<double>& calibration) {
  const RecordingHeader header = RawlogReader(options.rawlog).header();
  BatchRecording recording;
  recording.calibration = calibration;
  recording.vehicle = neededVehicleFile(options.vehicle, options.rawlog, header);
  recording.map = panelMapFile(options.map, options.rawlog, header);
  recording.files = filesOf(options, recording);
  const std::vector<PanelMap> panels =
      recording.map ? readPanelMaps(*recording.map) : std::vector<PanelMap>{};
  const Vehicle vehicle = readVehicle(recording.vehicle);
  requireInstances(calibration, vehicle, "the calibration");
  const auto open = [&] {
    return corrected(std::make_unique<RecordingSource>(options.rawlog), options.audit, vehicle);
  };
  Plausibility plausibility = requirePlausible(audit(*open(), vehicle), options.audit, options.rawlog);
  recording.remarks = std::move(plausibility.remarks);
  recording.accepted_faults = std::move(plausibility.accepted);
  const auto start = startPose(options.start, options.rawlog, {});
  recording.found = findMarkers(options.rawlog, vehicle, panels, recording.remarks);
  BatchDataOptions beside;
  beside.tie_points = tiePointsOf(options.rawlog, recording.remarks);
  recording.input = batchInput(open, recording.found.detections, vehicle, panels, calibration, start, beside);
  if (options.pixels && !givenCornersOf(options.rawlog)) addPatches(calibration, options, recording);
  return recording;
}

void writePath(const fs::path& file, const BatchData& data, const BatchEstimate& estimate) {
  std::vector<StampedPose> poses;
  for (const PathPose& pose : estimate.path)
    poses.push_back({after(data.time_zero, pose.t_s), pose.T_odom_robot.pose});
  writeTum(file, poses);
}

std::string nameOfScalar(const EffectEstimate& estimate) {
  const EffectInfo& effect = allEffects()[estimate.effect];
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& p : effect.parameters)
    for (int i = 0; i < p.size; ++i, ++scalar)
      if (scalar == estimate.scalar)
        return std::string(p.name) + (p.size > 1 ? print("[%d]", i) : std::string());
  return {};
}

}  // namespace fathom
