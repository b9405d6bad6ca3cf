#include <iostream>
#include <memory>
#include <set>

#include "commands.h"
#include "common_options.h"
#include "core/error.h"
#include "core/shipped_file.h"
#include "recording/rawlog.h"
#include "reports/localization_batch.h"
#include "reports/localization_report.h"
#include "reports/tasks_report.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct LocalizeOptions {
  std::vector<std::string> recordings;
  std::vector<std::string> tasks;
  std::string config, improved = "config/improved.yaml", folder;
  std::string noise;
  bool paper_only = false, smooth = false;
  std::uint64_t seed = 0;
  RecordingJob job;  ///< of every recording, but for its name and folder
};

std::vector<TaskSpec> readTasks(const LocalizeOptions& options) {
  std::vector<TaskSpec> tasks;
  if (options.tasks.empty()) {
    tasks.push_back(
        {options.config.empty() ? LocalizationOptions{} : readLocalizationOptions(options.config), false});
  }
  std::set<std::string> names;
  for (const std::string& task : options.tasks) {
    tasks.push_back({readTask(task), false});
    if (!names.insert(tasks.back().options.task).second)
      throw Error("--tasks", task, "there is another task of that name");
    if (!options.paper_only)
      tasks.push_back({readLocalizationOptions(shippedFile(options.improved), tasks.back().options), true});
  }
  for (TaskSpec& task : tasks) {
    if (options.smooth) task.options.smooth = true;
    if (!options.noise.empty()) task.options.adapts_noise = options.noise == "adaptive";
  }
  return tasks;
}

/// Every recording has a folder of its own name; a single one, the whole folder.
std::vector<RecordingJob> jobsOf(const LocalizeOptions& options, const RunContext& context) {
  RecordingJob job = options.job;
  job.tasks = readTasks(options);
  job.command_line = context.command_line;
  std::vector<RecordingJob> jobs;
  std::set<std::string> names;
  for (const std::string& recording : options.recordings) {
    job.chain.rawlog = recording;
    const std::string stem = job.chain.rawlog.stem().string();
    std::string name = stem;
    for (int again = 2; !names.insert(name).second; ++again) name = stem + "_" + std::to_string(again);
    job.folder = options.recordings.size() == 1 ? fs::path(options.folder) : fs::path(options.folder) / name;
    jobs.push_back(job);
  }
  return jobs;
}

void warnOfLoss(const RecordingStory& story) {
  if (story.loss)
    std::cerr << "fathom: " << story.recording.string() << ": " << describe(*story.loss) << "\n";
}

/// One task, in full.
void printStory(const RecordingStory& recording, const TaskStory& story) {
  std::cout << "start: " << story.summary.start_source << "\n\n" << formatTable(channelTable(story.summary));
  if (story.options.adapts_noise)
    std::cout << "drive at the end, times what is assumed: turning " << fixed(story.summary.turning_times, 2)
              << ", pushing " << fixed(story.summary.pushing_times, 2) << "\n";
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
  std::cout << "\nagainst " << recording.reference_name << " (path " << fixed(story.filter->path_m, 1)
            << " m)"
            << (story.filter->is_laid ? ", laid on the first estimate where odom is a definition" : "")
            << "\n";
  show("filter", *story.filter);
  if (story.smoother) show("smoother", *story.smoother);
  std::cout << "\n" << formatTable(errorsOverTime(recording, story));
}

/// Several tasks, side by side.
void printStory(const LocalizedRecording& recording) {
  const RecordingStory& story = *recording.story;
  std::cout << story.image_times.size() << " images, markers seen in " << story.marker_poses.size() << "\n\n"
            << formatTable(taskTable(recording)) << "\n";
  for (const auto& task : recording.tasks)
    for (const auto& [kind, count] : task->story().summary.event_counts)
      if (kind != "start") std::cout << task->spec().name() << ": " << kind << " " << count << " times\n";
}

void localizeOne(const RecordingJob& job) {
  const LocalizedRecording done = localizeAndReport(job);
  warnOfLoss(*done.story);
  for (const std::string& remark : done.story->remarks) std::cout << "note: " << remark << "\n";
  if (done.tasks.size() == 1)
    printStory(*done.story, done.tasks[0]->story());
  else
    printStory(done);
  std::cout << "\nwrote " << (job.folder / "report.html").string() << ", result.json, "
            << job.chain.rawlog.stem().string() << "_results.rawlog";
  if (done.tasks.size() == 1)
    std::cout << ", trajectory.tum" << (job.tasks[0].options.smooth ? ", trajectory_smoothed.tum" : "")
              << " and innovations.csv.gz beside it\n";
  else
    std::cout << " and a folder for each task\n";
}

void localizeMany(const std::vector<RecordingJob>& jobs, const LocalizeOptions& options,
                  const RunContext& context) {
  std::size_t count = 0;
  const std::vector<BatchEntry> entries = runBatch(jobs, [&](const BatchEntry& entry) {
    if (!entry.failure.empty()) std::cerr << "fathom: " << entry.failure << "\n";
    std::cout << ++count << "/" << jobs.size() << " " << entry.recording.string() << ": "
              << (!entry.failure.empty() ? "failed"
                  : entry.done_before    ? "done before"
                                         : "done")
              << "\n"
              << std::flush;
  });
  writeBatchReport(options.folder, entries, {.command_line = context.command_line});
  std::cout << "\n"
            << formatTable(batchTable(entries)) << "\nwrote "
            << (fs::path(options.folder) / "report.html").string() << " and summary.json beside it\n";
  const auto failed =
      std::count_if(entries.begin(), entries.end(), [](const BatchEntry& e) { return !e.failure.empty(); });
  if (failed > 0)
    throw Error(options.folder, "",
                std::to_string(failed) + " of " + std::to_string(entries.size()) +
                    " recordings could not be localized; the rest is done");
}

void localize(const LocalizeOptions& options, const RunContext& context) {
  const std::vector<RecordingJob> jobs = jobsOf(options, context);
  if (jobs.size() == 1)
    localizeOne(jobs[0]);
  else
    localizeMany(jobs, options, context);
}

constexpr const char* kLocalizeHelp =
    "Runs the error-state Kalman filter over a recording: INS and DVL only, unless --config or --tasks say\n"
    "otherwise. Writes report.html, result.json, trajectory.tum, NAME_results.rawlog (opens in\n"
    "RawLogViewer) and innovations.csv.gz (every NIS, fused or gated).\n"
    "\n"
    "--tasks runs several tasks side by side and compares them. A name stands for config/NAME.yaml:\n"
    "  TL1  landmarks only            TL4  TL3, with the markers' measured covariance\n"
    "  TL2  INS and DVL only          TL5  TL4, rejecting marker poses beyond 1 m or 12 deg\n"
    "  TL3  TL2 and markers\n"
    "These are the paper's; beside each runs what --improved makes of it: one pose from all corners of all\n"
    "markers with its covariance, a Mahalanobis gate, biases, the smoother. Errors are mean ± sigma over\n"
    "the marker sightings, against the markers' pose M and, where there is one, the reference S. m_A is\n"
    "the lag-one autocorrelation of the path's increments from image to image, Pearson's r, the mean over\n"
    "three axes of position and three of rotation: near 1 where the path is smooth, low where it jerks.\n"
    "Markers are detected once; detections are kept beside the recording, by content and settings.\n"
    "\n"
    "Several recordings go to a folder each, with a summary over all. What was done before with the same\n"
    "inputs is not done again; a broken recording is reported, the rest goes on, the exit status is 2.\n"
    "\n"
    "The noise of sensors, motion and biases follows what the innovations show, within bounds (a sensor's\n"
    "sigma from 0.84 to three times the vehicle file's; a bias, as large as it is), except in the paper's "
    "tasks.\n"
    "What it came to is in the table; `--noise fixed` takes it as the files state it, and `fathom tune`\n"
    "finds what to state.\n"
    "\n"
    "Where the path starts: `auto` takes what the first seconds tell (gravity, INS attitude, USBL, pressure, "
    "panels\n"
    "of known pose: most of their sightings); what nothing tells is zero and defines odom, until the first "
    "fix\n"
    "moves it. `reference` takes the reference's first pose, where it turns as the gyro does, or give "
    "numbers.\n"
    "A reference (--reference, or TRUTH in a simulated recording) is used to judge, never to estimate.\n"
    "\n"
    "Examples:\n"
    "  fathom localize rawlogs/dive/dive.rawlog --start reference --out out/dive\n"
    "  fathom localize rawlogs/trial/trial.rawlog --tasks TL1,TL2,TL3,TL4,TL5 --out out/trial\n"
    "  fathom localize dives/*.rawlog --tasks TL2,TL5 --out out/dives\n"
    "  fathom localize trial.rawlog --tasks TL5 --faults config/degrade_dvl_outage.yaml --out out/outage\n"
    "  fathom localize section1.rawlog --reference section1_reference.tum --start reference --out "
    "out/section1";

}  // namespace

void addLocalize(const RunContext& context) {
  auto* command = context.root->add_subcommand("localize", "Estimate the robot's path from recordings");
  command->footer(kLocalizeHelp);
  const auto options = std::make_shared<LocalizeOptions>();
  RecordingJob& job = options->job;
  command->add_option("RECORDING", options->recordings, "The recordings")
      ->required()
      ->type_name(values::kRawlog);
  command->add_option("--out", options->folder, "Where the results go")
      ->required()
      ->type_name(values::kFolder);
  auto* tasks = command->add_option("--tasks", options->tasks, "Names, or YAML files, with commas between")
                    ->delimiter(',');
  command->add_option("--improved", options->improved, "What is changed in each task, beside it")
      ->capture_default_str()
      ->type_name(values::kYaml);
  command->add_flag("--paper-only", options->paper_only, "Run the tasks as they are only");
  command
      ->add_option("--config", options->config,
                   "One task: which sensors, noise, gate (default: config/defaults.yaml's values)")
      ->excludes(tasks)
      ->type_name(values::kYaml);
  addChainOptions(*command, job.chain);
  command->add_option("--faults", job.faults, "What befalls the samples on their way (config/degrade_*.yaml)")
      ->type_name(values::kYaml);
  command->add_option("--reference", job.reference, "Path to judge by (default: TRUTH in the recording)")
      ->type_name(values::kTum);
  command->add_option("--start", job.start, "auto, reference or X,Y,Z,YAW_DEG[,PITCH_DEG,ROLL_DEG]")
      ->capture_default_str();
  command
      ->add_option(
          "--noise", options->noise,
          "Of all tasks: adaptive (as innovations show it, within bounds) or fixed (as the files have it); "
          "default: as each says")
      ->check(CLI::IsMember({"adaptive", "fixed"}));
  command->add_flag("--smooth", options->smooth,
                    "Also run the RTS smoother (2.4 kB or, with biases, 3.6 kB a step)");
  command->add_option("--seed", options->seed, "Accepted for uniformity: nothing here is random");
  command->callback([options, &context] { localize(*options, context); });
}

}  // namespace fathom
