#include "reports/camera_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/text.h"
#include "effects/calibration.h"
#include "report/html_report.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

const KindResult& chosenOf(const CameraStory& story) { return story.selection.kinds[story.selection.chosen]; }
double valueOf(const CameraFit& fit, std::size_t unknown) {
  return fit.values[static_cast<Eigen::Index>(unknown)];
}
double meanSigma_px(const CameraSelection& selection) {
  double squares = 0;
  for (const double sigma : selection.sigma_px) squares += sigma * sigma;
  return std::sqrt(squares / static_cast<double>(selection.sigma_px.size()));
}

/// The port as the effect that simulator and diagnosis know; off where there is none.
EffectParameters<double> portOf(const CameraFit& fit) {
  const auto value = [&](std::size_t unknown) { return valueOf(fit, unknown); };
  EffectParameters<double> effects;
  if (fit.kind->port == CameraKind::Port::flat)
    effects.add<FlatPortRefraction>(
        {value(12), fit.setting.glass_m, value(13), value(14), kWaterIndex - 1, 0, 0});
  if (fit.kind->port == CameraKind::Port::dome)
    effects.add<DecentredDome>(
        {-value(15), -value(16), -value(17), value(18), std::log(fit.setting.glass_m / kUsualDomeGlass_m)});
  return effects;
}

Json toJson(const CameraFit& fit) {
  Json json{{"kind", fit.kind->id},       {"points", fit.points},     {"outliers", fit.outliers},
            {"rms_px", fit.rms_px},       {"sigma_px", fit.sigma_px}, {"unknowns", Json::array()},
            {"covariance", Json::array()}};
  for (const std::size_t unknown : fit.unknowns)
    json["unknowns"].push_back({{"name", cameraUnknowns()[unknown].name},
                                {"unit", cameraUnknowns()[unknown].unit},
                                {"value", valueOf(fit, unknown)},
                                {"sigma", fit.sigmaOf(unknown)}});
  for (Eigen::Index row = 0; row < fit.covariance.rows(); ++row) {
    const Eigen::RowVectorXd values = fit.covariance.row(row);
    json["covariance"].push_back(std::vector<double>(values.begin(), values.end()));
  }
  return json;
}

Json toJson(const KindResult& result) {
  Json json = toJson(result.fit);
  json["heldout_rms_px"] = result.heldout_rms_px;
  json["worse_than_best"] = {{"mean_square_px2", result.worse_px2}, {"sigma_px2", result.worse_sigma_px2}};
  json["halves"] = {{"differ_px", result.halves_px}, {"stated_px", result.halves_sigma_px}};
  return json;
}

Json toJson(const CameraStory& story) {
  const CameraSelection& selection = story.selection;
  Json json{{"chosen", chosenOf(story).fit.kind->id},
            {"views", {{"air", story.views_in_air}, {"water", story.views_in_water}}},
            {"kinds", Json::array()},
            {"failed", Json::array()}};
  for (const KindResult& kind : selection.kinds) json["kinds"].push_back(toJson(kind));
  for (const auto& [kind, why] : selection.failed) json["failed"].push_back({{"kind", kind}, {"why", why}});
  if (selection.by_opencv) {
    json["opencv"] = toJson(*selection.by_opencv);
    json["opencv"]["heldout_rms_px"] = selection.opencv_heldout_rms_px;
  }
  Json projection{{"range_m", selection.grid.range_m}, {"pixels", Json::array()}};
  for (std::size_t i = 0; i < selection.sigma_px.size(); ++i)
    projection["pixels"].push_back({{"u_px", selection.grid.pixels[i].x()},
                                    {"v_px", selection.grid.pixels[i].y()},
                                    {"sigma_px", selection.sigma_px[i]}});
  json["projection"] = projection;
  json["run"] = toJson(story.run);
  return json;
}

/// Over the image: sigma of where a point is seen.
Table sigmaTable(const CameraSelection& selection) {
  Table table;
  const double largest = *std::max_element(selection.sigma_px.begin(), selection.sigma_px.end());
  for (int row = 0; row < selection.grid.rows; ++row) {
    auto& cells = table.rows.emplace_back();
    auto& shades = table.shades.emplace_back();
    for (int column = 0; column < selection.grid.columns; ++column) {
      const int place = row * selection.grid.columns + column;
      const double sigma = selection.sigma_px[static_cast<std::size_t>(place)];
      cells.push_back(print("%.3f", sigma));
      shades.push_back(sigma / largest);
    }
  }
  for (int column = 0; column < selection.grid.columns; ++column)
    table.header.push_back(print("%.0f px", selection.grid.pixels[static_cast<std::size_t>(column)].x()));
  return table;
}

void writeReport(const CameraStory& story, const fs::path& file) {
  const CameraSelection& selection = story.selection;
  const KindResult& chosen = chosenOf(story);
  HtmlReport report("Calibration of a camera: " + std::string(chosen.fit.kind->text));
  report.keyValues({{"kind", std::string(chosen.fit.kind->id)},
                    {"left on views that were not fitted", print("%.3f px", chosen.heldout_rms_px)},
                    {"sigma of where a point is seen", print("%.3f px", meanSigma_px(selection))},
                    {"views", print("%zu", story.views_in_air + story.views_in_water)}});
  report.heading("Kinds of cameras");
  report.table(
      kindTable(story),
      "Held out: root mean square of points that were not fitted, in views that were not. Worse: than the "
      "best, by the views' mean squares. Halves: how far the calibrations of every second view and of the "
      "others differ over the image, once one camera's frame is put on the other's; stated: what their "
      "covariances say of it.");
  report.heading("The camera");
  report.table(cameraTable(story), "OpenCV: cv::calibrateCamera() of the views that are judged on.");
  report.heading("How well it is known");
  report.table(sigmaTable(selection),
               print("Sigma of each coordinate at which a point is seen that is %.2f m away, "
                     "px, over the image.",
                     selection.grid.range_m));
  report.footer(story.run);
  report.write(file);
}

}  // namespace

Table kindTable(const CameraStory& story) {
  const CameraSelection& selection = story.selection;
  Table table{.header = {"kind", "unknowns", "outliers", "rms px", "held out px", "worse px²", "halves px",
                         "stated px"},
              .rows = {}};
  for (std::size_t i = 0; i < selection.kinds.size(); ++i) {
    const KindResult& kind = selection.kinds[i];
    table.rows.push_back({std::string(kind.fit.kind->id) + (i == selection.chosen ? " *" : ""),
                          print("%zu", kind.fit.unknowns.size()), print("%zu", kind.fit.outliers),
                          print("%.4f", kind.fit.rms_px), print("%.4f", kind.heldout_rms_px),
                          print("%.4f ± %.4f", kind.worse_px2, kind.worse_sigma_px2),
                          print("%.3f", kind.halves_px), print("%.3f", kind.halves_sigma_px)});
  }
  if (selection.by_opencv)
    table.rows.push_back({"OpenCV's pinhole", print("%zu", selection.by_opencv->unknowns.size()), "0",
                          print("%.4f", selection.by_opencv->rms_px),
                          print("%.4f", selection.opencv_heldout_rms_px), "-", "-", "-"});
  return table;
}

Table cameraTable(const CameraStory& story) {
  const CameraFit& fit = chosenOf(story).fit;
  const auto& opencv = story.selection.by_opencv;
  Table table{.header = {"number", "value ± sigma", "unit", "OpenCV's"}, .rows = {}};
  for (const std::size_t unknown : fit.unknowns) {
    const bool shared = opencv && opencv->sigmaOf(unknown) > 0 && fit.kind == opencv->kind;
    table.rows.push_back({std::string(cameraUnknowns()[unknown].name),
                          plusMinus(valueOf(fit, unknown), fit.sigmaOf(unknown)),
                          std::string(cameraUnknowns()[unknown].unit),
                          shared ? plusMinus(valueOf(*opencv, unknown), opencv->sigmaOf(unknown)) : "-"});
  }
  return table;
}

std::string cameraInfoYaml(const CameraModel& camera, const std::string& name) {
  const char* model = camera.lens == LensModel::fisheye    ? "equidistant"
                      : camera.lens == LensModel::rational ? "rational_polynomial"
                                                           : "plumb_bob";
  std::string coefficients;
  int count = 0;
  for (const LensCoefficient& c : coefficientsOf(camera.lens)) {
    coefficients += (count++ > 0 ? ", " : "") + print("%.12g", camera.*c.value);
  }
  const std::string K = print("%.12g, 0, %.12g, 0, %.12g, %.12g, 0, 0, 1", camera.fx_px, camera.cx_px,
                              camera.fy_px, camera.cy_px);
  const std::string P = print("%.12g, 0, %.12g, 0, 0, %.12g, %.12g, 0, 0, 0, 1, 0", camera.fx_px,
                              camera.cx_px, camera.fy_px, camera.cy_px);
  return print("image_width: %d\nimage_height: %d\ncamera_name: %s\n", camera.width_px, camera.height_px,
               name.c_str()) +
         "camera_matrix: {rows: 3, cols: 3, data: [" + K + "]}\ndistortion_model: " + model +
         print("\ndistortion_coefficients: {rows: 1, cols: %d, data: [", count) + coefficients +
         "]}\nrectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n"
         "projection_matrix: {rows: 3, cols: 4, data: [" +
         P + "]}\n";
}

void writeCameraStory(const CameraStory& story, const fs::path& folder) {
  fs::create_directories(folder);
  const CameraFit& fit = chosenOf(story).fit;
  writeTextFile(folder / "camera.yaml", cameraInfoYaml(lensOf(fit.values, *fit.kind, fit.setting), "camera"));
  if (const auto port = portOf(fit); port.on.any())
    writeTextFile(folder / "calibration.yaml", formatCalibration(port));
  writeJson(folder / "result.json", toJson(story));
  writeReport(story, folder / "report.html");
}

}  // namespace fathom
