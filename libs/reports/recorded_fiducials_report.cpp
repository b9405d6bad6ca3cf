#include "reports/recorded_fiducials_report.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/text.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// All images together.
struct ReaderTotal {
  std::size_t images = 0, detections = 0, not_on_map = 0;
  ScoreTally score;  ///< of images with truth
  double detect_s = 0;

  double perImage() const { return static_cast<double>(detections) / static_cast<double>(images); }
  double detect_ms() const { return 1e3 * detect_s / static_cast<double>(images); }
};

ReaderTotal totalOf(const RecordedFiducialsStory& story, std::size_t reader) {
  ReaderTotal total;
  for (const RecordedResult& result : story.results) {
    const RecordedReading& reading = result.readings[reader];
    ++total.images;
    total.detections += static_cast<std::size_t>(reading.detections);
    total.not_on_map += static_cast<std::size_t>(reading.not_on_map);
    total.detect_s += reading.detect_s;
    if (result.truth_known) total.score.add(reading.score);
  }
  return total;
}

struct PairTotal {
  std::string first, second;
  std::size_t both = 0, only_first = 0, only_second = 0;
  double squares_px2 = 0;

  double share() const {
    const auto all = both + only_first + only_second;
    return all == 0 ? kNothing : static_cast<double>(both) / static_cast<double>(all);
  }
  double cornerRms_px() const {
    return both == 0 ? kNothing : std::sqrt(squares_px2 / (4.0 * static_cast<double>(both)));
  }
};

std::vector<PairTotal> pairTotals(const RecordedFiducialsStory& story) {
  std::vector<PairTotal> totals;
  const auto& readers = story.options.readers;
  for (std::size_t i = 0; i < readers.size(); ++i)
    for (std::size_t j = i + 1; j < readers.size(); ++j)
      totals.push_back({readers[i].name(), readers[j].name()});
  for (const RecordedResult& result : story.results)
    for (std::size_t pair = 0; pair < totals.size(); ++pair) {
      const ReaderAgreement& agreement = result.agreements[pair];
      totals[pair].both += static_cast<std::size_t>(agreement.both);
      totals[pair].only_first += static_cast<std::size_t>(agreement.only_first);
      totals[pair].only_second += static_cast<std::size_t>(agreement.only_second);
      totals[pair].squares_px2 += agreement.squares_px2;
    }
  return totals;
}

bool anyTruth(const RecordedFiducialsStory& story) {
  for (const RecordedResult& result : story.results)
    if (result.truth_known) return true;
  return false;
}

std::string perCent(double share) { return fixed(100.0 * share, 1); }

// ---- files

std::string field(double value) { return std::isfinite(value) ? print(",%.6g", value) : ","; }

std::string resultsCsv(const RecordedFiducialsStory& story) {
  std::string text =
      "reader,images,detections,not_on_map,images_with_truth,markers_visible,markers_found,detection_rate,"
      "detection_rate_low95,detection_rate_high95,false_detections,corner_rms_px,poses,"
      "position_error_median_m,angle_error_median_deg\n";
  for (std::size_t i = 0; i < story.options.readers.size(); ++i) {
    const ReaderTotal total = totalOf(story, i);
    const ScoreTally& s = total.score;
    const auto [low, high] = s.detectionRate95();
    text += story.options.readers[i].name() + print(",%zu,%zu,", total.images, total.detections) +
            (story.options.map ? std::to_string(total.not_on_map) : "") +
            print(",%zu,%zu,%zu", s.images(), s.visible(), s.found()) + field(s.detectionRate()) +
            field(low) + field(high) + print(",%zu", s.wrong()) + field(s.cornerRms_px()) +
            print(",%zu", s.posed()) + field(s.medianPositionError_m()) +
            field(degrees(s.medianAngleError_rad())) + "\n";
  }
  return text;
}

std::string agreementCsv(const RecordedFiducialsStory& story) {
  std::string text = "first,second,both,only_first,only_second,share_of_both,corner_rms_px\n";
  for (const PairTotal& t : pairTotals(story))
    text += t.first + "," + t.second + print(",%zu,%zu,%zu", t.both, t.only_first, t.only_second) +
            field(t.share()) + field(t.cornerRms_px()) + "\n";
  return text;
}

std::string timesCsv(const RecordedFiducialsStory& story) {
  std::string text = "reader,images,detect_cpu_ms\n";
  for (std::size_t i = 0; i < story.options.readers.size(); ++i) {
    const ReaderTotal total = totalOf(story, i);
    text += story.options.readers[i].name() + print(",%zu", total.images) + field(total.detect_ms()) + "\n";
  }
  return text;
}

Json jsonOf(const RecordedFiducialsStory& story) {
  Json json;
  json["run"] = toJson(story.run);
  json["recording"] = fs::path(story.recording).filename().string();
  json["images"] = story.results.size();
  json["families"] = story.options.families;
  json["match_px"] = story.options.match_px;
  json["recording_loss"] = story.loss ? Json(describe(*story.loss)) : Json(nullptr);
  json["readers"] = Json::array();
  for (std::size_t i = 0; i < story.options.readers.size(); ++i) {
    const ReaderTotal total = totalOf(story, i);
    const ScoreTally& s = total.score;
    Json entry = {{"reader", story.options.readers[i].name()},
                  {"detections", total.detections},
                  {"detections_per_image", total.perImage()}};
    if (story.options.map) entry["not_on_map"] = total.not_on_map;
    if (s.images() > 0) {
      const auto [low, high] = s.detectionRate95();
      entry.update({{"images_with_truth", s.images()},
                    {"markers_visible", s.visible()},
                    {"markers_found", s.found()},
                    {"detection_rate", s.detectionRate()},
                    {"detection_rate_interval95", {low, high}},
                    {"false_detections", s.wrong()},
                    {"corner_rms_px", s.cornerRms_px()},
                    {"poses", s.posed()},
                    {"position_error_median_m", s.medianPositionError_m()},
                    {"angle_error_median_deg", degrees(s.medianAngleError_rad())}});
    }
    json["readers"].push_back(entry);
  }
  return json;
}

Plot countPlot(const RecordedFiducialsStory& story) {
  Plot plot{.title = "Markers by image", .x_label = "image", .y_label = "markers"};
  plot.height_px = 460;
  const auto series = [&](const std::string& name, const auto& value) {
    Series s{.name = name};
    for (std::size_t i = 0; i < story.results.size(); ++i) {
      s.x.push_back(static_cast<double>(i));
      s.y.push_back(value(story.results[i]));
    }
    return s;
  };
  for (std::size_t r = 0; r < story.options.readers.size(); ++r)
    plot.series.push_back(series(
        "detected by " + story.options.readers[r].name(),
        [r](const RecordedResult& result) { return static_cast<double>(result.readings[r].detections); }));
  double most = 1;
  for (const Series& s : plot.series) most = std::max(most, *std::max_element(s.y.begin(), s.y.end()));
  plot.y_range = {0.0, most + 1.0};
  if (anyTruth(story)) {
    plot.series.push_back(series("visible", [](const RecordedResult& result) {
      return result.truth_known ? static_cast<double>(result.readings.front().score.visible) : kNothing;
    }));
    plot.series.back().style = Series::Style::kDashed;
    plot.series.back().color = "#8a8f98";
  }
  return plot;
}

HtmlReport reportOf(const RecordedFiducialsStory& story) {
  HtmlReport report("Fiducial markers in " + fs::path(story.recording).filename().string());
  std::string families;
  for (const auto& family : story.options.families) families += (families.empty() ? "" : ", ") + family;
  report.keyValues({{"images", std::to_string(story.results.size())}, {"families", families}});
  if (story.loss) report.warning("The recording is damaged: " + describe(*story.loss));
  report.paragraph(
      anyTruth(story)
          ? print(
                "A marker counts as found where none of its corners is off by more than %g px; of those that "
                "lie in the image whole, face the camera and are not hidden, by the recording's truth.",
                story.options.match_px)
          : "The recording has no truth for its images, or the panel is unknown: what should have been found "
            "is not known, only what was.");
  report.heading("Readers");
  report.table(readerTable(story));
  report.plot(countPlot(story));
  report.heading("Do they agree?");
  report.table(agreementTable(story),
               print("Both: the same id, no corner more than %g px apart.", story.options.match_px));
  report.footer(story.run);
  return report;
}

}  // namespace

Table readerTable(const RecordedFiducialsStory& story) {
  Table table{{"reader", "images", "detected", "an image", "not on map", "visible", "found [%]",
               "95 % interval", "false", "corners [px]", "position [mm]", "angle [deg]", "CPU [ms]"},
              {}};
  for (std::size_t i = 0; i < story.options.readers.size(); ++i) {
    const ReaderTotal total = totalOf(story, i);
    const ScoreTally& s = total.score;
    const bool truth = s.images() > 0;
    const auto [low, high] = s.detectionRate95();
    table.rows.push_back(
        {story.options.readers[i].name(), std::to_string(total.images), std::to_string(total.detections),
         fixed(total.perImage(), 2), story.options.map ? std::to_string(total.not_on_map) : "-",
         truth ? std::to_string(s.visible()) : "-", perCent(s.detectionRate()),
         truth ? perCent(low) + " to " + perCent(high) : "-", truth ? std::to_string(s.wrong()) : "-",
         fixed(s.cornerRms_px(), 3), fixed(1e3 * s.medianPositionError_m(), 2),
         fixed(degrees(s.medianAngleError_rad()), 3), fixed(total.detect_ms(), 2)});
  }
  return table;
}

Table agreementTable(const RecordedFiducialsStory& story) {
  Table table{{"first", "second", "both", "only first", "only second", "both [%]", "corners apart [px]"}, {}};
  for (const PairTotal& t : pairTotals(story))
    table.rows.push_back({t.first, t.second, std::to_string(t.both), std::to_string(t.only_first),
                          std::to_string(t.only_second), perCent(t.share()), fixed(t.cornerRms_px(), 3)});
  return table;
}

void writeOutputs(const RecordedFiducialsStory& story, const fs::path& folder) {
  writeTextFile(folder / "results.csv", resultsCsv(story));
  writeTextFile(folder / "agreement.csv", agreementCsv(story));
  writeTextFile(folder / "times.csv", timesCsv(story));
  writeJson(folder / "result.json", jsonOf(story));
  reportOf(story).write(folder / "report.html");
}

}  // namespace fathom
