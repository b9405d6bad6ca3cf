#include "reports/sil_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/text.h"
#include "evaluation/statistics.h"
#include "image_files/encode_image.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// Since the recording's first image, paired or not.
double seconds(const SilStory& story, const Time& time) {
  const auto& [pairs, unpaired] = std::tie(story.results.pairs, story.results.unpaired);
  Time first = pairs.front().posed.time;
  if (!unpaired.empty()) first = std::min(first, unpaired.front().time);
  return secondsBetween(first, time);
}

/// A column's values, of those pairs that have one.
std::vector<double> valuesOf(const SilStory& story, std::size_t column) {
  std::vector<double> values;
  for (const SilPairResult& pair : story.results.pairs)
    if (const auto& value = pair.record.values[column]) values.push_back(*value);
  return values;
}

std::map<std::string, std::size_t> reasonsOf(const SilStory& story) {
  std::map<std::string, std::size_t> reasons;
  for (const UnposedImage& image : story.results.unpaired) ++reasons[image.why];
  return reasons;
}

/// Of a measure that could not be taken of some pairs: why, and of how many.
std::map<std::string, std::size_t> unmeasured(const SilStory& story, std::size_t measure) {
  std::map<std::string, std::size_t> reasons;
  for (const SilPairResult& pair : story.results.pairs)
    if (const auto& why = pair.record.unmeasured[measure]; !why.empty()) ++reasons[why];
  return reasons;
}

std::string nameWithUnit(const SilColumn& column, const char* before, const char* after) {
  return column.unit == "1" ? column.name : column.name + before + column.unit + after;
}

std::string regionText(const SilStory& story) {
  if (story.sea_floor)
    return print("the whole picture: the recording says where its sea floor is (z = %g m)",
                 story.sea_floor->z_m);
  return "the panels' pixels: nothing is known of what is around them, so there the recorded image is "
         "replaced by the simulated one before measures that look at all of a picture (fsim, fsimc, ssim)";
}

// ---- files

std::string measuresCsv(const SilStory& story) {
  std::string text = "time_s,unix_time_s,number,file,range_m,view_angle_deg,panel_share";
  for (const SilColumn& column : story.results.columns)
    text.append(",").append(nameWithUnit(column, "_", ""));
  text += "\n";
  for (const auto& [posed, record] : story.results.pairs) {
    text += print("%.6f,%.6f,%zu,", seconds(story, posed.time), toUnixSeconds(posed.time), posed.number) +
            csvField(posed.image.file.filename().string()) +
            print(",%.5f,%.3f,%.5f", record.range_m, degrees(record.view_angle_rad), record.panel_share);
    for (const auto& value : record.values) text += value ? print(",%.6g", *value) : ",";
    text += "\n";
  }
  return text;
}

std::string unpairedCsv(const SilStory& story) {
  std::string text = "time_s,unix_time_s,number,file,why\n";
  for (const UnposedImage& image : story.results.unpaired)
    text += print("%.6f,%.6f,%zu,", seconds(story, image.time), toUnixSeconds(image.time), image.number) +
            csvField(image.file.filename().string()) + "," + csvField(image.why) + "\n";
  return text;
}

Json jsonOfSummary(const ErrorSummary& summary) {
  return {{"count", summary.count},
          {"mean", summary.mean},
          {"sigma", summary.sigma},
          {"median", summary.median},
          {"largest", summary.largest}};
}

Json jsonOf(const SilStory& story) {
  const SilResults& results = story.results;
  Json json;
  json["run"] = toJson(story.run);
  json["recording"] = story.recording;
  json["panel_map"] = story.map;
  json["vehicle"] = story.vehicle;
  json["water"] = story.water;
  json["calibration"] = story.calibration.empty() ? Json(nullptr) : Json(story.calibration);
  json["sea_floor_z_m"] = story.sea_floor ? Json(story.sea_floor->z_m) : Json(nullptr);
  json["noise"] = story.options.pairs.noise;
  json["every"] = story.options.every;
  json["pairs"] = results.pairs.size();
  json["unpaired"] = results.unpaired.size();
  for (const auto& [why, count] : reasonsOf(story)) json["unpaired_by_reason"][why] = count;
  for (std::size_t i = 0; i < results.columns.size(); ++i) {
    Json& entry = json["measures"][results.columns[i].name];
    entry["unit"] = results.columns[i].unit;
    entry["better"] = results.columns[i].better == Better::higher ? "higher" : "lower";
    entry.update(jsonOfSummary(summaryOf(valuesOf(story, i))));
  }
  for (std::size_t i = 0; i < results.measures.size(); ++i)
    for (const auto& [why, count] : unmeasured(story, i))
      json["unmeasured"][results.measures[i]][why] = count;
  json["remarks"] = story.remarks;
  return json;
}

// ---- report

Plot plotOf(const SilStory& story, std::size_t column, bool over_range) {
  const SilColumn& c = story.results.columns[column];
  Plot plot{.title = c.name + (over_range ? " over range" : " over time"),
            .x_label = over_range ? "range [m]" : "time [s]",
            .y_label = nameWithUnit(c, " [", "]")};
  Series series{.style = Series::Style::kPoints};
  for (const auto& [posed, record] : story.results.pairs) {
    series.x.push_back(over_range ? record.range_m : seconds(story, posed.time));
    series.y.push_back(record.values[column].value_or(kNoValue));
  }
  plot.height_px = 300;
  plot.series.push_back(std::move(series));
  return plot;
}

void addMeasures(const SilStory& story, HtmlReport& report) {
  const SilResults& results = story.results;
  report.heading("Measures");
  report.table(measureTable(story),
               "sd: standard deviation over pairs. Better: towards which side images are more alike.");
  for (std::size_t i = 0; i < results.measures.size(); ++i)
    for (const auto& [why, count] : unmeasured(story, i))
      report.paragraph(print("%s has no value for %zu pairs: ", results.measures[i].c_str(), count) + why +
                       ".");
  for (std::size_t i = 0; i < results.columns.size(); ++i) {
    if (valuesOf(story, i).empty()) continue;
    report.subheading(results.columns[i].name);
    report.plot(plotOf(story, i, false));
    report.plot(plotOf(story, i, true));
  }
}

HtmlReport reportOf(const SilStory& story) {
  const SilResults& results = story.results;
  HtmlReport report("Simulation in the loop: " + fs::path(story.recording).filename().string());
  std::vector<std::pair<std::string, std::string>> keys{
      {"pairs", std::to_string(results.pairs.size())},
      {"images not paired", std::to_string(results.unpaired.size())}};
  for (std::size_t i = 0; i < results.columns.size() && i < 2; ++i)
    keys.emplace_back("mean " + results.columns[i].name, fixed(summaryOf(valuesOf(story, i)).mean, 4));
  report.keyValues(keys);
  for (const std::string& remark : story.remarks) report.warning(remark);
  report.paragraph(
      "Each recorded image beside what the forward model makes of the same moment: the robot's pose from "
      "the panel's markers, the panel of " +
      story.map + " rendered from there, seen through the water of " + story.water + ", " +
      (story.options.pairs.noise ? "with" : "without") +
      " the camera's noise, and through JPEG where the recorded image is one. Compared is " +
      regionText(story) + ".");
  addMeasures(story, report);
  report.heading("Pairs");
  report.picture(
      jpegBytes(story.sheet, 85),
      "Pairs spread over range. Residual: recorded minus simulated in linear light (luminance), blue " +
          print("down to -%g, white 0, orange up to +%g", story.options.residual.full_scale,
                story.options.residual.full_scale) +
          " of the camera's full scale; gray is not compared.");
  if (!results.unpaired.empty()) {
    report.heading("Images that are not paired");
    report.table(unpairedTable(story), "One by one in unpaired.csv.");
  }
  report.footer(story.run);
  return report;
}

}  // namespace

Table measureTable(const SilStory& story) {
  Table table{{"measure", "better", "pairs", "mean", "sd", "median", "smallest", "largest"}, {}};
  for (std::size_t i = 0; i < story.results.columns.size(); ++i) {
    const SilColumn& column = story.results.columns[i];
    const std::vector<double> values = valuesOf(story, i);
    const ErrorSummary summary = summaryOf(values);
    const double smallest = values.empty() ? kNoValue : *std::min_element(values.begin(), values.end());
    table.rows.push_back({nameWithUnit(column, " [", "]"),
                          column.better == Better::higher ? "higher" : "lower", std::to_string(summary.count),
                          fixed(summary.mean, 4), fixed(summary.sigma, 4), fixed(summary.median, 4),
                          fixed(smallest, 4), fixed(summary.largest, 4)});
  }
  return table;
}

Table unpairedTable(const SilStory& story) {
  Table table{{"why", "images"}, {}};
  for (const auto& [why, count] : reasonsOf(story)) table.rows.push_back({why, std::to_string(count)});
  return table;
}

void writeOutputs(const SilStory& story, const fs::path& folder) {
  writeTextFile(folder / "measures.csv", measuresCsv(story));
  writeTextFile(folder / "unpaired.csv", unpairedCsv(story));
  writeTextFile(folder / "contact_sheet.png", pngBytes(story.sheet));
  writeJson(folder / "result.json", jsonOf(story));
  reportOf(story).write(folder / "report.html");
}

}  // namespace fathom
