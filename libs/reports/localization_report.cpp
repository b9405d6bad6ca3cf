#include "reports/localization_report.h"

#include <limits>
#include <nlohmann/json.hpp>

#include "core/chi_square.h"
#include "report/html_report.h"

namespace fathom {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

double deadReckoningErrorAt(const std::vector<StampedPose>& path, const RecordingStory& recording,
                            Time time) {
  const auto estimate = poseAt(path, time);
  const auto truth = poseAt(recording.reference, time);
  if (!estimate || !truth) return std::numeric_limits<double>::quiet_NaN();
  return (estimate->position - truth->position).norm();
}

Series line(const std::string& name, const std::vector<PoseError>& errors,
            const std::function<double(const PoseError&)>& y) {
  Series series{.name = name};
  for (const PoseError& error : errors) {
    series.x.push_back(error.t_s);
    series.y.push_back(y(error));
  }
  return series;
}

Plot pathPlot(const RecordingStory& recording, const TaskOutputs& outputs) {
  Plot plot{.title = "Path from above", .x_label = "x in odom [m]", .y_label = "y in odom [m]"};
  plot.equal_axes = true;
  plot.series.push_back(pathSeries("filter", outputs.poses(), Series::Style::kLine));
  if (!recording.reference.empty())
    plot.series.push_back(pathSeries("reference", recording.reference, Series::Style::kDashed));
  if (!recording.plain.empty())
    plot.series.push_back(pathSeries("plain integration", recording.plain, Series::Style::kLine));
  return plot;
}

/// `values` are of the filter's poses, one each.
Plot overTime(const char* title, const char* y_label, const RecordingStory& recording,
              const TaskOutputs& outputs, const char* const (&names)[3],
              const std::vector<Vector3d>& values) {
  Plot plot{.title = title, .x_label = "time [s]", .y_label = y_label};
  for (int axis = 0; axis < 3; ++axis) {
    Series series{.name = names[axis]};
    for (std::size_t i = 0; i < values.size(); ++i) {
      series.x.push_back(secondsBetween(recording.time_zero, outputs.poses()[i].time));
      series.y.push_back(values[i][axis]);
    }
    plot.series.push_back(series);
  }
  return plot;
}

/// Yaw, pitch, roll in degrees, without jumps where one passes 180.
std::vector<Vector3d> unwrappedAngles(const std::vector<StampedPose>& poses) {
  std::vector<Vector3d> all;
  for (const StampedPose& pose : poses) {
    Vector3d angles = yawPitchRollFromRotation(pose.T_odom_robot.rotation) * degrees(1.0);
    if (!all.empty())
      for (int k = 0; k < 3; ++k) angles[k] -= 360.0 * std::round((angles[k] - all.back()[k]) / 360.0);
    all.push_back(angles);
  }
  return all;
}

void addPath(HtmlReport& report, const RecordingStory& recording, const TaskOutputs& outputs) {
  std::vector<Vector3d> positions;
  for (const StampedPose& pose : outputs.poses()) positions.push_back(pose.T_odom_robot.position);
  report.heading("Path");
  report.plot(pathPlot(recording, outputs));
  report.plot(overTime("Position in odom", "[m]", recording, outputs, {"x", "y", "z"}, positions));
  report.plot(overTime("Orientation", "[deg]", recording, outputs, {"yaw", "pitch", "roll"},
                       unwrappedAngles(outputs.poses())));
  report.plot(overTime("Velocity in robot axes", "[m/s]", recording, outputs, {"surge", "sway", "heave"},
                       outputs.velocities()));
}

/// One component of the error inside its 3-sigma band.
Plot errorPlot(const std::string& title, const std::string& y_label, const std::vector<PoseError>& errors,
               const std::function<double(const PoseError&)>& value,
               const std::function<double(const PoseError&)>& sigma) {
  Plot plot{.title = title, .x_label = "time [s]", .y_label = y_label};
  Series band{.name = "3 sigma", .style = Series::Style::kBand};
  for (const PoseError& error : errors) {
    band.x.push_back(error.t_s);
    band.lower.push_back(-3.0 * sigma(error));
    band.upper.push_back(3.0 * sigma(error));
  }
  plot.series = {band, line("error", errors, value)};
  return plot;
}

Plot nisPlot(Channel channel, const NisWindows& nis, int degrees_of_freedom) {
  Plot plot{.title = "NIS of " + nameOf(channel), .x_label = "time [s]", .y_label = "mean NIS a window [1]"};
  Series mean{.name = "mean over " + fixed(nis.length_s(), 0) + " s"};
  Series band{.name = "95 % of means", .style = Series::Style::kBand};
  for (const auto& window : nis.windows()) {
    const auto [low, high] = meanChiSquareBand(degrees_of_freedom, window.count);
    mean.x.push_back(window.begin_s + 0.5 * nis.length_s());
    mean.y.push_back(window.sum / static_cast<double>(window.count));
    band.lower.push_back(low);
    band.upper.push_back(high);
  }
  band.x = mean.x;
  plot.series = {band, mean};
  plot.log_y = true;
  return plot;
}

void addErrors(HtmlReport& report, const Evaluation& evaluation) {
  for (int axis = 0; axis < 3; ++axis)
    report.plot(errorPlot(
        std::string("Position error ") + kAxes[axis], "[m]", evaluation.errors,
        [axis](const PoseError& e) { return e.position_m[axis]; },
        [axis](const PoseError& e) { return e.position_sigma_m[axis]; }));
  for (int axis = 0; axis < 3; ++axis)
    report.plot(errorPlot(
        std::string("Orientation error about ") + kAxes[axis], "[deg]", evaluation.errors,
        [axis](const PoseError& e) { return degrees(e.rotation_rad[axis]); },
        [axis](const PoseError& e) { return degrees(e.rotation_sigma_rad[axis]); }));
}

nlohmann::ordered_json toJson(const Evaluation& e) {
  return {{"estimates", e.errors.size()},
          {"position_error_mean_m", e.position_m.mean},
          {"position_error_sigma_m", e.position_m.sigma},
          {"position_error_rms_m", e.position_rms_m},
          {"final_position_error_m", e.errors.back().position_m.norm()},
          {"angle_error_mean_deg", degrees(e.angle_rad.mean)},
          {"angle_error_sigma_deg", degrees(e.angle_rad.sigma)},
          {"angle_error_rms_deg", degrees(e.angle_rms_rad)},
          {"pose_nees_mean", e.nees_mean},
          {"share_within_3_sigma", e.within_3_sigma},
          {"reference_path_m", e.path_m},
          {"reference_laid_on_first_estimate", e.is_laid}};
}

nlohmann::ordered_json jsonList(const Vector3d& v) { return {v.x(), v.y(), v.z()}; }

nlohmann::ordered_json toJson(const PanelResult& panel) {
  const auto& [pose, covariance] = panel.T_odom_panel;
  const Vector6d sigma = covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
  const char* const states[] = {"known", "unseen", "estimated"};
  nlohmann::ordered_json json{
      {"name", panel.name},
      {"state", states[static_cast<int>(panel.state)]},
      {"position_odom_m", jsonList(pose.position)},
      {"yaw_pitch_roll_deg", jsonList(yawPitchRollFromRotation(pose.rotation) * degrees(1.0))},
      {"position_sigma_m", jsonList(sigma.head<3>())},
      {"angle_sigma_deg", jsonList(sigma.tail<3>() * degrees(1.0))}};
  json["moves"] = nlohmann::ordered_json::array();
  for (const PanelMove& move : panel.moves)
    json["moves"].push_back(
        {{"t_s", move.t_s},
         {"offset_m", jsonList(move.T_before_after.pose.position)},
         {"rotation_deg", jsonList(logSO3<double>(move.T_before_after.pose.rotation) * degrees(1.0))}});
  return json;
}

nlohmann::ordered_json toJson(const PathErrors& e) {
  return {{"sightings", e.count},
          {"position_mean_m", e.position_m.mean},
          {"position_sigma_m", e.position_m.sigma},
          {"angle_mean_deg", degrees(e.angle_rad.mean)},
          {"angle_sigma_deg", degrees(e.angle_rad.sigma)}};
}

nlohmann::ordered_json toJson(const TaskMeasures& measures) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  json["lost_sightings"] = measures.lost_sightings;
  if (measures.against_markers) json["against_markers"] = toJson(*measures.against_markers);
  if (measures.against_reference) json["against_reference"] = toJson(*measures.against_reference);
  if (measures.smoothness) {
    json["m_A"] = measures.smoothness->increments_r;
    json["mean_product_m2"] = measures.smoothness->mean_product_m2;
  }
  return json;
}

}  // namespace

Series pathSeries(const std::string& name, const std::vector<StampedPose>& poses, Series::Style style,
                  const std::vector<bool>& lost) {
  constexpr double kGap = std::numeric_limits<double>::quiet_NaN();
  Series series{.name = name, .style = style};
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const bool shown = i >= lost.size() || !lost[i];
    series.x.push_back(shown ? poses[i].T_odom_robot.position.x() : kGap);
    series.y.push_back(shown ? poses[i].T_odom_robot.position.y() : kGap);
  }
  return series;
}

Table errorsOverTime(const RecordingStory& recording, const TaskStory& task) {
  Table table{.header = {"time [s]", "filter [m]", "smoother [m]", "reference attitude + DVL [m]",
                         "plain integration [m]"},
              .rows = {}};
  if (!task.filter) return table;
  std::vector<double> times;
  for (const double t_s : {60.0, 100.0, 200.0, 400.0, 600.0, 1200.0, 3600.0, 36000.0})
    if (t_s < task.filter->errors.back().t_s + 1.5) times.push_back(t_s);
  const double end_s = task.filter->errors.back().t_s;
  if (times.empty() || end_s - times.back() > 1.5) times.push_back(end_s);
  for (const double wanted_s : times) {
    const double t_s = std::min(wanted_s, end_s);
    const Time time = after(recording.time_zero, t_s);
    table.rows.push_back({fixed(wanted_s, 0), fixed(positionErrorAt(task.filter->errors, t_s), 2),
                          task.smoother ? fixed(positionErrorAt(task.smoother->errors, t_s), 2) : "-",
                          fixed(deadReckoningErrorAt(recording.by_reference_attitude, recording, time), 2),
                          fixed(deadReckoningErrorAt(recording.plain, recording, time), 2)});
  }
  return table;
}

Table channelTable(const LocalizationSummary& summary) {
  Table table{.header = {"channel", "fused", "gated", "dof", "mean NIS", "95 % band of the mean",
                         "sigma, times the file's"},
              .rows = {}};
  for (const auto& [channel, s] : summary.channels)
    table.rows.push_back({nameOf(channel), std::to_string(s.fused), std::to_string(s.gated),
                          std::to_string(s.degrees_of_freedom), fixed(s.nis_mean, 3),
                          fixed(s.nis_band95_low, 3) + " to " + fixed(s.nis_band95_high, 3),
                          fixed(s.sigma_times, 2)});
  return table;
}

nlohmann::ordered_json toJson(const RecordingStory& recording) {
  nlohmann::ordered_json json;
  json["run"] = toJson(recording.run);
  json["recording"] = recording.recording.filename().string();
  if (!recording.reference_name.empty()) json["reference"] = recording.reference_name;
  json["images"] = recording.image_times.size();
  json["sightings"] = recording.marker_poses.size();
  json["recording_loss"] = nullptr;
  if (recording.loss)
    json["recording_loss"] = {{"at_byte", recording.loss->at_byte},
                              {"lost_bytes", recording.loss->lost_bytes},
                              {"lost_s", recording.loss->lost_seconds},
                              {"reason", recording.loss->reason}};
  json["remarks"] = recording.remarks;
  return json;
}

nlohmann::ordered_json toJson(const RecordingStory& recording, const TaskStory& story,
                              const TaskOutputs& outputs) {
  nlohmann::ordered_json json;
  json["task"] = story.options.task;
  json["improved"] = story.improved;
  json["states"] = story.options.bias_states ? kFullSize : kCoreSize;
  json["started"] = story.summary.started;
  if (!story.summary.started) json["failure"] = story.summary.failure;
  json["start"] = {{"source", story.summary.start_source}, {"t_s", story.summary.start_t_s}};
  json["end_t_s"] = story.summary.end_t_s;
  json["lost_since_s"] = nullptr;
  if (story.summary.lost_since_s) {
    json["lost_since_s"] = *story.summary.lost_since_s;
    json["lost_reason"] = story.summary.lost_reason;
  }
  json["panels"] = nlohmann::ordered_json::array();
  for (const PanelResult& panel : story.summary.panels) json["panels"].push_back(toJson(panel));
  json["samples"] = story.summary.samples;
  json["fused_late"] = story.summary.late_fused;
  json["channels"] = nlohmann::ordered_json::object();
  for (const auto& [channel, s] : story.summary.channels)
    json["channels"][nameOf(channel)] = {{"fused", s.fused},
                                         {"gated", s.gated},
                                         {"degrees_of_freedom", s.degrees_of_freedom},
                                         {"nis_mean", s.nis_mean},
                                         {"nis_mean_band95", {s.nis_band95_low, s.nis_band95_high}},
                                         {"sigma_times", s.sigma_times}};
  json["drive_times"] = {{"turning", story.summary.turning_times}, {"pushing", story.summary.pushing_times}};
  if (const auto last = outputs.last()) {
    const auto& x = last->state;
    json["final"] = {
        {"t_s", last->t_s},
        {"position_odom_m", jsonList(x.motion.position_odom)},
        {"position_sigma_m", jsonList(last->pose_covariance.diagonal().head<3>().cwiseMax(0.0).cwiseSqrt())},
        {"yaw_pitch_roll_deg", jsonList(yawPitchRollFromRotation(x.motion.R_odom_robot) * degrees(1.0))},
        {"velocity_robot_m_s", jsonList(x.motion.velocity_robot)},
        {"gyro_bias_rad_s", jsonList(x.gyro_bias_rad_s)},
        {"accelerometer_bias_m_s2", jsonList(x.accelerometer_bias_m_s2)},
        {"pressure_offset_pa", x.pressure_offset_pa},
        {"sea_floor_z_m", x.sea_floor_z_m}};
  }
  json["filter_measures"] = toJson(story.filter_measures);
  if (story.options.smooth) json["smoother_measures"] = toJson(story.smoother_measures);
  if (story.filter) {
    json["filter_error"] = toJson(*story.filter);
    if (story.smoother) json["smoother_error"] = toJson(*story.smoother);
    const Table table = errorsOverTime(recording, story);
    json["position_error_over_time"] = {{"columns", table.header}, {"rows", table.rows}};
  }
  json["event_counts"] = story.summary.event_counts;
  json["events"] = nlohmann::ordered_json::array();
  for (const Event& event : outputs.events())
    json["events"].push_back({{"t_s", event.t_s}, {"kind", event.kind}, {"text", event.text}});
  return json;
}

void writeReport(const std::filesystem::path& file, const RecordingStory& recording, const TaskStory& story,
                 const TaskOutputs& outputs) {
  HtmlReport report("Localization of " + recording.recording.filename().string());
  const LocalizationSummary& summary = story.summary;
  std::vector<std::pair<std::string, std::string>> values{
      {"task", story.options.task},
      {"duration", fixed(summary.end_t_s - summary.start_t_s, 1) + " s"},
      {"states", std::to_string(story.options.bias_states ? kFullSize : kCoreSize)}};
  if (story.filter) {
    values.emplace_back("mean position error", fixed(story.filter->position_m.mean, 3) + " ± " +
                                                   fixed(story.filter->position_m.sigma, 3) + " m");
    values.emplace_back("mean orientation error", fixed(degrees(story.filter->angle_rad.mean), 3) + " ± " +
                                                      fixed(degrees(story.filter->angle_rad.sigma), 3) + "°");
    values.emplace_back("pose NEES (6 expected)", fixed(story.filter->nees_mean, 2));
    values.emplace_back("inside 3 sigma", fixed(100.0 * story.filter->within_3_sigma, 2) + " %");
  }
  report.keyValues(values);
  report.paragraph("Start: " + summary.start_source + ".");
  if (recording.loss) report.warning("The recording is damaged: " + describe(*recording.loss) + ".");
  for (const std::string& remark : recording.remarks) report.warning(remark);

  addPath(report, recording, outputs);

  if (story.filter) {
    report.heading("Error against " + recording.reference_name);
    if (story.filter->is_laid)
      report.paragraph(
          "The reference is laid on the first estimate in the coordinates that no sensor tells: they are "
          "zero by "
          "definition.");
    report.table(errorsOverTime(recording, story), "Distance from the reference at fixed times.");
    addErrors(report, *story.filter);
  }

  report.heading("Are the sensors and the filter consistent?");
  report.paragraph(
      "The normalized innovation squared (NIS) of a consistent filter averages to the channel's degrees of "
      "freedom. "
      "Well below: the assumed noise is too large. Above: a sensor errs in a way that the model does not "
      "know.");
  report.table(channelTable(summary));
  for (const auto& [channel, nis] : outputs.nis())
    report.plot(nisPlot(channel, nis, summary.channels.at(channel).degrees_of_freedom));

  report.heading("What happened");
  Table events{.header = {"time [s]", "kind", "what"}, .rows = {}};
  for (const Event& event : outputs.events()) {
    if (events.rows.size() == 100) break;
    events.rows.push_back({fixed(event.t_s, 3), event.kind, event.text});
  }
  report.table(events,
               "The first hundred; all kinds are counted in result.json, every innovation is in "
               "innovations.csv.gz.");
  report.footer(recording.run);
  report.write(file);
}

}  // namespace fathom
