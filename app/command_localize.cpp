#include <iostream>
#include <memory>

#include "commands.h"
#include "core/error.h"
#include "core/progress.h"
#include "effects/calibration.h"
#include "inputs.h"
#include "localization/dead_reckoning.h"
#include "localization_report.h"
#include "recording/rawlog.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct LocalizeOptions {
  std::string rawlog, map, vehicle, config, calibration, reference, start = "auto", folder;
  bool smooth = false;
  std::uint64_t seed = 0;
};

/// The first TRUTH entry, for `--start reference`; the estimator itself never sees one.
std::optional<StampedPose> firstTruth(const fs::path& rawlog) {
  RawlogReader reader(rawlog);
  while (const auto sample = reader.next())
    if (sample->label == labels::kTruth)
      if (const auto* pose = std::get_if<PoseSample>(&sample->reading))
        return StampedPose{sample->time, Pose::fromMrpt(pose->T_odom_robot.mean)};
  return std::nullopt;
}

/// The first navigation reading's time: where estimation begins.
Time firstReading(const fs::path& rawlog) {
  RawlogReader reader(rawlog);
  while (const auto sample = reader.next())
    if (!std::holds_alternative<RecordingHeader>(sample->reading)) return sample->time;
  throw Error(rawlog.string(), "", "holds no reading");
}

std::optional<StartPose> startFromReference(const LocalizeOptions& options,
                                            const std::vector<StampedPose>& reference) {
  const Time begin = firstReading(options.rawlog);
  if (!reference.empty()) {
    if (const auto pose = poseAt(reference, begin))
      return StartPose{.T_odom_robot = *pose, .source = "first pose of the reference"};
    throw Error("--start", "reference", "the reference has no pose at the recording's first reading");
  }
  const auto truth = firstTruth(options.rawlog);
  if (!truth)
    throw Error("--start", "reference",
                "there is no reference: neither --reference nor TRUTH in the recording");
  if (std::abs(secondsBetween(begin, truth->time)) > 0.1)
    throw Error("--start", "reference", "the first TRUTH entry is not at the recording's first reading");
  return StartPose{.T_odom_robot = truth->T_odom_robot, .source = "first TRUTH entry"};
}

/// X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]
StartPose startFromNumbers(const std::string& text) {
  std::vector<double> v;
  for (const std::string& word : CLI::detail::split(text, ',')) {
    double value = 0.0;
    if (!CLI::detail::lexical_cast(word, value) || !std::isfinite(value))
      throw Error("--start", text, "must be auto, reference or X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]");
    v.push_back(value);
  }
  if (v.size() != 4 && v.size() != 6)
    throw Error("--start", text, "must have four or six numbers: X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]");
  v.resize(6, 0.0);
  return {.T_odom_robot = {rotationFromYawPitchRoll(radians(v[3]), radians(v[4]), radians(v[5])),
                           Vector3d(v[0], v[1], v[2])},
          .source = "given on the command line"};
}

std::optional<StartPose> startPose(const LocalizeOptions& options,
                                   const std::vector<StampedPose>& reference) {
  if (options.start == "auto") return std::nullopt;
  if (options.start == "reference") return startFromReference(options, reference);
  return startFromNumbers(options.start);
}

LocalizationSetup readSetup(const LocalizeOptions& options, const RawlogReader& reader) {
  LocalizationSetup setup;
  const auto vehicle = vehicleFile(options.vehicle, options.rawlog, reader.header());
  if (!vehicle)
    throw Error(options.rawlog, "", "names no vehicle file in its first comment; give one with --vehicle");
  setup.vehicle = readVehicle(*vehicle);
  if (!options.config.empty()) setup.options = readLocalizationOptions(options.config);
  if (options.smooth) setup.options.smooth = true;
  if (!options.calibration.empty()) setup.calibration = readCalibration(options.calibration);
  return setup;
}

/// Lines for the terminal.
void print(const LocalizationStory& story, Time time_zero) {
  std::cout << "start: " << story.summary.start_source << "\n\n" << formatTable(channelTable(story.summary));
  for (const auto& [kind, count] : story.summary.event_counts)
    if (kind != "start") std::cout << kind << ": " << count << " times\n";
  if (!story.filter) return;
  const auto show = [](const char* who, const Evaluation& e) {
    std::cout << who << ": position error " << fixed(e.position_m.mean, 3) << " ± "
              << fixed(e.position_m.sigma, 3) << " m, orientation error "
              << fixed(degrees(e.angle_rad.mean), 3) << " ± " << fixed(degrees(e.angle_rad.sigma), 3)
              << " deg, pose NEES " << fixed(e.nees_mean, 2) << " (6 expected), "
              << fixed(100.0 * e.within_3_sigma, 2) << " % inside 3 sigma\n";
  };
  std::cout << "\nagainst " << story.reference_name << " (path " << fixed(story.filter->path_m, 1) << " m)\n";
  show("filter", *story.filter);
  if (story.smoother) show("smoother", *story.smoother);
  std::cout << "\n" << formatTable(errorsOverTime(story, time_zero));
}

void localizeRecording(const LocalizeOptions& options, const RunContext& context) {
  RawlogReader reader(options.rawlog);
  LocalizationSetup setup = readSetup(options, reader);
  LocalizationStory story;
  story.run = {.command_line = context.command_line};
  story.recording = options.rawlog;
  story.remarks = disagreements(inspectRecording(options.rawlog), setup.vehicle);
  if (!options.reference.empty()) {
    story.reference = readTum(options.reference);
    story.reference_name = fs::path(options.reference).filename().string();
  }
  const bool reference_from_truth = options.reference.empty();
  setup.start = startPose(options, story.reference);

  auto first = reader.next();
  setup.time_zero = first->time;
  story.options = setup.options;
  LocalizationOutputs outputs(options.folder, fs::path(options.rawlog).stem().string(), setup.options.task,
                              setup.time_zero, setup.options.smooth);

  // One pass: the reference's TRUTH entries are set aside for the evaluation, the rest goes to the filter.
  Progress progress("localizing");
  std::optional<DeadReckoning> dead_reckoning;
  Evaluator evaluator(story.reference), smooth_evaluator(story.reference);
  const auto next = [&]() -> std::optional<Sample> {
    auto sample = std::exchange(first, std::nullopt);
    if (!sample) sample = reader.next();
    if (!sample) return sample;
    progress.update(reader.fraction());
    if (sample->label == labels::kTruth && reference_from_truth)
      if (const auto* pose = std::get_if<PoseSample>(&sample->reading))
        story.reference.push_back({sample->time, Pose::fromMrpt(pose->T_odom_robot.mean)});
    if (dead_reckoning) dead_reckoning->add(*sample);
    return sample;
  };
  if (setup.start) dead_reckoning.emplace(setup.start->T_odom_robot);
  LocalizationSink sink;
  sink.estimate = [&](const Estimate& e) {
    outputs.estimate(e);
    evaluator.add(e);  // final only after history_s, so TRUTH has come as far
  };
  sink.smoothed = [&](const Estimate& e) {
    outputs.smoothed(e);
    smooth_evaluator.add(e);
  };
  sink.innovation = [&](const Innovation& i) { outputs.innovation(i); };
  sink.event = [&](const Event& e) { outputs.event(e); };
  story.summary = localize(setup, next, sink);
  story.loss = reader.loss();
  if (!story.summary.started) throw Error(options.rawlog, "", story.summary.failure);

  if (reference_from_truth && !story.reference.empty()) story.reference_name = "TRUTH";
  story.filter = evaluator.finish();
  story.smoother = smooth_evaluator.finish();
  if (dead_reckoning) {
    story.plain = dead_reckoning->plain();
    story.by_reference_attitude = dead_reckoning->byAttitudeOf(story.reference);
  }
  if (story.loss)
    std::cerr << "fathom: " << options.rawlog << ": byte " << story.loss->at_byte << ": "
              << story.loss->reason << "; " << story.loss->lost_bytes << " bytes lost\n";

  outputs.finish();
  const fs::path folder = options.folder;
  writeJson(folder / "result.json", toJson(story, outputs, setup.time_zero));
  writeReport(folder / "report.html", story, outputs, setup.time_zero);
  print(story, setup.time_zero);
  std::cout << "\nwrote " << (folder / "report.html").string() << ", result.json, trajectory.tum"
            << (setup.options.smooth ? ", trajectory_smoothed.tum" : "") << ", innovations.csv.gz and "
            << fs::path(options.rawlog).stem().string() << "_results.rawlog beside it\n";
}

}  // namespace

void addLocalize(const RunContext& context) {
  auto* command = context.root->add_subcommand("localize", "Estimate the robot's path from a recording");
  command->footer(
      "Runs the error-state Kalman filter (the paper's 15 states; with bias_states 23) over the recording: "
      "task T_L2,\n"
      "INS and DVL only, unless --config says otherwise. Writes report.html, result.json, trajectory.tum,\n"
      "NAME_results.rawlog (opens in RawLogViewer) and innovations.csv.gz (every NIS, fused or gated).\n"
      "\n"
      "Where the path starts: `auto` aligns from the first seconds (gravity, INS attitude, USBL, pressure; "
      "what no\n"
      "sensor tells is zero and defines odom), `reference` takes the reference's first pose, or give "
      "numbers.\n"
      "A reference (--reference, or TRUTH in a simulated recording) is used to judge, never to estimate.\n"
      "\n"
      "Examples:\n"
      "  fathom localize rawlogs/dive/dive.rawlog --start reference --out out/dive\n"
      "  fathom localize dive.rawlog --config config/navigation.yaml --smooth --out out/dive\n"
      "  fathom localize section1.rawlog --reference section1_reference.tum --start reference --out "
      "out/section1");
  const auto options = std::make_shared<LocalizeOptions>();
  command->add_option("RECORDING", options->rawlog, "The recording")->required()->type_name(values::kRawlog);
  command->add_option("--out", options->folder, "Where the results go")
      ->required()
      ->type_name(values::kFolder);
  command->add_option("--vehicle", options->vehicle, "Vehicle file (default: the one the recording names)")
      ->type_name(values::kYaml);
  command
      ->add_option("--config", options->config,
                   "Which sensors, noise, gate (default: config/TL2.yaml's values)")
      ->type_name(values::kYaml);
  command->add_option("--calibration", options->calibration, "Effects known to be there")
      ->type_name(values::kYaml);
  command->add_option("--reference", options->reference, "Path to judge by (default: TRUTH in the recording)")
      ->type_name(values::kTum);
  command->add_option("--start", options->start, "auto, reference or X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]")
      ->capture_default_str();
  command->add_flag("--smooth", options->smooth,
                    "Also run the RTS smoother (2.4 kB or, with biases, 3.6 kB a step)");
  command->add_option("--map", options->map, "Panel map: its landmarks are not used by navigation tasks")
      ->type_name(values::kYaml);
  command->add_option("--seed", options->seed, "Accepted for uniformity: nothing here is random");
  command->callback([options, &context] { localizeRecording(*options, context); });
}

}  // namespace fathom
