#include "reports/tasks_report.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "report/html_report.h"
#include "reports/localization_report.h"

namespace fathom {
namespace {

/// One estimate of a task: the filter's, or the smoother's.
struct Estimated {
  std::string name;
  const TaskRun* task;
  const TaskMeasures* measures;
  const std::optional<Evaluation>* evaluation;
  const std::vector<StampedPose>* path;
};

std::vector<Estimated> estimatesOf(const LocalizedRecording& recording) {
  std::vector<Estimated> all;
  for (const auto& task : recording.tasks) {
    const TaskStory& story = task->story();
    const std::string name = task->spec().name();
    all.push_back({name, task.get(), &story.filter_measures, &story.filter, &task->outputs().poses()});
    if (story.options.smooth)
      all.push_back({name + ", smoothed", task.get(), &story.smoother_measures, &story.smoother,
                     &task->outputs().smoothedPoses()});
  }
  return all;
}

std::string withSigma(const std::optional<PathErrors>& errors, bool angle) {
  if (!errors) return "-";
  const MeanAndSigma& value = angle ? errors->angle_rad : errors->position_m;
  const double unit = angle ? degrees(1.0) : 1.0;
  return fixed(unit * value.mean, 3) + " ± " + fixed(unit * value.sigma, 3);
}

std::string lostText(const LocalizationSummary& summary) {
  if (!summary.started) return "not started: " + summary.failure;
  if (summary.lost_since_s) return "since " + fixed(*summary.lost_since_s, 0) + " s";
  return "no";
}

/// Of a task with a smoother, what the smoother gives.
bool isPlotted(const Estimated& estimate, bool improved) {
  const TaskStory& story = estimate.task->story();
  const bool smoothed = estimate.path == &estimate.task->outputs().smoothedPoses();
  return story.improved == improved && story.options.smooth == smoothed;
}

/// Distance from the reference over time, of the paper's tasks or of the improved ones.
Plot errorPlot(const LocalizedRecording& recording, bool improved, bool angle) {
  Plot plot{.title = std::string(angle ? "Orientation" : "Position") + " error, " +
                     (improved ? "improved tasks" : "the paper's tasks"),
            .x_label = "time [s]",
            .y_label = angle ? "[deg]" : "[m]"};
  plot.log_y = true;
  for (const Estimated& estimate : estimatesOf(recording)) {
    if (!isPlotted(estimate, improved) || !*estimate.evaluation) continue;
    Series series{.name = estimate.name};
    for (const PoseError& error : (*estimate.evaluation)->errors) {
      series.x.push_back(error.t_s);
      series.y.push_back(angle ? degrees(error.rotation_rad.norm()) : error.position_m.norm());
    }
    plot.series.push_back(std::move(series));
  }
  return plot;
}

Plot pathPlot(const LocalizedRecording& recording, bool improved) {
  Plot plot{.title = std::string("Path from above, ") + (improved ? "improved tasks" : "the paper's tasks"),
            .x_label = "x in odom [m]",
            .y_label = "y in odom [m]"};
  plot.equal_axes = true;
  for (const Estimated& estimate : estimatesOf(recording))
    if (isPlotted(estimate, improved))
      plot.series.push_back(
          pathSeries(estimate.name, *estimate.path, Series::Style::kLine, estimate.task->outputs().lost()));
  if (!recording.story->reference.empty())
    plot.series.push_back(pathSeries("reference", recording.story->reference, Series::Style::kDashed));
  plot.series.push_back(pathSeries("markers", recording.story->marker_poses, Series::Style::kPoints));
  return plot;
}

Table consistencyTable(const LocalizedRecording& recording) {
  Table table{.header = {"task", "channel", "fused", "gated", "dof", "mean NIS", "95 % band of the mean"}};
  for (const auto& task : recording.tasks)
    for (const auto& row : channelTable(task->story().summary).rows) {
      table.rows.push_back({task->spec().name()});
      table.rows.back().insert(table.rows.back().end(), row.begin(), row.end());
    }
  return table;
}

Table eventTable(const LocalizedRecording& recording) {
  constexpr std::size_t kMostRows = 200;
  Table table{.header = {"task", "time [s]", "kind", "what"}};
  for (const auto& task : recording.tasks)
    for (const Event& event : task->outputs().events())
      if (table.rows.size() < kMostRows)
        table.rows.push_back({task->spec().name(), fixed(event.t_s, 3), event.kind, event.text});
  return table;
}

bool anyImproved(const LocalizedRecording& recording, bool improved) {
  return std::any_of(recording.tasks.begin(), recording.tasks.end(),
                     [&](const auto& task) { return task->story().improved == improved; });
}

}  // namespace

Table taskTable(const LocalizedRecording& recording) {
  Table table{.header = {"task", "to M [m]", "to M [deg]"}};
  const bool judged = !recording.story->reference.empty();
  if (judged) table.header.insert(table.header.end(), {"to S [m]", "to S [deg]"});
  table.header.emplace_back("m_A");
  if (judged) table.header.insert(table.header.end(), {"in 3 sigma [%]", "NEES"});
  table.header.insert(table.header.end(), {"lost then", "at the end"});
  for (const Estimated& estimate : estimatesOf(recording)) {
    const TaskMeasures& measures = *estimate.measures;
    std::vector<std::string> row{estimate.name, withSigma(measures.against_markers, false),
                                 withSigma(measures.against_markers, true)};
    if (judged)
      row.insert(row.end(),
                 {withSigma(measures.against_reference, false), withSigma(measures.against_reference, true)});
    row.push_back(measures.smoothness ? fixed(measures.smoothness->increments_r, 3) : "-");
    const auto& evaluation = *estimate.evaluation;
    if (judged)
      row.insert(row.end(), {evaluation ? fixed(100.0 * evaluation->within_3_sigma, 2) : "-",
                             evaluation ? fixed(evaluation->nees_mean, 2) : "-"});
    row.push_back(std::to_string(measures.lost_sightings));
    row.push_back(lostText(estimate.task->story().summary));
    table.rows.push_back(row);
  }
  return table;
}

void writeTasksReport(const std::filesystem::path& file, const LocalizedRecording& recording) {
  const RecordingStory& story = *recording.story;
  HtmlReport report("Localization of " + story.recording.filename().string());
  report.keyValues({{"images", std::to_string(story.image_times.size())},
                    {"sightings of markers", std::to_string(story.marker_poses.size())},
                    {"tasks", std::to_string(recording.tasks.size())}});
  if (story.loss) report.warning("The recording is damaged: " + describe(*story.loss) + ".");
  for (const std::string& remark : story.remarks) report.warning(remark);

  report.heading("The tasks compared");
  report.table(
      taskTable(recording),
      "Mean ± sigma over the sightings. M: pose from the single markers' mean, as in the paper. S: " +
          (story.reference_name.empty() ? std::string("none") : story.reference_name) +
          ". m_A: lag-one autocorrelation of the path's increments between images. Lost then: sightings at "
          "which the "
          "task said that it was lost; they do not count.");
  for (const bool improved : {false, true}) {
    if (!anyImproved(recording, improved)) continue;
    report.plot(pathPlot(recording, improved));
    if (story.reference.empty()) continue;
    report.plot(errorPlot(recording, improved, false));
    report.plot(errorPlot(recording, improved, true));
  }

  report.heading("Are the sensors and the filters consistent?");
  report.paragraph(
      "The normalized innovation squared (NIS) of a consistent filter averages to the channel's degrees of "
      "freedom.");
  report.table(consistencyTable(recording));

  report.heading("What happened");
  report.table(eventTable(recording), "The first two hundred; all are counted in result.json.");
  report.footer(story.run);
  report.write(file);
}

nlohmann::ordered_json toJson(const LocalizedRecording& recording) {
  nlohmann::ordered_json json = toJson(*recording.story);
  const Table table = taskTable(recording);
  json["table"] = {{"columns", table.header}, {"rows", table.rows}};
  json["tasks"] = nlohmann::ordered_json::object();
  for (const auto& task : recording.tasks)
    json["tasks"][task->spec().id()] = toJson(*recording.story, task->story(), task->outputs());
  return json;
}

}  // namespace fathom
