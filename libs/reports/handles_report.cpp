#include "reports/handles_report.h"

#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/files.h"
#include "core/text.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kBin_deg = 2, kLastBin_deg = 90;

const Handle& handleOf(const std::vector<PanelMap>& panels, std::size_t panel, std::size_t handle) {
  return panels.at(panel).handles.at(handle);
}

std::string nameOf(const HandlesStory& story, std::size_t panel, std::size_t handle) {
  const std::string id = handleOf(story.panels, panel, handle).id;
  return story.panels.size() > 1 ? story.panels[panel].name + " " + id : id;
}

/// What a handle truly is, or was read to be; not a number where that is not known.
double referenceOf(const HandlesStory& story, const HandleSight& sight, bool of_simulated) {
  if (of_simulated) return handleOf(story.panels, sight.panel, sight.handle).angle_rad;
  return story.true_panels.empty() ? std::nan("")
                                   : handleOf(story.true_panels, sight.panel, sight.handle).angle_rad;
}

/// Errors in degrees, without sign.
std::vector<double> errorsOf(const HandlesStory& story, bool of_simulated, bool chain) {
  std::vector<double> errors;
  for (const HandleSight& sight : of_simulated ? story.simulated : story.recorded) {
    const double angle = chain ? sight.chain_angle_rad : sight.angle_rad;
    const double reference = referenceOf(story, sight, of_simulated);
    if (!std::isfinite(angle) || !std::isfinite(reference)) continue;
    const double symmetry =
        chain ? sight.chain_symmetry_rad : symmetryOf(handleOf(story.panels, sight.panel, sight.handle).kind);
    errors.push_back(degrees(std::abs(angleDifference(angle, reference, symmetry))));
  }
  return errors;
}

Series histogramOf(const std::vector<double>& errors, const std::string& name, Series::Style style,
                   const std::string& color) {
  Series series{.name = name, .style = style, .color = color};
  for (double low = 0; low < kLastBin_deg; low += kBin_deg) {
    double inside = 0;
    for (const double e : errors) inside += e >= low && e < low + kBin_deg ? 1 : 0;
    series.x.push_back(low + kBin_deg / 2);
    series.y.push_back(inside > 0 ? inside / static_cast<double>(errors.size()) : std::nan(""));
  }
  return series;
}

Plot errorPlot(const HandlesStory& story) {
  Plot plot{.title = "Angle errors", .x_label = "error [deg]", .y_label = "share of angles"};
  plot.log_y = true;
  for (const bool simulated : {false, true})
    for (const bool chain : {false, true}) {
      const std::vector<double> errors = errorsOf(story, simulated, chain);
      if (errors.empty()) continue;
      plot.series.push_back(histogramOf(
          errors,
          std::string(simulated ? "simulated" : "recorded") + (chain ? ", paper's chain" : ", stated"),
          chain ? Series::Style::kDashed : Series::Style::kLine, kPalette[simulated ? 1 : 0]));
    }
  return plot;
}

double timeOf(const HandlesStory& story, std::size_t image) {
  return secondsBetween(story.images.posed.front().time, story.images.posed[image].time);
}

Plot anglePlot(const HandlesStory& story, std::size_t panel) {
  Plot plot{.title = "Angles over the recording", .x_label = "time [s]", .y_label = "angle [deg]"};
  for (std::size_t h = 0; h < story.panels[panel].handles.size(); ++h) {
    Series series{.name = nameOf(story, panel, h), .style = Series::Style::kErrorBars};
    for (const HandleSight& sight : story.recorded) {
      if (sight.panel != panel || sight.handle != h || !sight.confident) continue;
      series.x.push_back(timeOf(story, sight.image));
      series.y.push_back(degrees(sight.angle_rad));
      series.lower.push_back(degrees(sight.angle_rad - 2 * sight.sigma_rad));
      series.upper.push_back(degrees(sight.angle_rad + 2 * sight.sigma_rad));
    }
    if (!series.x.empty()) plot.series.push_back(series);
  }
  return plot;
}

std::string handlesCsv(const HandlesStory& story) {
  std::ostringstream csv;
  csv << "images,time_s,file,panel,handle,confident,angle_deg,sigma_deg,chain_angle_deg,chain_symmetry_deg,"
         "disagreement_deg,average_deg,average_sigma_deg,why_not\n";
  const auto add = [&](const std::vector<HandleSight>& sights, const char* images) {
    for (const HandleSight& s : sights) {
      const PosedImage& posed = story.images.posed[s.image];
      csv << images << print(",%.6f,", timeOf(story, s.image)) << posed.image.file.filename().string() << ','
          << story.panels[s.panel].name << ',' << handleOf(story.panels, s.panel, s.handle).id
          << print(",%d,%.4f,%.4f,%.3f,%.1f,%.3f,%.4f,%.4f,", s.confident, degrees(s.angle_rad),
                   degrees(s.sigma_rad), degrees(s.chain_angle_rad), degrees(s.chain_symmetry_rad),
                   degrees(s.disagreement_rad), degrees(s.average_rad), degrees(s.average_sigma_rad))
          << s.why_not << '\n';
    }
  };
  add(story.recorded, "recorded");
  add(story.simulated, "simulated");
  return csv.str();
}

Json toJson(const HandlesStory& story) {
  Json json;
  json["run"] = toJson(story.run);
  json["recording"] = story.recording;
  json["map"] = story.map;
  json["vehicle"] = story.vehicle;
  json["water"] = story.water;
  json["window"] = story.window;
  json["images"] = story.images.posed.size();
  json["images_without_pose"] = story.images.unposed.size();
  json["handles"] = Json::array();
  for (const HandleState& state : story.states) {
    Json handle{{"panel", story.panels[state.panel].name},
                {"id", handleOf(story.panels, state.panel, state.handle).id},
                {"images", state.images},
                {"confident", state.confident},
                {"contradicted", state.contradicted},
                {"angle_deg", degrees(state.angle_rad)},
                {"sigma_deg", degrees(state.sigma_rad)}};
    if (!story.true_panels.empty())
      handle["true_deg"] = degrees(handleOf(story.true_panels, state.panel, state.handle).angle_rad);
    json["handles"].push_back(handle);
  }
  json["remarks"] = story.remarks;
  return json;
}

HtmlReport reportOf(const HandlesStory& story, const std::vector<PanelMap>& as_mapped) {
  HtmlReport report("The panel's handles: task T_H");
  report.paragraph(story.recording + ": " + std::to_string(story.images.posed.size()) +
                   " images whose markers tell where the panel is, " +
                   std::to_string(story.images.unposed.size()) + " without.");
  report.table(stateTable(story, as_mapped), "Angles, degrees");
  for (const std::string& remark : story.remarks) report.paragraph(remark);
  for (std::size_t panel = 0; panel < story.panels.size(); ++panel)
    if (const Plot plot = anglePlot(story, panel); !plot.series.empty())
      report.plot(plot, "Angles that are stated, with twice their sigmas.");
  if (const Plot plot = errorPlot(story); !plot.series.empty())
    report.plot(plot,
                "Recorded: against the true angles, where they are known. Simulated: images from the same "
                "viewpoints, with the angles that were read.");
  if (const Table unread = unreadTable(story); !unread.rows.empty())
    report.table(unread, "Where no angle is stated");
  if (!story.pictures.empty()) report.heading("Evidence");
  for (const fs::path& picture : story.pictures)
    report.picture(
        readTextFile(picture),
        picture.filename().string() +
            ": the image and the handle's region; the region turned to the front, from black to white; "
            "contour (magenta) and superellipse; edges and the most prominent straight one; close-up; "
            "rendering "
            "at the angle that was read.");
  report.footer(story.run);
  return report;
}

}  // namespace

Table stateTable(const HandlesStory& story, const std::vector<PanelMap>& as_mapped) {
  Table table{{"handle", "kind", "in the map", "read", "sigma", "images", "with an angle", "contradicted"},
              {}};
  if (!story.true_panels.empty()) table.header.insert(table.header.end(), {"true", "off"});
  for (const HandleState& state : story.states) {
    const Handle& mapped = handleOf(as_mapped, state.panel, state.handle);
    std::vector<std::string> row{
        nameOf(story, state.panel, state.handle), std::string(fathom::nameOf(mapped.kind)),
        fixed(degrees(mapped.angle_rad), 1),      fixed(degrees(state.angle_rad), 2),
        fixed(degrees(state.sigma_rad), 2),       std::to_string(state.images),
        std::to_string(state.confident),          std::to_string(state.contradicted)};
    if (!story.true_panels.empty()) {
      const double truth = handleOf(story.true_panels, state.panel, state.handle).angle_rad;
      row.push_back(fixed(degrees(truth), 2));
      row.push_back(fixed(degrees(angleDifference(state.angle_rad, truth, symmetryOf(mapped.kind))), 2));
    }
    table.rows.push_back(row);
  }
  return table;
}

Table unreadTable(const HandlesStory& story) {
  std::map<std::pair<std::string, std::string>, std::size_t> reasons;
  for (const HandleSight& sight : story.recorded)
    if (!sight.confident) ++reasons[{nameOf(story, sight.panel, sight.handle), sight.why_not}];
  Table table{{"handle", "why", "images"}, {}};
  for (const auto& [key, count] : reasons)
    table.rows.push_back({key.first, key.second, std::to_string(count)});
  return table;
}

void writeOutputs(const HandlesStory& story, const std::vector<PanelMap>& as_mapped, const fs::path& folder) {
  writeTextFile(folder / "handles.csv", handlesCsv(story));
  writeJson(folder / "result.json", toJson(story));
  reportOf(story, as_mapped).write(folder / "report.html");
}

}  // namespace fathom
