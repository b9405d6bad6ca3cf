#include <iostream>
#include <memory>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/files.h"
#include "core/text.h"
#include "diagnosis/constants.h"
#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "inputs/batch_recording.h"
#include "reports/smooth_report.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct SmoothOptions {
  BatchRecordingOptions recording;
  std::string calibration;
  std::vector<std::string> estimate;
  bool noise_from_data = false;
  std::uint64_t seed = 1;
};

/// Which effects are on, and which of them are estimated.
void readEffects(const SmoothOptions& options, BatchOptions& batch) {
  if (!options.calibration.empty()) batch.calibration = readCalibration(options.calibration);
  for (const std::string& named : options.estimate) {
    const std::string id(baseOf(named));
    const EffectInfo* effect = findEffect(id);
    if (effect == nullptr) throw Error("--estimate", id, "no such effect (known: " + knownEffects() + ")");
    if (const auto instance = Instance::of(named, id); instance && !instance->isFirst()) {
      if (!effect->is_of_instrument)
        throw Error("--estimate", named, "is of the world, not of an instrument");
      batch.calibration.only[effect->index] = *instance;
    }
    for (const Parameter& p : effect->parameters)
      if (p.kind != ParameterKind::continuous && p.kind != ParameterKind::shape &&
          !batch.calibration.on[effect->index])
        throw Error("--estimate", id,
                    "its " + std::string(p.name) + " is not estimated: name it in the --calibration file");
    batch.calibration.on.set(effect->index);
    batch.problem.estimate.set(effect->index);
  }
}

/// Channels of which more is left than their noise: what the recording contradicts.
std::vector<std::string> contradictions(const BatchEstimate& estimate) {
  std::vector<std::string> all;
  for (const auto& [channel, r] : estimate.residuals)
    if (channel != kChannel<Prior> && r.rows >= kFewestRows && r.rms > kNoisier * r.expected_rms)
      all.push_back(
          print("of %s %.3g times the noise is left: something is missing (`fathom diagnose`), or "
                "there is a better minimum elsewhere (--calibration says where to start)",
                std::string(nameOf(channel)).c_str(), r.rms / r.expected_rms));
  return all;
}

void smooth(const SmoothOptions& options, const RunContext& context) {
  SmoothedRecording recording;
  recording.run.command_line = context.command_line;
  recording.recording = options.recording.rawlog;
  BatchOptions batch;
  readEffects(options, batch);
  BatchRecording read = readBatchRecording(options.recording, batch.calibration);
  recording.input = std::move(read.input);
  recording.remarks = std::move(read.remarks);
  recording.estimate = estimateBatch(recording.input.data, recording.input.start, batch);
  if (!recording.estimate.succeeded)
    throw Error(recording.recording.string(), "", recording.estimate.failure);
  if (options.noise_from_data)
    recording.estimate = adaptNoise(recording.input.data, std::move(recording.estimate), batch);
  recording.noise_scale = batch.problem.noise_scale;
  for (std::string& one : contradictions(recording.estimate)) recording.remarks.push_back(std::move(one));
  recording.linear =
      linearize(recording.input.data, *problemAt(recording.input.data, recording.estimate, batch), false);

  writePath(options.recording.folder / "trajectory.tum", recording.input.data, recording.estimate);
  writeTextFile(options.recording.folder / "calibration.yaml",
                formatCalibration(recording.estimate.state.effects));
  writeSmoothReport(recording, options.recording.folder);
  const BatchEstimate& e = recording.estimate;
  std::cout << print("%zu poses from %zu rows in %d steps", e.path.size(), e.rows, e.iterations) << "\n";
  for (const auto& [channel, r] : e.residuals)
    if (channel != kChannel<Prior>)
      std::cout << print("  %-14s %6zu rows, rms %.3f sigma, expected %.3f\n", nameOf(channel).c_str(),
                         r.rows, r.rms, r.expected_rms);
  for (const std::string& remark : recording.remarks) std::cout << "note: " << remark << "\n";
  std::cout << (options.recording.folder / "report.html").string() << "\n";
}

}  // namespace

void addSmooth(const RunContext& context) {
  auto* command =
      context.root->add_subcommand("smooth", "Estimate path, calibration and effects of a whole recording");
  command->footer(
      "The batch estimate: all readings of all sensors at once, by maximum a posteriori. It starts from the\n"
      "filter's smoothed path; without INS and DVL each image has a pose by itself. Writes report.html,\n"
      "result.json, trajectory.tum and calibration.yaml (the effects that are on, as estimated), which\n"
      "`simulate` and `localize` read.\n"
      "\n"
      "An effect's marker_id and time_s are not estimated: --calibration names them. Each parameter has the\n"
      "prior that `fathom effects` lists.\n"
      "\n"
      "Examples:\n"
      "  fathom smooth dive.rawlog --out out/dive\n"
      "  fathom smooth dive.rawlog --estimate dvl-scale camera-misalignment --out out/dive");
  const auto options = std::make_shared<SmoothOptions>();
  addBatchRecordingOptions(*command, options->recording);
  command->add_option("--estimate", options->estimate,
                      "Effects whose parameters are estimated; of one of several instruments: dvl-scale.2");
  command
      ->add_option("--calibration", options->calibration,
                   "Effects known to be there; of those estimated, where to start")
      ->type_name(values::kYaml);
  command->add_flag("--noise-from-data", options->noise_from_data,
                    "Then once more, with each channel's noise as its residuals show where that is more than "
                    "stated");
  command->add_option("--seed", options->seed, "Accepted for uniformity: nothing here is random");
  command->callback([options, &context] { smooth(*options, context); });
}

}  // namespace fathom
