#include "reports/localization_batch.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/fingerprint.h"
#include "core/progress.h"
#include "core/version.h"
#include "evaluation/statistics.h"
#include "panel/panel_maps.h"
#include "recording/rawlog.h"
#include "report/html_report.h"
#include "reports/localization_report.h"
#include "reports/results_scene.h"
#include "reports/tasks_report.h"
#include "tasks/companions.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

/// What the recording names, or has beside it, is an input too.
void addCompanions(Fingerprint& print, const RecordingJob& job) {
  const RawlogReader recording(job.chain.rawlog);
  if (const auto vehicle = vehicleFile(job.chain.vehicle, job.chain.rawlog, recording.header()))
    print.add(readTextFile(*vehicle));
  if (!needsLandmarks(job)) return;
  if (const auto map = panelMapFile(job.chain.map, job.chain.rawlog, recording.header()))
    for (const fs::path& panel : panelMapFiles(*map)) print.add(readTextFile(panel));
  std::error_code none;  // a recording without images has no folder of them
  std::vector<fs::path> images;
  for (const auto& entry : fs::recursive_directory_iterator(recording.imageFolder(), none))
    if (entry.is_regular_file()) images.push_back(entry.path());
  std::sort(images.begin(), images.end());
  for (const fs::path& image : images)
    print.add(image.lexically_relative(recording.imageFolder()).string()).add(readTextFile(image));
}

/// Tells whether a result is of the same inputs, by what the files hold.
std::string fingerprintOf(const RecordingJob& job) {
  Fingerprint print;
  print.add(programVersion()).add(job.start).add(job.chain.backend).add(job.chain.panel_unknown ? 1.0 : 0.0);
  for (const auto& names : {job.chain.audit.accept, job.chain.audit.correct})
    for (const std::string& name : names) print.add(name).add("");
  print.add(readTextFile(job.chain.rawlog));
  addCompanions(print, job);
  for (const std::string& file : {job.chain.calibration, job.chain.sources, job.reference, job.faults})
    print.add(file.empty() ? "" : readTextFile(file));
  for (const TaskSpec& task : job.tasks) print.add(task.id()).add(formatLocalizationOptions(task.options));
  return print.hex();
}

std::optional<nlohmann::ordered_json> earlierResult(const RecordingJob& job, const std::string& inputs) {
  const fs::path file = job.folder / "result.json";
  if (!isThere(file)) return std::nullopt;
  const auto json = nlohmann::ordered_json::parse(readTextFile(file), nullptr, false);
  if (json.is_discarded() || !json.is_object() || json.value("inputs", "") != inputs) return std::nullopt;
  return json;
}

/// A number deep in a result, NaN where it is not there.
double numberAt(const nlohmann::ordered_json& json, const std::string& pointer) {
  const nlohmann::ordered_json::json_pointer path(pointer);
  if (!json.contains(path) || !json.at(path).is_number()) return std::numeric_limits<double>::quiet_NaN();
  return json.at(path).get<double>();
}

std::vector<std::string> taskIds(const std::vector<BatchEntry>& entries) {
  std::vector<std::string> ids;
  for (const BatchEntry& entry : entries) {
    if (!entry.failure.empty()) continue;
    for (const auto& [id, task] : entry.result["tasks"].items())
      if (std::find(ids.begin(), ids.end(), id) == ids.end()) ids.push_back(id);
  }
  return ids;
}

/// The estimates of all tasks, the reference, the panels, and where these were seen from.
ResultsScene sceneOf(const LocalizedRecording& done) {
  constexpr std::size_t kMostFrusta = 100;
  constexpr std::array<std::uint8_t, 3> kColours[] = {{0, 114, 178},   {213, 94, 0},  {0, 158, 115},
                                                      {204, 121, 167}, {230, 159, 0}, {86, 180, 233}};
  const RecordingStory& story = *done.story;
  ResultsScene scene;
  scene.panels = story.panels;
  for (const auto& task : done.tasks) {
    NamedPath path{task->spec().name(), kColours[scene.paths.size() % std::size(kColours)], {}};
    for (const TaskOutputs::Mark& mark : task->outputs().marks())
      path.points.push_back({mark.t_s, mark.T_odom_robot});
    scene.paths.push_back(std::move(path));
  }
  NamedPath reference{story.reference_name, {40, 40, 40}, {}};
  for (const StampedPose& pose : story.reference)
    reference.points.push_back({secondsBetween(story.time_zero, pose.time), {pose.T_odom_robot}});
  if (!reference.points.empty()) scene.paths.push_back(std::move(reference));
  if (story.camera) scene.camera = *story.camera;
  const std::size_t step = story.marker_poses.size() / kMostFrusta + 1;
  for (std::size_t i = 0; i < story.marker_poses.size(); i += step)
    scene.T_odom_camera.push_back(story.marker_poses[i].T_odom_robot * story.T_robot_camera);
  return scene;
}

}  // namespace

LocalizedRecording localizeAndReport(const RecordingJob& job) {
  const std::string inputs = fingerprintOf(job);
  LocalizedRecording done = localizeRecording(job);
  nlohmann::ordered_json json = toJson(done);
  json["inputs"] = inputs;
  const fs::path report = job.folder / "report.html";
  if (!done.story->panels.empty())
    writeResultsScene(job.folder / (job.chain.rawlog.stem().string() + "_results.3Dscene"), sceneOf(done));
  if (done.tasks.size() == 1)
    writeReport(report, *done.story, done.tasks[0]->story(), done.tasks[0]->outputs());
  else
    writeTasksReport(report, done);
  writeJson(job.folder / "result.json", json);  // last: it tells that all is there
  return done;
}

BatchEntry runJob(const RecordingJob& job) {
  BatchEntry entry{job.chain.rawlog, job.folder, {}, false, {}};
  const std::string inputs = fingerprintOf(job);
  if (auto earlier = earlierResult(job, inputs)) {
    entry.result = std::move(*earlier);
    entry.done_before = true;
  } else {
    localizeAndReport(job);
    entry.result = nlohmann::ordered_json::parse(readTextFile(job.folder / "result.json"));
  }
  return entry;
}

std::vector<BatchEntry> runBatch(const std::vector<RecordingJob>& jobs,
                                 const std::function<void(const BatchEntry&)>& done) {
  std::vector<BatchEntry> entries;
  for (const RecordingJob& job : jobs) {
    try {
      entries.push_back(runJob(job));
    } catch (const Error& error) {
      entries.push_back({job.chain.rawlog, job.folder, error.what(), false, {}});
    }
    done(entries.back());
  }
  return entries;
}

Table batchTable(const std::vector<BatchEntry>& entries) {
  Table table{.header = {"task", "recordings", "position to S [m]: mean", "median", "largest",
                         "angle to S [deg]: mean", "median", "largest", "position to M [m]: mean",
                         "m_A: mean", "lost at the end"}};
  for (const std::string& id : taskIds(entries)) {
    std::vector<double> position, angle, to_markers, smoothness;
    int recordings = 0, lost = 0;
    const auto note = [](double value, std::vector<double>& values) {
      if (std::isfinite(value)) values.push_back(value);
    };
    for (const BatchEntry& entry : entries) {
      if (!entry.failure.empty() || !entry.result["tasks"].contains(id)) continue;
      const auto& task = entry.result["tasks"][id];
      const std::string measures =
          task.contains("smoother_measures") ? "/smoother_measures" : "/filter_measures";
      ++recordings;
      // Without sightings, of all estimates.
      const bool sighted = task[measures.substr(1)].contains("against_reference");
      const std::string all = task.contains("smoother_error") ? "/smoother_error" : "/filter_error";
      note(numberAt(task, sighted ? measures + "/against_reference/position_mean_m"
                                  : all + "/position_error_mean_m"),
           position);
      note(numberAt(task,
                    sighted ? measures + "/against_reference/angle_mean_deg" : all + "/angle_error_mean_deg"),
           angle);
      note(numberAt(task, measures + "/against_markers/position_mean_m"), to_markers);
      note(numberAt(task, measures + "/m_A"), smoothness);
      if (task.contains("lost_since_s") && task["lost_since_s"].is_number()) ++lost;
    }
    const ErrorSummary p = summaryOf(position), a = summaryOf(angle);
    table.rows.push_back({id, std::to_string(recordings), fixed(p.mean, 3), fixed(p.median, 3),
                          fixed(p.largest, 3), fixed(a.mean, 3), fixed(a.median, 3), fixed(a.largest, 3),
                          fixed(summaryOf(to_markers).mean, 3), fixed(summaryOf(smoothness).mean, 3),
                          std::to_string(lost)});
  }
  return table;
}

void writeBatchReport(const fs::path& folder, const std::vector<BatchEntry>& entries, const RunInfo& run) {
  Table each{.header = {"recording", "outcome", "folder"}};
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::size_t failed = 0;
  for (const BatchEntry& entry : entries) {
    if (!entry.failure.empty()) ++failed;
    const std::string outcome = entry.failure.empty() ? "done" : entry.failure;
    each.rows.push_back({entry.recording.string(), outcome, fs::relative(entry.folder, folder).string()});
    list.push_back({{"recording", entry.recording.string()}, {"outcome", outcome}});
  }
  const Table table = batchTable(entries);
  HtmlReport report("Localization of " + std::to_string(entries.size()) + " recordings");
  report.keyValues({{"recordings", std::to_string(entries.size())}, {"failed", std::to_string(failed)}});
  report.table(table,
               "Of each recording's mean error over its sightings, or over all estimates where nothing was "
               "sighted; of the "
               "smoother where a task has one.");
  report.heading("Each recording");
  report.table(each);
  report.footer(run);
  report.write(folder / "report.html");
  writeJson(folder / "summary.json", {{"run", toJson(run)},
                                      {"recordings", list},
                                      {"failed", failed},
                                      {"table", {{"columns", table.header}, {"rows", table.rows}}}});
}

}  // namespace fathom
