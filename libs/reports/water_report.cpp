#include "reports/water_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/text.h"
#include "image_files/encode_image.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kChannels[] = {"red", "green", "blue"};
constexpr const char* kChannelColors[] = {"#d55e00", "#009e73", "#0072b2"};
constexpr const char* kParameters[] = {"attenuation a [1/m]", "veil b", "ambient light E"};
constexpr double kWhiteAlbedo = 0.7, kBlackAlbedo = 0.1;  // brighter and darker than these
constexpr std::size_t kMostPoints = 400;                  // of a cloud in a plot

const PanelPoseCheck& posesOf(const WaterStory& story) { return *story.study.panel_poses; }

std::string plusMinus(const MeanScore& score, double unit, int decimals) {
  return fixed(score.mean / unit, decimals) + " ± " + fixed(score.half_width / unit, decimals);
}

// ---- the panel's pose

/// A row of the comparison: what is expected, what was measured.
struct PoseRow {
  std::string name;
  double unit;
  const char* unit_name;
  MeanScore expected, measured;
};

std::vector<PoseRow> poseRows(const WaterStory& story) {
  const PanelPoseCheck& check = posesOf(story);
  const auto position = &PanelPoseError::position_m, angle = &PanelPoseError::angle_rad;
  return {{"joint, position", 1e-3, "mm", check.joint(check.expected, position),
           check.joint(check.measured, position)},
          {"joint, angle", radians(1), "deg", check.joint(check.expected, angle),
           check.joint(check.measured, angle)},
          {"mean of markers (paper), position", 1e-3, "mm", check.averaged(check.expected, position),
           check.averaged(check.measured, position)},
          {"mean of markers (paper), angle", radians(1), "deg", check.averaged(check.expected, angle),
           check.averaged(check.measured, angle)}};
}

// ---- plots

bool isWhite(const Patch& patch) { return patch.albedo.minCoeff() > kWhiteAlbedo; }
bool isBlack(const Patch& patch) { return patch.albedo.maxCoeff() < kBlackAlbedo; }

/// Every so many-th patch of a kind that counts in the fit, as points over distance.
template <class Choose, class Value>
Series cloudOf(const WaterStory& story, const std::string& name, const std::string& color, Choose choose,
               Value value) {
  const auto& patches = story.study.synchronized.patches;
  std::vector<const Patch*> chosen;
  for (std::size_t i = 0; i < patches.size(); ++i)
    if (story.study.fit.inlier[i] && choose(patches[i])) chosen.push_back(&patches[i]);
  Series series{.name = name, .style = Series::Style::kPoints, .color = color};
  const std::size_t step = 1 + chosen.size() / kMostPoints;
  for (std::size_t i = 0; i < chosen.size(); i += step) {
    series.x.push_back(chosen[i]->z_m);
    series.y.push_back(value(*chosen[i]));
  }
  return series;
}

/// By the same camera at the same time, straight ahead and facing it.
Patch patchAhead(double z_m, double albedo, const Patch& other) {
  const Pose& T_robot_camera = other.T_robot_camera;
  Patch patch = other;
  patch.image_radius = 0;
  patch.image_tangent.setZero();
  patch.z_m = patch.range_m = z_m;
  patch.albedo = Vector3d::Constant(albedo);
  patch.albedo_around.colwise() = patch.albedo;
  patch.on_robot.around_robot.fill(T_robot_camera * Vector3d(0, 0, z_m));
  patch.on_robot.normal_robot = -T_robot_camera.rotation.col(2);
  return patch;
}

Series curveOf(const WaterStory& story, const Environment& water, double albedo, int channel,
               const std::string& name, Series::Style style, const std::string& color) {
  Series series{.name = name, .style = style, .color = color};
  const WaterFit& fit = story.study.fit;
  for (int i = 0; i <= 100; ++i) {
    const double z_m = fit.nearest_z_m + 0.01 * i * (fit.farthest_z_m - fit.nearest_z_m);
    const Patch& some = story.study.synchronized.patches.front();
    const Patch patch = patchAhead(z_m, albedo, some);
    series.x.push_back(z_m);
    series.y.push_back(predictedRadiance(patch, water, fit.known)[channel]);
  }
  return series;
}

/// Mean albedo of a kind of patches.
template <class Choose>
double albedoOf(const WaterStory& story, Choose choose) {
  double sum = 0, count = 0;
  for (const Patch& patch : story.study.synchronized.patches)
    if (choose(patch)) sum += patch.albedo.mean(), count += 1;
  return sum / std::max(1.0, count);
}

Plot channelPlot(const WaterStory& story, int channel) {
  const WaterStudy& study = story.study;
  Plot plot{.title = std::string("White and black in ") + kChannels[channel],
            .x_label = "distance z along the optical axis [m]",
            .y_label = "linear light"};
  const auto seen = [&](const Patch& patch) {
    const double log_gain = study.fit.gain_fitted ? study.fit.log_gain[patch.image] : 0;
    return patch.radiance[channel] * std::exp(-log_gain);
  };
  plot.series.push_back(cloudOf(story, "white, seen", "#56b4e9", isWhite, seen));
  plot.series.push_back(cloudOf(story, "black, seen", "#cc79a7", isBlack, seen));
  const double white = albedoOf(story, isWhite), black = albedoOf(story, isBlack);
  using Style = Series::Style;
  const Environment& fitted = study.fit.environment;
  plot.series.push_back(curveOf(story, fitted, white, channel, "white, fitted", Style::kLine, "#0072b2"));
  plot.series.push_back(curveOf(story, fitted, black, channel, "black, fitted", Style::kLine, "#d55e00"));
  const Environment& other = study.candidates.front().environment;
  plot.series.push_back(curveOf(story, other, white, channel, "white, default", Style::kDashed, "#0072b2"));
  plot.series.push_back(curveOf(story, other, black, channel, "black, default", Style::kDashed, "#d55e00"));
  return plot;
}

Plot residualPlot(const WaterStory& story) {
  Plot plot{.title = "What is left: seen minus fitted",
            .x_label = "distance z along the optical axis [m]",
            .y_label = "in sigmas"};
  for (int c = 0; c < 3; ++c)
    plot.series.push_back(cloudOf(
        story, kChannels[c], kChannelColors[c], [&](const Patch& p) { return std::isfinite(p.sigma[c]); },
        [&](const Patch& p) { return residualSigmas(p, story.study.fit)[c]; }));
  plot.y_range = {-5, 5};
  return plot;
}

Plot gainPlot(const WaterStory& story) {
  Plot plot{.title = "Exposure gain", .x_label = "image", .y_label = "gain"};
  Series gains{.name = "fitted", .style = Series::Style::kPoints};
  for (std::size_t k = 0; k < story.study.fit.log_gain.size(); ++k) {
    gains.x.push_back(static_cast<double>(k + 1));
    gains.y.push_back(std::exp(story.study.fit.log_gain[k]));
  }
  plot.series.push_back(gains);
  return plot;
}

// ---- report.html

std::string howItWasFitted(const WaterStory& story) {
  const WaterStudy& s = story.study;
  std::string text = print(
      "Of %zu images, %zu show where they were taken by their markers, %zu of them not well enough. %zu, "
      "spread "
      "over range and view, were fitted on: %zu patches of one albedo, %zu of them left out because they do "
      "not "
      "fit. Distances are from %.2f to %.2f m. ",
      s.images, s.posed, s.choice.too_uncertain, s.fit.images, s.fit.patches, s.fit.outliers,
      s.fit.nearest_z_m, s.fit.farthest_z_m);
  text += print("In %zu patches a channel is saturated and does not count, in %zu it is black. ",
                s.synchronized.saturated, s.synchronized.dark);
  text += s.fit.gain_fitted ? "Every image has an exposure gain of its own; their mean logarithm is zero. "
                            : "Exposure is the same in all images. ";
  return text + print(
                    "Patches vary by %.2f, %.2f and %.2f digital numbers (red, green, blue) more than the "
                    "sensor's noise explains.",
                    255 * s.fit.excess_sigma[0], 255 * s.fit.excess_sigma[1], 255 * s.fit.excess_sigma[2]);
}

std::string howItWasJudged(const WaterStory& story) {
  const WaterStudy& s = story.study;
  std::string text = print(
      "%zu images of stretches of the recording that nothing was fitted on. Each is compared "
      "with its simulation in each water, which has the sensor's noise as the recorded one has "
      "(its own, so that no two images are the same)",
      s.choice.held_out.size());
  if (s.jpeg_quality) text += print(" and went through JPEG of quality %d like it", *s.jpeg_quality);
  return text +
         print(
             ". FSIM (Zhang et al. 2011) is of luminance, FSIMc of colour too; RMSE is of linear light on "
             "the panels. ± is the 95 %% confidence interval of the mean. Recommended is the smallest RMSE; "
             "among waters that it does not tell apart, the largest FSIM, which alone hardly sees contrast "
             "and colour. The paper's search tried %zu "
             "waters; it looks at FSIMc, because FSIM does not see colours.",
             s.search.evaluations);
}

void addPanelPoses(const WaterStory& story, HtmlReport& report) {
  if (!story.study.panel_poses) return;
  report.heading("The panel's pose in this water (task T_P)");
  report.table(
      panelPoseTable(story),
      "Mean error of T_camera_panel. Expected: images made in the recommended water, from the very views of "
      "the recording. Measured: the recording's images against its truth. ± is the 95 % confidence "
      "interval of the mean; they agree where the difference is within both together.");
}

HtmlReport reportOf(const WaterStory& story, const std::string& sheet_png, const std::string& water) {
  const WaterStudy& study = story.study;
  HtmlReport report("The water of a recording: task T_E");
  std::vector<std::pair<std::string, std::string>> headline{{"recommended", study.recommendedWater().name}};
  for (const WaterCandidate& candidate : study.candidates)
    headline.emplace_back("FSIM, " + candidate.name, fixed(meanScore(candidate, &WaterScore::fsim).mean, 3));
  report.keyValues(headline);
  for (const std::string& warning : study.fit.warnings) report.warning(warning);
  for (const std::string& remark : story.remarks) report.warning(remark);
  if (story.known.given())
    report.paragraph(story.known.inWords() +
                     " All images, made and fitted, have them; the water is what is left beside them.");
  report.paragraph(howItWasFitted(story));
  report.table(parameterTable(story),
               "One standard deviation each. Off: how far truth is from the fit, in those.");
  report.heading("On images that were held out");
  report.paragraph(howItWasJudged(story));
  report.table(heldOutTable(story));
  report.picture(sheet_png,
                 "Held-out images: recorded, and in each water. Brightened for the eye (power 1 / 2.2).");
  report.heading("White and black against distance");
  for (int c = 0; c < 3; ++c) report.plot(channelPlot(story, c));
  report.plot(residualPlot(story), "One point a patch, thinned.");
  if (study.fit.gain_fitted) report.plot(gainPlot(story));
  addPanelPoses(story, report);
  if (!study.synchronized.rejected.empty()) {
    report.heading("Images that could not be used");
    Table table{{"image", "why"}, {}};
    for (const auto& [file, why] : study.synchronized.rejected)
      table.rows.push_back({file.filename().string(), why});
    report.table(table);
  }
  report.heading("The recommended water");
  report.preformatted(water);
  report.footer(story.run);
  return report;
}

// ---- result.json

Json toJson(const Environment& environment) {
  return {{"attenuation_per_m", vectorJson(environment.water.attenuation_per_m)},
          {"veil", vectorJson(environment.water.veil)},
          {"ambient", vectorJson(environment.ambient)}};
}

Json toJson(const MeanScore& score, double unit = 1) {
  return {{"mean", score.mean / unit}, {"half_width_95", score.half_width / unit}};
}

Json fitJson(const WaterFit& fit) {
  Json json{{"images", fit.images}, {"patches", fit.patches}, {"outliers", fit.outliers}};
  json["environment"] = toJson(fit.environment);
  const Vector9d sigma = fit.sigma();
  json["sigma"] = toJson(environmentOf(sigma));
  Json covariance = Json::array();
  for (int i = 0; i < 9; ++i) {
    Json row = Json::array();
    for (int j = 0; j < 9; ++j) row.push_back(fit.covariance(i, j));
    covariance.push_back(row);
  }
  json["covariance"] = covariance;
  json["chi_square_per_dof"] = vectorJson(fit.chi_square_per_dof);
  json["excess_sigma"] = vectorJson(fit.excess_sigma);
  json["nearest_m"] = fit.nearest_z_m;
  json["farthest_m"] = fit.farthest_z_m;
  json["exposure_gain_fitted"] = fit.gain_fitted;
  json["log_gain"] = fit.log_gain;
  json["log_gain_sigma"] = fit.log_gain_sigma;
  json["warnings"] = fit.warnings;
  return json;
}

Json candidatesJson(const WaterStory& story) {
  Json list = Json::array();
  for (const WaterCandidate& candidate : story.study.candidates)
    list.push_back({{"name", candidate.name},
                    {"environment", toJson(candidate.environment)},
                    {"fsim", toJson(meanScore(candidate, &WaterScore::fsim))},
                    {"fsimc", toJson(meanScore(candidate, &WaterScore::fsimc))},
                    {"rmse_linear", toJson(meanScore(candidate, &WaterScore::rmse))}});
  return list;
}

Json panelPosesJson(const WaterStory& story) {
  Json list = Json::array();
  for (const PoseRow& row : poseRows(story))
    list.push_back({{"error", row.name},
                    {"unit", row.unit_name},
                    {"views", row.expected.count},
                    {"expected", toJson(row.expected, row.unit)},
                    {"measured", toJson(row.measured, row.unit)},
                    {"agree", agree(row.expected, row.measured)}});
  return list;
}

Json toJson(const WaterStory& story) {
  const WaterStudy& study = story.study;
  Json json;
  json["run"] = toJson(story.run);
  json["recording"] = story.recording;
  json["map"] = story.map;
  json["vehicle"] = story.vehicle;
  json["default_water"] = story.default_water;
  if (story.known.given()) json["calibration"] = toJson(story.known);
  json["images"] = {{"all", study.images},
                    {"posed", study.posed},
                    {"fitted", study.fit.images},
                    {"held_out", study.choice.held_out.size()}};
  json["jpeg_quality"] = study.jpeg_quality ? Json(*study.jpeg_quality) : Json(nullptr);
  json["fit"] = fitJson(study.fit);
  json["held_out"] = candidatesJson(story);
  json["recommended"] = study.recommendedWater().name;
  if (study.panel_poses) json["panel_pose_errors"] = panelPosesJson(story);
  json["remarks"] = story.remarks;
  return json;
}

}  // namespace

Table parameterTable(const WaterStory& story) {
  const WaterStudy& study = story.study;
  Table table{{"parameter", "fitted", "sigma", "default"}, {}};
  if (study.truth) table.header.insert(table.header.end(), {"truth", "error [%]", "off [sigma]"});
  const Vector9d fitted = waterParameters(study.fit.environment), sigma = study.fit.sigma(),
                 given = waterParameters(study.candidates.front().environment);
  for (int i = 0; i < 9; ++i) {
    std::vector<std::string> row{std::string(kParameters[i / 3]) + ", " + kChannels[i % 3],
                                 fixed(fitted[i], 5), fixed(sigma[i], 5), fixed(given[i], 4)};
    if (study.truth) {
      const double truth = waterParameters(*study.truth)[i];
      row.push_back(fixed(truth, 4));
      row.push_back(fixed(100 * (fitted[i] / truth - 1), 2));
      row.push_back(fixed((fitted[i] - truth) / sigma[i], 2));
    }
    table.rows.push_back(row);
  }
  return table;
}

Table heldOutTable(const WaterStory& story) {
  Table table{{"water", "FSIM", "95 %", "FSIMc", "95 %", "RMSE", "95 %"}, {}};
  for (const WaterCandidate& candidate : story.study.candidates) {
    std::vector<std::string> row{candidate.name};
    for (const auto measure : {&WaterScore::fsim, &WaterScore::fsimc, &WaterScore::rmse}) {
      const MeanScore score = meanScore(candidate, measure);
      row.push_back(fixed(score.mean, 4));
      row.push_back("± " + fixed(score.half_width, 4));
    }
    table.rows.push_back(row);
  }
  return table;
}

Table panelPoseTable(const WaterStory& story) {
  Table table{{"error of the panel's pose", "views", "expected", "measured", "agree"}, {}};
  if (!story.study.panel_poses) return table;
  for (const PoseRow& row : poseRows(story))
    table.rows.push_back({row.name + " [" + row.unit_name + "]", std::to_string(row.expected.count),
                          plusMinus(row.expected, row.unit, 3), plusMinus(row.measured, row.unit, 3),
                          agree(row.expected, row.measured) ? "yes" : "no"});
  return table;
}

fs::path writeOutputs(const WaterStory& story, const fs::path& folder) {
  const fs::path name = fs::path(story.recording).stem();
  fs::path water_file = folder / (name.string() + "_water.yaml");
  const WaterCandidate& water = story.study.recommendedWater();
  const std::string beside =
      story.known.given() ? "It holds beside the effects of " + story.known.file + ".\n" : "";
  const std::string text = formatEnvironment(
      water.environment, "Water and light of " + fs::path(story.recording).filename().string() + " (" +
                             water.name + "), by fathom fit-water. Colours are linear red, green, blue.\n" +
                             beside + "Form: config/water_clear.yaml.");
  const std::string sheet_png = pngBytes(story.study.sheet);
  writeTextFile(water_file, text);
  writeTextFile(folder / "waters.png", sheet_png);
  writeJson(folder / "result.json", toJson(story));
  reportOf(story, sheet_png, text).write(folder / "report.html");
  return water_file;
}

}  // namespace fathom
