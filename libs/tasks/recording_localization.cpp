#include "tasks/recording_localization.h"

#include <algorithm>

#include "core/error.h"
#include "core/progress.h"
#include "core/text.h"
#include "localization/dead_reckoning.h"
#include "localization/run_tasks.h"
#include "recording/time_text.h"
#include "sources/degraded_source.h"
#include "tasks/reference_clock.h"
#include "tasks/start_pose.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// How far behind the newest sample a task may still deliver: its history, and its alignment before that.
double delay_s(const std::vector<TaskSpec>& tasks) {
  double longest_s = 0;
  for (const TaskSpec& task : tasks)
    longest_s = std::max(
        longest_s, task.options.history_s + std::max(task.options.alignment_s, task.options.first_fix_s));
  return longest_s + 1.0;
}

bool isLandmark(const Sample& sample) {
  const auto kind = baseOf(sample.label);
  return kind == labels::kMarkers || kind == labels::kPanel || kind == labels::kMarkerSights;
}

/// Notes what the evaluation needs of the samples that pass.
class Witness {
 public:
  Witness(RecordingStory& story, bool collect_truth) : story_(story), collect_truth_(collect_truth) {}

  void see(const Sample& sample) {
    if (const auto* image = std::get_if<ImageSample>(&sample.reading))
      seeImage(sample.time, image->intrinsics, image->T_robot_camera);
    if (const auto* pair = std::get_if<StereoSample>(&sample.reading))
      seeImage(sample.time, pair->left_intrinsics, pair->T_robot_left);
    const auto* pose = std::get_if<PoseSample>(&sample.reading);
    if (pose == nullptr) return;
    const StampedPose stamped{sample.time, pose->T_odom_robot.mean};
    if (sample.label == labels::kTruth && collect_truth_) story_.reference.push_back(stamped);
    if (baseOf(sample.label) == labels::kMarkers) story_.marker_poses.push_back(stamped);
  }

 private:
  void seeImage(Time time, const RecordedCamera& intrinsics, const Pose& T_robot_camera) {
    story_.image_times.push_back(time);
    if (story_.camera) return;
    story_.camera = intrinsics.model;
    story_.T_robot_camera = T_robot_camera;
  }

  RecordingStory& story_;
  bool collect_truth_;
};

std::vector<std::unique_ptr<TaskRun>> makeTasks(const RecordingJob& job, const LocalizationSetup& setup,
                                                const RecordingStory& story, ResultsLog& results) {
  std::vector<std::unique_ptr<TaskRun>> tasks;
  for (const TaskSpec& spec : job.tasks) {
    const fs::path folder = job.tasks.size() == 1 ? job.folder : job.folder / spec.id();
    tasks.push_back(std::make_unique<TaskRun>(spec, setup, story, folder, results, tasks.size()));
  }
  return tasks;
}

}  // namespace

bool needsLandmarks(const RecordingJob& job) {
  return job.tasks.size() > 1 || std::any_of(job.tasks.begin(), job.tasks.end(),
                                             [](const TaskSpec& task) { return task.fusesLandmarks(); });
}

/// A reference that was asked for and judges nothing, mostly of another clock.
void remarkIdleReference(const RecordingJob& job, LocalizedRecording& done) {
  RecordingStory& story = *done.story;
  if (job.reference.empty() || std::any_of(done.tasks.begin(), done.tasks.end(),
                                           [](const auto& task) { return task->story().filter.has_value(); }))
    return;
  const auto seconds = [](Time time) { return secondsText(unixTicks(time)); };
  story.remarks.push_back(
      story.reference_name + " has no time in common with the recording, nothing is compared: it is from " +
      seconds(story.reference.front().time) + " to " + seconds(story.reference.back().time) +
      " s since 1970, the recording begins at " + seconds(story.time_zero) + " s");
}

/// Errors against it are partly of the time between.
void remarkReferenceClock(const RecordingJob& job, RecordingStory& story) {
  if (const auto offset_s = referenceClockOffset(job.chain.rawlog, story.reference))
    story.remarks.push_back(
        print("%s: its clock is off: it turns as the gyro does %+.2f s from its stamps; errors are "
              "against it as it is stamped",
              story.reference_name.c_str(), *offset_s));
}

LocalizedRecording localizeRecording(const RecordingJob& job) {
  LocalizedRecording done;
  done.story = std::make_unique<RecordingStory>();
  RecordingStory& story = *done.story;
  story.run = {.command_line = job.command_line};
  story.recording = job.chain.rawlog;
  if (!job.reference.empty()) {
    story.reference = readTum(job.reference);
    story.reference_name = fs::path(job.reference).filename().string();
  }

  const SampleChain chain(job.chain, needsLandmarks(job));
  story.remarks = chain.remarks();
  remarkReferenceClock(job, story);
  story.panels = chain.panels();
  LocalizationSetup setup = chain.setup();
  setup.start = startPose(job.start, job.chain.rawlog, story.reference);
  story.time_zero = setup.time_zero;
  std::unique_ptr<SampleSource> samples = chain.open();
  if (!job.faults.empty())
    samples = std::make_unique<DegradedSource>(std::move(samples), readDegradation(job.faults));

  const fs::path results_file = job.folder / (job.chain.rawlog.stem().string() + "_results.rawlog");
  ResultsLog results(results_file, {"", "", "results of fathom localize"}, story.time_zero,
                     job.tasks.size() + 1);
  done.tasks = makeTasks(job, setup, story, results);
  std::vector<Localizer*> localizers;
  for (const auto& task : done.tasks) localizers.push_back(&task->localizer());

  Progress progress("localizing " + job.chain.rawlog.filename().string());
  Witness witness(story, job.reference.empty());
  std::optional<DeadReckoning> dead_reckoning;
  if (setup.start) dead_reckoning.emplace(setup.start->T_odom_robot);
  const double behind_s = delay_s(job.tasks);
  TaskHooks hooks;
  hooks.sample = [&](const Sample& sample) {
    witness.see(sample);
    if (dead_reckoning) dead_reckoning->add(sample);
    if (isLandmark(sample)) results.add(job.tasks.size(), sample);
  };
  hooks.block = [&](double newest_t_s) {
    progress.update(samples->fraction());
    results.writeBefore(after(story.time_zero, newest_t_s - behind_s));
  };
  auto summaries = runTasks(*samples, localizers, story.time_zero, hooks);

  story.loss = samples->loss();
  if (story.reference_name.empty() && !story.reference.empty()) story.reference_name = "TRUTH";
  if (dead_reckoning) {
    story.plain = dead_reckoning->plain();
    story.by_reference_attitude = dead_reckoning->byAttitudeOf(story.reference);
  }
  for (std::size_t i = 0; i < done.tasks.size(); ++i) done.tasks[i]->finish(std::move(summaries[i]));
  if (std::none_of(done.tasks.begin(), done.tasks.end(),
                   [](const auto& task) { return task->story().summary.started; }))
    throw Error(job.chain.rawlog.string(), "", done.tasks.front()->story().summary.failure);
  remarkIdleReference(job, done);
  results.finish();
  return done;
}

}  // namespace fathom
