#include "reports/fiducial_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/text.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// What is varied in the grid besides families.
struct Factor {
  std::string name, label;         ///< for headings and axes
  std::vector<double> x;           ///< its values in the label's unit …
  std::vector<std::string> names;  ///< … and as texts
  std::size_t GridImage::*place = nullptr;
};

std::vector<Factor> factorsOf(const FiducialGrid& grid) {
  Factor range{"range", "range [m]", grid.ranges_m, {}, &GridImage::range};
  Factor tilt{"tilt", "tilt [deg]", {}, {}, &GridImage::tilt};
  Factor water{"turbidity", "attenuation of green light [1/m]", {}, {}, &GridImage::water};
  Factor blur{"blur", "blur sigma [px]", grid.blurs_px, {}, &GridImage::blur};
  for (const double range_m : grid.ranges_m) range.names.push_back(print("%g m", range_m));
  for (const double tilt_rad : grid.tilts_rad) {
    tilt.x.push_back(degrees(tilt_rad));
    tilt.names.push_back(print("%g deg", degrees(tilt_rad)));
  }
  for (const NamedWater& w : grid.waters) {
    water.x.push_back(w.water.attenuation_per_m[1]);
    water.names.push_back(w.name);
  }
  for (const double blur_px : grid.blurs_px) blur.names.push_back(print("%g px", blur_px));
  return {range, tilt, water, blur};
}

std::vector<FiducialReader> readersOf(const FiducialGrid& grid) {
  return readersOf(grid.backends, grid.preprocessings);
}

FiducialKey familyAndReader(const FiducialResult& r) { return {r.image.family, r.reader}; }

FiducialGroups byFactor(const FiducialStory& story, const Factor& factor) {
  return grouped(story.results, [&](const FiducialResult& r) {
    return FiducialKey{r.image.family, r.reader, r.image.*factor.place};
  });
}

std::string percent(double share) { return fixed(100.0 * share, 1); }

double falsePerImage(const FiducialGroup& group) {
  return static_cast<double>(group.score.wrong()) / static_cast<double>(group.score.images());
}

// ---- tables

Table factorTable(const FiducialStory& story, const Factor& factor) {
  Table table{{"family", "reader"}, {}};
  for (const auto& name : factor.names) table.header.push_back(name + " [%]");
  const auto readers = readersOf(story.grid);
  for (const auto& [key, group] : byFactor(story, factor)) {
    if (key[2] == 0) table.rows.push_back({story.grid.families[key[0]], readers[key[1]].name()});
    table.rows.back().push_back(percent(group.score.detectionRate()));
  }
  return table;
}

// ---- plots

constexpr int kPlotHeight_px = 520;  // ten curves have a long legend

using GroupValue = double (*)(const FiducialGroup&);

double ratePercent(const FiducialGroup& group) { return 100.0 * group.score.detectionRate(); }
double cornerRms_px(const FiducialGroup& group) { return group.score.cornerRms_px(); }
double positionError_mm(const FiducialGroup& group) { return 1e3 * group.score.medianPositionError_m(); }
double detect_ms(const FiducialGroup& group) { return group.meanDetect_ms(); }

/// A colour a family; lines for AprilTag, dashes for ArUco.
Plot factorPlot(const FiducialStory& story, const Factor& factor, const FiducialGroups& groups,
                Preprocess preprocess, Plot plot, GroupValue value) {
  plot.x_label = factor.label;
  plot.height_px = kPlotHeight_px;
  const auto readers = readersOf(story.grid);
  std::vector<std::size_t> order(factor.x.size());  // waters may come in any order
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return factor.x[a] < factor.x[b]; });
  for (std::size_t family = 0; family < story.grid.families.size(); ++family)
    for (std::size_t reader = 0; reader < readers.size(); ++reader) {
      if (readers[reader].preprocess != preprocess) continue;
      Series series{.name =
                        story.grid.families[family] + ", " + std::string(nameOf(readers[reader].backend))};
      series.style =
          readers[reader].backend == Backend::aruco ? Series::Style::kDashed : Series::Style::kLine;
      series.color = kPalette[family % std::size(kPalette)];
      for (const std::size_t i : order) {
        const auto group = groups.find({family, reader, i});
        series.x.push_back(factor.x[i]);
        series.y.push_back(group == groups.end() ? std::nan("") : value(group->second));
      }
      plot.series.push_back(series);
    }
  return plot;
}

void addFactor(HtmlReport& report, const FiducialStory& story, const Factor& factor) {
  report.heading("Against " + factor.name);
  report.table(factorTable(story, factor), "Detection rate; all else together.");
  if (factor.x.size() < 2) return;
  const FiducialGroups groups = byFactor(story, factor);
  for (const Preprocess preprocess : story.grid.preprocessings) {
    const std::string after =
        story.grid.preprocessings.size() > 1 ? ", preprocessing " + std::string(nameOf(preprocess)) : "";
    const auto add = [&](const std::string& title, const std::string& y_label, GroupValue value) {
      Plot plot{.title = print("%s against %s%s", title.c_str(), factor.name.c_str(), after.c_str()),
                .y_label = y_label};
      if (value == ratePercent) plot.y_range = {0.0, 102.0};
      plot.log_y = value == positionError_mm;
      report.plot(factorPlot(story, factor, groups, preprocess, plot, value));
    };
    add("Detection rate", "[%]", ratePercent);
    add("Corner RMS", "[px]", cornerRms_px);
    add("Median position error of the panel", "[mm]", positionError_mm);
    add("CPU time a frame", "[ms]", detect_ms);
  }
}

/// Where the limit of visibility lies: the range plot in each water alone, without added blur.
void addRangesByWater(HtmlReport& report, const FiducialStory& story, const Factor& range) {
  const auto least = std::min_element(story.grid.blurs_px.begin(), story.grid.blurs_px.end());
  const auto blur = static_cast<std::size_t>(least - story.grid.blurs_px.begin());
  if (range.x.size() < 2) return;
  report.heading("Against range, water by water");
  for (std::size_t water = 0; water < story.grid.waters.size(); ++water) {
    std::vector<FiducialResult> here;
    for (const FiducialResult& r : story.results)
      if (r.image.water == water && r.image.blur == blur) here.push_back(r);
    const auto groups = grouped(here, [](const FiducialResult& r) {
      return FiducialKey{r.image.family, r.reader, r.image.range};
    });
    Plot plot{
        .title = "Detection rate in " + story.grid.waters[water].name + print(" water, blur %g px", *least),
        .y_label = "[%]"};
    plot.y_range = {0.0, 102.0};
    report.plot(factorPlot(story, range, groups, story.grid.preprocessings.front(), plot, ratePercent));
  }
}

// ---- files

Json toJson(const FiducialGroup& group) {
  const ScoreTally& s = group.score;
  const auto [low, high] = s.detectionRate95();
  return {{"images", s.images()},
          {"markers_visible", s.visible()},
          {"markers_found", s.found()},
          {"detection_rate", s.detectionRate()},
          {"detection_rate_interval95", {low, high}},
          {"false_detections", s.wrong()},
          {"not_on_map", s.unknown()},
          {"corner_rms_px", s.cornerRms_px()},
          {"poses", s.posed()},
          {"position_error_median_m", s.medianPositionError_m()},
          {"angle_error_median_deg", degrees(s.medianAngleError_rad())}};
}

Json jsonOf(const FiducialStory& story) {
  Json json;
  json["run"] = toJson(story.run);
  json["map"] = story.map;
  json["vehicle"] = story.vehicle;
  if (story.known.given()) {
    json["calibration"] = toJson(story.known);
    json["effects_at_s"] = story.grid.t_s;
  }
  json["images"] = story.grid.imageCount();
  json["match_px"] = story.grid.match_px;
  json["comparison"] = Json::array();
  const auto readers = readersOf(story.grid);
  for (const auto& [key, group] : grouped(story.results, familyAndReader)) {
    Json entry = {{"family", story.grid.families[key[0]]}, {"reader", readers[key[1]].name()}};
    entry["all"] = toJson(group);
    for (const Factor& factor : factorsOf(story.grid)) {
      Json& by = entry["by_" + factor.name] = Json::array();
      for (const auto& [place, part] : byFactor(story, factor))
        if (place[0] == key[0] && place[1] == key[1]) {
          by.push_back({{"at", factor.names[place[2]]}});
          by.back().update(toJson(part));
        }
    }
    json["comparison"].push_back(entry);
  }
  return json;
}

HtmlReport reportOf(const FiducialStory& story) {
  const FiducialGrid& grid = story.grid;
  HtmlReport report("Fiducial markers under water");
  report.keyValues({{"images", std::to_string(grid.imageCount())},
                    {"families", std::to_string(grid.families.size())},
                    {"readers", std::to_string(readersOf(grid).size())},
                    {"views of each family", std::to_string(grid.viewCount())}});
  report.paragraph("Panel " + story.map + ", camera of " + story.vehicle +
                   ". Every family is printed at the same size in the same places and seen from the same "
                   "views, in the same waters with the same noise.");
  if (story.known.given())
    report.paragraph(
        story.known.inWords() +
        print(" They are in the images as they are at %g s; readers know nothing of them.", grid.t_s));
  report.paragraph(
      print("A marker counts as found where none of its corners is off by more than %g px; of those that lie "
            "in the image whole with an eighth of their side around them, face the camera and are not "
            "hidden. Other detections are false: of an id "
            "that is not on the map, or off the place, as where the image cuts a marker and its corners are "
            "guessed. Corner RMS "
            "is the root mean square distance of found markers' corners from where they are. Pose errors are "
            "medians over the images in which a pose was found. The interval is Wilson's at 95 %%. Times are "
            "of the processor, measured in this run.",
            grid.match_px));
  report.heading("All together");
  report.table(overallTable(story));
  const auto factors = factorsOf(grid);
  for (const Factor& factor : factors) addFactor(report, story, factor);
  addRangesByWater(report, story, factors.front());
  report.footer(story.run);
  return report;
}

}  // namespace

Table overallTable(const FiducialStory& story) {
  Table table{{"family", "reader", "markers", "found [%]", "95 % interval", "false/1000 images", "not on map",
               "corners [px]", "posed [%]", "position [mm]", "angle [deg]", "CPU [ms]"},
              {}};
  const auto readers = readersOf(story.grid);
  for (const auto& [key, group] : grouped(story.results, familyAndReader)) {
    const ScoreTally& s = group.score;
    const auto [low, high] = s.detectionRate95();
    table.rows.push_back({story.grid.families[key[0]], readers[key[1]].name(), std::to_string(s.visible()),
                          percent(s.detectionRate()), percent(low) + " to " + percent(high),
                          fixed(1000 * falsePerImage(group), 1), std::to_string(s.unknown()),
                          fixed(s.cornerRms_px(), 3),
                          percent(static_cast<double>(s.posed()) / static_cast<double>(s.images())),
                          fixed(1e3 * s.medianPositionError_m(), 2),
                          fixed(degrees(s.medianAngleError_rad()), 3), fixed(group.meanDetect_ms(), 2)});
  }
  return table;
}

Table waterTable(const FiducialStory& story) { return factorTable(story, factorsOf(story.grid)[2]); }

void writeOutputs(const FiducialStory& story, const fs::path& folder) {
  writeTextFile(folder / "results.csv", formatResults(story.grid, story.results));
  writeTextFile(folder / "times.csv", formatTimes(story.grid, story.results));
  writeJson(folder / "result.json", jsonOf(story));
  reportOf(story).write(folder / "report.html");
}

}  // namespace fathom
