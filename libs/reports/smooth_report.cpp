#include "reports/smooth_report.h"

#include <nlohmann/json.hpp>

#include "core/text.h"
#include "effects/catalogue.h"
#include "inputs/batch_recording.h"
#include "report/html_report.h"

namespace fathom {
namespace {

nlohmann::ordered_json effectsJson(const BatchEstimate& estimate) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const EffectEstimate& e : estimate.effects)
    list.push_back({{"id", allEffects()[e.effect].id},
                    {"parameter", nameOfScalar(e)},
                    {"value", asNamed(parameterOf(e.scalar), e.value)},
                    {"sigma", sigmaAsNamed(parameterOf(e.scalar), e.value, e.sigma)}});
  return list;
}

/// A number, or a list of them.
nlohmann::ordered_json numbersOf(const Observation::Value& value) {
  if (value.size() == 1) return value[0];
  return std::vector<double>(value.begin(), value.end());
}

/// What each instrument is off by at the end, own unit.
nlohmann::ordered_json driftsJson(const BatchEstimate& e) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < e.state.drifts.size(); ++i) {
    const DriftTrack& track = e.state.drifts[i];
    list.push_back({{"channel", nameOf(track.channel)},
                    {"entries", track.instance.label(textOf(track.channel).label)},
                    {"at_the_end", numbersOf(track.knots.back())},
                    {"sigma", numbersOf(e.drift_sigma[i].knots.back())}});
  }
  return list;
}

nlohmann::ordered_json toJson(const SmoothedRecording& recording) {
  const BatchEstimate& e = recording.estimate;
  nlohmann::ordered_json json = fathom::toJson(recording.run);
  json["recording"] = recording.recording.string();
  json["succeeded"] = e.succeeded;
  json["failure"] = e.failure;
  json["start"] = recording.input.start.source;
  json["stopped"] = e.stopped;
  json["iterations"] = e.iterations;
  json["rounds"] = e.rounds;
  json["chi_square_half"] = e.cost;
  json["rows"] = e.rows;
  json["unknowns"] = e.unknowns;
  json["left_out"] = recording.input.data.left_out;
  json["effects"] = effectsJson(e);
  auto& channels = json["residuals"];
  for (const auto& [channel, r] : e.residuals)
    channels[nameOf(channel)] = {{"rows", r.rows},
                                 {"noise_scale", recording.noise_scale[indexOf(channel)]},
                                 {"rms_sigma", r.rms},
                                 {"expected_rms_sigma", r.expected_rms},
                                 {"down_weighted_rows", r.down_weighted}};
  const auto addDrift = [&](nlohmann::ordered_json& to, Channel channel, const char* value,
                            const char* sigma) {
    const auto track = e.state.driftOf(channel, {});
    if (!track) return;
    to[value] = numbersOf(e.state.drifts[*track].knots.back());
    to[sigma] = numbersOf(e.drift_sigma[*track].knots.back());
  };
  nlohmann::ordered_json final_bias;
  addDrift(final_bias, kChannel<Gyro>, "gyro_rad_s", "gyro_sigma_rad_s");
  addDrift(final_bias, kChannel<Accelerometer>, "accelerometer_m_s2", "accelerometer_sigma_m_s2");
  if (!final_bias.is_null()) json["final_bias"] = final_bias;
  addDrift(json, kChannel<Depth>, "pressure_offset_pa", "pressure_offset_sigma_pa");
  json["drifts"] = driftsJson(e);
  json["remarks"] = recording.remarks;
  return json;
}

Table residualTable(const SmoothedRecording& recording) {
  const BatchEstimate& estimate = recording.estimate;
  Table table{{"channel", "rows", "noise assumed", "rms [sigma]", "expected", "ratio", "down-weighted"}, {}};
  for (const auto& [channel, r] : estimate.residuals)
    table.rows.push_back({nameOf(channel), std::to_string(r.rows),
                          fixed(recording.noise_scale[indexOf(channel)], 2), fixed(r.rms, 3),
                          fixed(r.expected_rms, 3), fixed(r.rms / r.expected_rms, 3),
                          std::to_string(r.down_weighted)});
  return table;
}

Table effectTable(const BatchEstimate& estimate) {
  Table table{{"effect", "parameter", "value", "sigma", "value / sigma"}, {}};
  for (const EffectEstimate& e : estimate.effects)
    table.rows.push_back({std::string(allEffects()[e.effect].id), nameOfScalar(e),
                          print("%.6g", asNamed(parameterOf(e.scalar), e.value)),
                          print("%.2g", sigmaAsNamed(parameterOf(e.scalar), e.value, e.sigma)),
                          fixed(e.value / e.sigma, 1)});
  return table;
}

Plot pathPlot(const BatchEstimate& estimate) {
  Plot plot{.title = "Path from above", .x_label = "x in odom [m]", .y_label = "y in odom [m]"};
  plot.equal_axes = true;
  Series path{.name = "batch estimate"};
  if (!estimate.state.path.isSpline()) path.style = Series::Style::kPoints;
  for (const PathPose& pose : estimate.path) {
    path.x.push_back(pose.T_odom_robot.pose.position.x());
    path.y.push_back(pose.T_odom_robot.pose.position.y());
  }
  plot.series.push_back(path);
  return plot;
}

Plot sigmaPlot(const BatchEstimate& estimate) {
  Plot plot{
      .title = "What the estimate says of its own error", .x_label = "time [s]", .y_label = "sigma [m]"};
  const char* const names[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    Series series{.name = names[axis]};
    for (const PathPose& pose : estimate.path) {
      series.x.push_back(pose.t_s);
      series.y.push_back(std::sqrt(pose.T_odom_robot.covariance(axis, axis)));
    }
    plot.series.push_back(series);
  }
  return plot;
}

/// Whitened residuals over time: one colour a component; of markers, x and y.
Plot residualPlot(Channel channel, const Linearization& linear) {
  Plot plot{.title = "Residuals of " + nameOf(channel),
            .x_label = "time [s]",
            .y_label = "reading - prediction [sigma]"};
  const ChannelText& text = textOf(channel);
  const auto components = static_cast<std::size_t>(text.component_count);
  for (std::size_t c = 0; c < components; ++c)
    plot.series.push_back(
        {.name = components > 1 ? std::string(text.components[c]) : "", .style = Series::Style::kPoints});
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const RowInfo& row = linear.rows[i];
    if (row.channel != channel) continue;
    Series& series = plot.series[static_cast<std::size_t>(row.component) % components];
    series.x.push_back(row.t_s);
    series.y.push_back(linear.residual[static_cast<Eigen::Index>(i)]);
  }
  return plot;
}

}  // namespace

void writeSmoothReport(const SmoothedRecording& recording, const std::filesystem::path& folder) {
  writeJson(folder / "result.json", toJson(recording));
  const BatchEstimate& e = recording.estimate;
  HtmlReport report("Batch estimate of " + recording.recording.filename().string());
  if (!e.succeeded) report.warning("No estimate: " + e.failure);
  report.keyValues({{"rows", std::to_string(e.rows)},
                    {"unknowns", std::to_string(e.unknowns)},
                    {"steps", std::to_string(e.iterations)},
                    {"markers", std::to_string(recording.input.data.markers.size())}});
  report.paragraph("Path, biases, offsets and effects together by maximum a posteriori. Started from: " +
                   recording.input.start.source + ".");
  for (const std::string& remark : recording.remarks) report.warning(remark);
  if (!e.effects.empty()) {
    report.heading("Effects");
    report.table(effectTable(e), "Estimated, with one sigma");
  }
  report.heading("Residuals");
  report.table(residualTable(recording),
               "In units of the assumed noise, which is so many times the stated one. Expected: what the "
               "estimate leaves of such noise where nothing "
               "is left out of the model. A ratio beyond 1 is noise that is larger than assumed, or a "
               "mismatch.");
  for (const auto& [channel, residual] : e.residuals)
    if (channel != kChannel<Prior>) report.plot(residualPlot(channel, recording.linear));
  report.heading("Path");
  report.plot(pathPlot(e));
  report.plot(sigmaPlot(e));
  report.footer(recording.run);
  report.write(folder / "report.html");
}

}  // namespace fathom
