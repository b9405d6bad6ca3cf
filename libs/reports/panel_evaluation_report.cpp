#include "reports/panel_evaluation_report.h"

#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files.h"
#include "core/text.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kAveraged = "mean of markers (paper)";
constexpr const char* kJoint = "joint";
constexpr double kLowNees = 4, kHighNees = 9;

std::string ofViews(std::size_t count, std::size_t views) {
  return std::to_string(count) + " (" +
         fixed(100.0 * static_cast<double>(count) / static_cast<double>(views), 1) + " %)";
}

// ---- tables

std::vector<std::string> methodRow(const std::string& water, const std::string& name, const MethodSummary& m,
                                   std::size_t views) {
  const ErrorSummary &p = m.position_m, &a = m.angle_rad;
  return {water,
          name,
          fixed(1e3 * p.mean, 3),
          fixed(1e3 * p.sigma, 3),
          fixed(1e3 * p.median, 3),
          fixed(1e3 * p.largest, 2),
          fixed(degrees(a.mean), 3),
          fixed(degrees(a.sigma), 3),
          fixed(degrees(a.median), 3),
          fixed(degrees(a.largest), 2),
          ofViews(m.no_pose, views),
          std::to_string(m.flipped)};
}

Table binTable(const std::vector<BinSummary>& bins, const char* quantity, double unit, int decimals) {
  Table table{{quantity, "views", "both", "paper [mm]", "joint [mm]", "ratio", "paper [deg]", "joint [deg]",
               "ratio", "no pose", "paper flips", "joint flips", "ambiguous", "NEES"},
              {}};
  for (const auto& [bin, s] : bins)
    table.rows.push_back(
        {fixed(bin.low / unit, decimals) + " to " + fixed(bin.high / unit, decimals), std::to_string(s.views),
         std::to_string(s.joint.position_m.count), fixed(1e3 * s.averaged.position_m.mean, 3),
         fixed(1e3 * s.joint.position_m.mean, 3), fixed(s.position_ratio, 1),
         fixed(degrees(s.averaged.angle_rad.mean), 3), fixed(degrees(s.joint.angle_rad.mean), 3),
         fixed(s.angle_ratio, 1), std::to_string(s.joint.no_pose), std::to_string(s.averaged.flipped),
         std::to_string(s.joint.flipped), std::to_string(s.ambiguous), fixed(s.nees.mean, 2)});
  return table;
}

// ---- plots

using BinValue = double (*)(const PanelSummary&);

Series lineOver(const std::vector<BinSummary>& bins, double unit, const std::string& name, BinValue value,
                Series::Style style, const std::string& color) {
  Series series{.name = name, .style = style, .color = color};
  for (const auto& [bin, summary] : bins) {
    series.x.push_back(bin.middle() / unit);
    series.y.push_back(value(summary));
  }
  return series;
}

std::string colorOf(std::size_t water) { return kPalette[water % std::size(kPalette)]; }

using Bins = std::vector<std::vector<BinSummary>>;  ///< one list a water

/// Both methods and every water over one quantity.
Plot comparison(const PanelEvaluationStory& story, const Bins& bins, const std::string& title,
                const std::string& x_label, double unit, const std::string& y_label, BinValue averaged,
                BinValue joint) {
  Plot plot{.title = title, .x_label = x_label, .y_label = y_label};
  plot.log_y = true;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const std::string& water = story.waters[i].name;
    plot.series.push_back(
        lineOver(bins[i], unit, water + ", paper", averaged, Series::Style::kDashed, colorOf(i)));
    plot.series.push_back(
        lineOver(bins[i], unit, water + ", joint", joint, Series::Style::kLine, colorOf(i)));
  }
  return plot;
}

Plot positionPlot(const PanelEvaluationStory& story, const Bins& bins, const std::string& x_label,
                  double unit) {
  return comparison(
      story, bins, "Mean position error", x_label, unit, "[m]",
      [](const PanelSummary& s) { return s.averaged.position_m.mean; },
      [](const PanelSummary& s) { return s.joint.position_m.mean; });
}

Plot anglePlot(const PanelEvaluationStory& story, const Bins& bins, const std::string& x_label, double unit) {
  return comparison(
      story, bins, "Mean angle error", x_label, unit, "[deg]",
      [](const PanelSummary& s) { return degrees(s.averaged.angle_rad.mean); },
      [](const PanelSummary& s) { return degrees(s.joint.angle_rad.mean); });
}

Plot neesPlot(const PanelEvaluationStory& story, const Bins& bins, const std::string& x_label, double unit) {
  Plot plot{
      .title = "Honesty of the joint solution's covariance", .x_label = x_label, .y_label = "mean NEES"};
  Series band{.name = "4 to 9", .style = Series::Style::kBand};
  if (!bins.empty())
    for (const auto& [bin, summary] : bins.front()) {
      band.x.push_back(bin.middle() / unit);
      band.lower.push_back(kLowNees);
      band.upper.push_back(kHighNees);
    }
  plot.series.push_back(band);
  for (std::size_t i = 0; i < bins.size(); ++i)
    plot.series.push_back(lineOver(
        bins[i], unit, story.waters[i].name, [](const PanelSummary& s) { return s.nees.mean; },
        Series::Style::kLine, colorOf(i)));
  return plot;
}

Bins allByRange(const PanelEvaluationStory& story) {
  Bins bins;
  for (const auto& water : story.waters) bins.push_back(byRange(water.views, story.options.ranges));
  return bins;
}

Bins allByTilt(const PanelEvaluationStory& story) {
  Bins bins;
  for (const auto& water : story.waters) bins.push_back(byTilt(water.views, story.options.ranges));
  return bins;
}

// ---- report.html

std::string howViewsWereMade(const PanelEvaluationStory& story) {
  const PanelEvaluationOptions& o = story.options;
  return std::to_string(o.views) + " views of " + story.map + " in each water, drawn with seed " +
         std::to_string(o.seed) + ": " + fixed(o.ranges.nearest_m, 2) + " to " +
         fixed(o.ranges.farthest_m, 2) + " m from the panel's centre, tilted by " +
         fixed(degrees(o.ranges.smallest_tilt_rad), 0) + " to " +
         fixed(degrees(o.ranges.largest_tilt_rad), 0) + " degrees to any side, rolled by up to " +
         fixed(degrees(o.ranges.largest_roll_rad), 0) + " degrees, aimed up to " +
         fixed(o.ranges.largest_aim_m, 2) +
         " m beside the centre. The simulator's forward model makes the images; markers are found by " +
         std::string(nameOf(o.backend)) + (o.fallback ? ", what it misses by the other backend" : "") +
         ", and both methods have the same corners. " +
         (story.known.given() ? ""
                              : "Map, "
                                "calibration and mounting are exact, and the lens does not blur: what errs "
                                "here is the images' "
                                "noise and the "
                                "estimators.");
}

HtmlReport reportOf(const PanelEvaluationStory& story) {
  HtmlReport report("The panel's pose from its markers: task T_P");
  std::vector<std::pair<std::string, std::string>> headline;
  for (const auto& water : story.waters) {
    const PanelSummary s = summaryOf(water.views);
    headline.emplace_back(water.name + ", joint", fixed(1e3 * s.joint.position_m.mean, 3) + " mm, " +
                                                      fixed(degrees(s.joint.angle_rad.mean), 2) + "°");
    headline.emplace_back(water.name + ", paper", fixed(1e3 * s.averaged.position_m.mean, 3) + " mm, " +
                                                      fixed(degrees(s.averaged.angle_rad.mean), 2) + "°");
  }
  report.keyValues(headline);
  report.paragraph(howViewsWereMade(story));
  if (story.known.given())
    report.paragraph(story.known.inWords() + print(" They are in the images as they are at %g s; the "
                                                   "estimators know nothing of them.",
                                                   story.options.t_s));
  report.table(
      errorTable(story),
      "Errors of T_camera_panel, millimetres and degrees, over the views in which both methods have a "
      "pose. Flipped: more than 30 degrees off, or nearer to the true pose's mirror image.");
  report.table(
      honestyTable(story),
      "NEES: the squared error measured by its stated covariance, 6 expected; poses said to be ambiguous "
      "left out.");
  const Bins ranges = allByRange(story), tilts = allByTilt(story);
  report.heading("Against range");
  report.plot(positionPlot(story, ranges, "range [m]", 1.0));
  report.plot(anglePlot(story, ranges, "range [m]", 1.0));
  report.plot(neesPlot(story, ranges, "range [m]", 1.0));
  report.heading("Against tilt");
  report.plot(positionPlot(story, tilts, "tilt [deg]", radians(1)));
  report.plot(anglePlot(story, tilts, "tilt [deg]", radians(1)));
  report.plot(neesPlot(story, tilts, "tilt [deg]", radians(1)));
  for (std::size_t i = 0; i < story.waters.size(); ++i) {
    report.heading("In water `" + story.waters[i].name + "`");
    report.paragraph(story.waters[i].file);
    report.table(binTable(ranges[i], "range [m]", 1.0, 2), "Mean errors by range");
    report.table(binTable(tilts[i], "tilt [deg]", radians(1), 0), "Mean errors by tilt");
  }
  report.footer(story.run);
  return report;
}

// ---- result.json

Json toJson(const ErrorSummary& s, double unit) {
  return {{"mean", s.mean / unit},
          {"sigma", s.sigma / unit},
          {"median", s.median / unit},
          {"largest", s.largest / unit}};
}

Json toJson(const MethodSummary& m) {
  return {{"position_error_m", toJson(m.position_m, 1.0)},
          {"angle_error_deg", toJson(m.angle_rad, radians(1))},
          {"views_without_pose", m.no_pose},
          {"flipped", m.flipped}};
}

Json toJson(const PanelSummary& s) {
  return {{"views", s.views},
          {"views_compared", s.joint.position_m.count},
          {"mean_of_markers", toJson(s.averaged)},
          {"joint", toJson(s.joint)},
          {"position_ratio", s.position_ratio},
          {"angle_ratio", s.angle_ratio},
          {"said_ambiguous", s.ambiguous},
          {"flipped_and_not_said_ambiguous", s.flipped_unsaid},
          {"nees_views", s.nees.count},
          {"nees_mean", s.nees.mean},
          {"nees_median", s.nees.median}};
}

Json toJson(const std::vector<BinSummary>& bins, const std::string& unit_name, double unit) {
  Json list = Json::array();
  for (const auto& [bin, summary] : bins) {
    Json entry{{"from_" + unit_name, bin.low / unit}, {"to_" + unit_name, bin.high / unit}};
    entry.update(toJson(summary));
    list.push_back(entry);
  }
  return list;
}

Json toJson(const PanelEvaluationStory& story) {
  const PanelEvaluationOptions& o = story.options;
  Json json;
  json["run"] = toJson(story.run);
  json["map"] = story.map;
  json["vehicle"] = story.vehicle;
  if (story.known.given()) {
    json["calibration"] = toJson(story.known);
    json["effects_at_s"] = o.t_s;
  }
  json["views"] = {{"count", o.views},
                   {"nearest_m", o.ranges.nearest_m},
                   {"farthest_m", o.ranges.farthest_m},
                   {"smallest_tilt_deg", degrees(o.ranges.smallest_tilt_rad)},
                   {"largest_tilt_deg", degrees(o.ranges.largest_tilt_rad)},
                   {"largest_roll_deg", degrees(o.ranges.largest_roll_rad)},
                   {"largest_aim_m", o.ranges.largest_aim_m}};
  json["backend"] = std::string(nameOf(o.backend));
  json["fallback"] = o.fallback;
  json["preprocess"] = std::string(nameOf(o.preprocess));
  json["waters"] = Json::array();
  for (const auto& water : story.waters) {
    Json entry{{"name", water.name}, {"file", water.file}, {"all", toJson(summaryOf(water.views))}};
    entry["by_range"] = toJson(byRange(water.views, o.ranges), "m", 1.0);
    entry["by_tilt"] = toJson(byTilt(water.views, o.ranges), "deg", radians(1));
    json["waters"].push_back(entry);
  }
  return json;
}

// ---- views.csv

void writeRow(const std::string& water, const PanelViewResult& r, std::ostream& csv) {
  const CameraView& v = r.view;
  csv << water
      << print(",%zu,%.6f,%.5f,%.5f,%.5f,%.6f,%.6f,%zu,%zu", static_cast<std::size_t>(v.number), v.range_m,
               degrees(v.tilt_rad), degrees(v.azimuth_rad), degrees(v.roll_rad), v.aim_panel.x(),
               v.aim_panel.y(), r.markers_whole, r.markers_found)
      << print(",%.6f,%.5f,%d", r.averaged.position_m, degrees(r.averaged.angle_rad), r.averaged.flipped)
      << print(",%.6f,%.5f,%d,%d", r.joint.position_m, degrees(r.joint.angle_rad), r.joint.flipped,
               r.ambiguous)
      << print(",%d,%.4f,%.4f,%.4f", r.inliers, r.rms_px, r.sigma_scale, r.nees);
  for (const Vector6d* vector : {&r.error, &r.sigma})
    for (Eigen::Index i = 0; i < 6; ++i) csv << print(",%.7f", (*vector)[i]);
  csv << ',' << r.why_not << '\n';
}

std::string viewsCsv(const PanelEvaluationStory& story) {
  std::ostringstream csv;
  csv << "water,view,range_m,tilt_deg,azimuth_deg,roll_deg,aim_x_m,aim_y_m,markers_whole,markers_found,"
         "paper_position_error_m,paper_angle_error_deg,paper_flipped,"
         "joint_position_error_m,joint_angle_error_deg,joint_flipped,ambiguous,"
         "inliers,rms_px,sigma_scale,nees,"
         "error_x_m,error_y_m,error_z_m,error_rx_rad,error_ry_rad,error_rz_rad,"
         "sigma_x_m,sigma_y_m,sigma_z_m,sigma_rx_rad,sigma_ry_rad,sigma_rz_rad,why_no_joint_pose\n";
  for (const auto& water : story.waters)
    for (const auto& result : water.views) writeRow(water.name, result, csv);
  return csv.str();
}

}  // namespace

Table errorTable(const PanelEvaluationStory& story) {
  Table table{{"water", "method", "mean [mm]", "sigma", "median", "max", "mean [deg]", "sigma", "median",
               "max", "no pose", "flipped"},
              {}};
  for (const auto& water : story.waters) {
    const PanelSummary s = summaryOf(water.views);
    table.rows.push_back(methodRow(water.name, kAveraged, s.averaged, s.views));
    table.rows.push_back(methodRow(water.name, kJoint, s.joint, s.views));
  }
  return table;
}

Table honestyTable(const PanelEvaluationStory& story) {
  Table table{{"water", "position, paper / joint", "angle, paper / joint", "said ambiguous",
               "flipped, not said", "mean NEES", "median NEES"},
              {}};
  for (const auto& water : story.waters) {
    const PanelSummary s = summaryOf(water.views);
    table.rows.push_back({water.name, fixed(s.position_ratio, 1), fixed(s.angle_ratio, 1),
                          ofViews(s.ambiguous, s.views), std::to_string(s.flipped_unsaid),
                          fixed(s.nees.mean, 2), fixed(s.nees.median, 2)});
  }
  return table;
}

void writeOutputs(const PanelEvaluationStory& story, const fs::path& folder) {
  const std::string csv = viewsCsv(story);
  const HtmlReport report = reportOf(story);
  writeTextFile(folder / "views.csv", csv);
  report.write(folder / "report.html");
  writeJson(folder / "result.json", toJson(story));
}

}  // namespace fathom
