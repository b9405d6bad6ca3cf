#include "reports/handle_evaluation_report.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>

#include "core/files.h"
#include "core/text.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kGood_rad = radians(10), kWild_rad = radians(20);
constexpr double kErrorBin_deg = 2, kLastError_deg = 90;

using ViewAngle = double HandleViewResult::*;

/// In degrees, of the views that have it and of which it is asked.
std::vector<double> degreesOf(const HandleWaterResults& water, ViewAngle value, bool confident_only) {
  std::vector<double> all;
  for (const HandleViewResult& r : water.views)
    if (std::isfinite(r.*value) && (r.confident || !confident_only)) all.push_back(degrees(r.*value));
  return all;
}

double shareWithin(const std::vector<double>& errors_deg, double limit_rad) {
  if (errors_deg.empty()) return std::nan("");
  return static_cast<double>(std::count_if(errors_deg.begin(), errors_deg.end(),
                                           [&](double e) { return e <= degrees(limit_rad); })) /
         static_cast<double>(errors_deg.size());
}

std::string percentOf(double share) { return std::isfinite(share) ? fixed(100 * share, 1) + " %" : "-"; }

/// Root mean square of error over sigma, and the share within two sigmas.
std::pair<double, double> honesty(const HandleWaterResults& water) {
  double squares = 0, within = 0, count = 0;
  for (const HandleViewResult& r : water.views)
    if (r.confident) {
      const double z = r.error_rad / r.sigma_rad;
      squares += z * z;
      within += z <= 2 ? 1 : 0;
      ++count;
    }
  return count > 0 ? std::pair{std::sqrt(squares / count), within / count}
                   : std::pair{std::nan(""), std::nan("")};
}

std::vector<std::string> methodRow(const HandleWaterResults& water, const std::string& name, ViewAngle value,
                                   bool confident_only) {
  const std::vector<double> errors = degreesOf(water, value, confident_only);
  const ErrorSummary s = summaryOf(errors);
  return {water.name,
          name,
          std::to_string(errors.size()) + " of " + std::to_string(water.views.size()),
          percentOf(shareWithin(errors, kGood_rad)),
          fixed(s.median, 2),
          fixed(s.largest, 1),
          std::to_string(
              std::count_if(errors.begin(), errors.end(), [](double e) { return e > degrees(kWild_rad); }))};
}

Plot histogram(const HandleEvaluationStory& story) {
  Plot plot{.title = "Angle errors", .x_label = "error [deg]", .y_label = "share of views"};
  plot.log_y = true;
  for (std::size_t w = 0; w < story.waters.size(); ++w)
    for (const bool matched : {false, true}) {
      const std::vector<double> errors =
          degreesOf(story.waters[w],
                    matched ? &HandleViewResult::error_rad : &HandleViewResult::chain_error_rad, matched);
      Series series{.name = story.waters[w].name + (matched ? ", stated" : ", paper's chain"),
                    .style = matched ? Series::Style::kLine : Series::Style::kDashed,
                    .color = kPalette[w % std::size(kPalette)]};
      for (double low = 0; low < kLastError_deg; low += kErrorBin_deg) {
        const auto inside = std::count_if(errors.begin(), errors.end(),
                                          [&](double e) { return e >= low && e < low + kErrorBin_deg; });
        series.x.push_back(low + kErrorBin_deg / 2);
        series.y.push_back(inside > 0 ? static_cast<double>(inside) / static_cast<double>(errors.size())
                                      : std::nan(""));
      }
      plot.series.push_back(series);
    }
  return plot;
}

Plot calibrationPlot(const HandleEvaluationStory& story) {
  Plot plot{.title = "Error against stated sigma", .x_label = "sigma [deg]", .y_label = "error [deg]"};
  for (std::size_t w = 0; w < story.waters.size(); ++w) {
    Series series{.name = story.waters[w].name,
                  .style = Series::Style::kPoints,
                  .color = kPalette[w % std::size(kPalette)]};
    for (const HandleViewResult& r : story.waters[w].views)
      if (r.confident) {
        series.x.push_back(degrees(r.sigma_rad));
        series.y.push_back(degrees(r.error_rad));
      }
    plot.series.push_back(series);
  }
  return plot;
}

HtmlReport reportOf(const HandleEvaluationStory& story) {
  const HandleEvaluationOptions& o = story.options;
  HtmlReport report("The handles' angles: task T_H");
  report.paragraph(
      print("%zu views of a handle of %s in each water, drawn with seed %llu: %.2f to %.2f m from the "
            "handle, tilted by %.0f to %.0f degrees, all handles turned at random within their "
            "ranges. The panel's pose is solved from the markers in the same image.",
            o.views, story.map.c_str(), static_cast<unsigned long long>(o.seed), o.ranges.nearest_m,
            o.ranges.farthest_m, degrees(o.ranges.smallest_tilt_rad), degrees(o.ranges.largest_tilt_rad)));
  report.table(
      handleErrorTable(story),
      "Errors without sign, degrees. The paper's chain: region of interest, contour led by a "
      "superellipse, Canny, Hough; as far as its edges can tell (a wheel's by spokes where the marked "
      "one is not told from the others). Stated: rendered at candidate angles and matched, where the "
      "program is confident.");
  report.plot(histogram(story));
  report.heading("What is stated of it");
  report.plot(calibrationPlot(story));
  if (const Table unread = unreadTable(story); !unread.rows.empty())
    report.table(unread, "Views without an angle");
  report.heading("The contour alone");
  report.table(contourTable(story), "Intersection over union with what the renderer says is the handle");
  report.footer(story.run);
  return report;
}

std::string viewsCsv(const HandleEvaluationStory& story) {
  std::ostringstream csv;
  csv << "water,view,handle,kind,range_m,tilt_deg,true_angle_deg,posed,confident,error_deg,sigma_deg,"
         "support,evidence,misfit,chain_error_deg,chain_prominence,disagreement_deg,overlap,why_not\n";
  for (const HandleWaterResults& water : story.waters)
    for (const HandleViewResult& r : water.views) {
      const Handle& handle = story.handles[r.handle];
      csv << water.name
          << print(",%zu,%s,%s", static_cast<std::size_t>(r.view.number), handle.id.c_str(),
                   std::string(nameOf(handle.kind)).c_str())
          << print(",%.4f,%.3f,%.3f,%d,%d", r.view.range_m, degrees(r.view.tilt_rad),
                   degrees(r.true_angle_rad), r.posed, r.confident)
          << print(",%.4f,%.4f,%.1f,%.0f,%.4f", degrees(r.signed_error_rad), degrees(r.sigma_rad), r.support,
                   r.evidence, r.misfit)
          << print(",%.3f,%.3f,%.3f,%.4f", degrees(r.chain_error_rad), r.chain_prominence,
                   degrees(r.disagreement_rad), r.overlap)
          << ',' << r.why_not << '\n';
    }
  return csv.str();
}

Json toJson(const HandleEvaluationStory& story) {
  Json json;
  json["run"] = toJson(story.run);
  json["map"] = story.map;
  json["vehicle"] = story.vehicle;
  json["views"] = story.options.views;
  json["waters"] = Json::array();
  for (const HandleWaterResults& water : story.waters) {
    const auto errors = degreesOf(water, &HandleViewResult::error_rad, true);
    const auto chain = degreesOf(water, &HandleViewResult::chain_error_rad, false);
    const auto [z, within] = honesty(water);
    json["waters"].push_back({{"name", water.name},
                              {"file", water.file},
                              {"confident", errors.size()},
                              {"median_deg", summaryOf(errors).median},
                              {"largest_deg", summaryOf(errors).largest},
                              {"within_10_deg", shareWithin(errors, kGood_rad)},
                              {"rms_error_in_sigmas", z},
                              {"within_2_sigmas", within},
                              {"chain", chain.size()},
                              {"chain_median_deg", summaryOf(chain).median},
                              {"chain_within_10_deg", shareWithin(chain, kGood_rad)}});
  }
  return json;
}

}  // namespace

Table handleErrorTable(const HandleEvaluationStory& story) {
  Table table{{"water", "method", "views", "within 10 deg", "median", "largest", "beyond 20 deg",
               "rms error [sigma]", "within 2 sigma"},
              {}};
  for (const HandleWaterResults& water : story.waters) {
    table.rows.push_back(methodRow(water, "paper's chain", &HandleViewResult::chain_error_rad, false));
    table.rows.push_back(methodRow(water, "stated", &HandleViewResult::error_rad, true));
    const auto [z, within] = honesty(water);
    table.rows.back().push_back(fixed(z, 2));
    table.rows.back().push_back(percentOf(within));
  }
  return table;
}

Table contourTable(const HandleEvaluationStory& story) {
  Table table{{"water", "kind", "views", "mean", "median"}, {}};
  for (const HandleWaterResults& water : story.waters) {
    std::map<HandleKind, std::vector<double>> overlaps;
    for (const HandleViewResult& r : water.views)
      if (std::isfinite(r.overlap)) overlaps[story.handles[r.handle].kind].push_back(r.overlap);
    for (auto& [kind, of_kind] : overlaps) {
      const ErrorSummary s = summaryOf(of_kind);
      table.rows.push_back({water.name, std::string(nameOf(kind)), std::to_string(s.count), fixed(s.mean, 2),
                            fixed(s.median, 2)});
    }
  }
  return table;
}

Table unreadTable(const HandleEvaluationStory& story) {
  Table table{{"water", "why", "views"}, {}};
  for (const HandleWaterResults& water : story.waters) {
    std::map<std::string, std::size_t> reasons;
    for (const HandleViewResult& r : water.views)
      if (!r.confident) ++reasons[r.why_not];
    for (const auto& [why, count] : reasons) table.rows.push_back({water.name, why, std::to_string(count)});
  }
  return table;
}

void writeOutputs(const HandleEvaluationStory& story, const fs::path& folder) {
  writeJson(folder / "result.json", toJson(story));
  writeTextFile(folder / "views.csv", viewsCsv(story));
  reportOf(story).write(folder / "report.html");
}

}  // namespace fathom
