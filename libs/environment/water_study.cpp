#include "environment/water_study.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "core/error.h"
#include "core/evenly.h"
#include "core/for_each.h"
#include "core/parallel.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "evaluation/contact_sheet.h"
#include "image_files/jpeg.h"
#include "image_files/one_opencv_thread.h"
#include "sil/pair_picture.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kFewestImages = 3;
constexpr std::size_t kSheetRows = 4;
constexpr int kTile_px = 320;

// ---- what the stages share

struct Studio {
  const std::vector<PosedImage>& posed;
  const PairMaker& maker;
  WaterCamera camera;
  FsimComparer fsim;
  const WaterStudyOptions& options;

  double range(std::size_t image) const { return range_m(posed[image], maker.world().panels); }
};

/// So many of the images, spread evenly over range, nearest first.
std::vector<std::size_t> byRange(std::vector<std::size_t> images, std::size_t count, const Studio& studio) {
  stableSort(images, [&](std::size_t a, std::size_t b) { return studio.range(a) < studio.range(b); });
  return evenly(images, count);
}

// ---- the paper's search

FsimSearch searchIn(const std::vector<std::size_t>& images, const Studio& studio) {
  const auto some = byRange(images, studio.options.search_images, studio);
  std::vector<CleanPair> pairs(some.size());
  parallelFor(some.size(), [&](std::size_t k) { pairs[k] = studio.maker.clean(studio.posed[some[k]]); });
  SharedProgress progress("the paper's search by FSIM", studio.options.search.evaluations * some.size());
  const auto similarity = [&](const Environment& water) {
    std::vector<double> scores(some.size());
    forEachIndex(some.size(), progress, [&](std::size_t k) {
      const PosedImage& posed = studio.posed[some[k]];
      const cv::Mat simulated = studio.camera.image(posed, pairs[k].clean, water);
      const ImagePair compared = comparedPair(studio.maker, pairs[k], simulated);
      const auto alike = studio.fsim.compare(compared.recorded, compared.simulated);
      scores[k] = alike ? alike->fsimc : 0;
    });
    return meanOf(scores).mean;
  };
  return searchByFsim(studio.options.fit.start, similarity, studio.options.search);
}

// ---- held-out images

void scoreCandidates(const std::vector<std::size_t>& images, const Studio& studio, WaterStudy& study) {
  std::vector<Environment> waters;
  for (const WaterCandidate& candidate : study.candidates) waters.push_back(candidate.environment);
  std::vector<std::vector<WaterScore>> scores(images.size());
  forEachIndex(images.size(), "judging on held-out images", [&](std::size_t k) {
    const PosedImage& posed = studio.posed[images[k]];
    scores[k].resize(waters.size());
    try {
      scores[k] = scoreImage(studio.maker, studio.camera, studio.fsim, posed, studio.maker.clean(posed),
                             waters, study.fit.gain_fitted);
    } catch (const Error&) {
      // An image that does not fit its pose cannot judge: its scores stay absent.
    }
  });
  for (std::size_t w = 0; w < waters.size(); ++w)
    for (const auto& of_image : scores) study.candidates[w].scores.push_back(of_image[w]);
}

cv::Mat sheetOf(const std::vector<std::size_t>& images, const Studio& studio, const WaterStudy& study) {
  std::vector<std::string> columns{"recorded"};
  for (const WaterCandidate& candidate : study.candidates) columns.push_back(candidate.name);
  std::vector<SheetRow> rows;
  const auto tile = [&](const cv::Mat& image, const CameraSheet& sheet) {
    cv::Mat small;
    cv::resize(brightenedForEye(image, sheet), small, {kTile_px, kTile_px * image.rows / image.cols}, 0, 0,
               cv::INTER_AREA);
    return small;
  };
  for (const std::size_t i : byRange(images, kSheetRows, studio)) {
    const PosedImage& posed = studio.posed[i];
    const CleanPair pair = studio.maker.clean(posed);
    SheetRow row{{print("%.1f m", studio.range(i))}, {tile(pair.recorded, studio.camera.sheet())}};
    for (const WaterCandidate& candidate : study.candidates)
      row.tiles.push_back(
          tile(studio.camera.image(posed, pair.clean, candidate.environment), studio.camera.sheet()));
    rows.push_back(row);
  }
  return contactSheet("held-out images, brightened for the eye", columns, rows);
}

// ---- complaints

[[noreturn]] void complainOfNoPose(const fs::path& rawlog, const PosedImages& images) {
  const std::string count = std::to_string(images.unposed.size());
  if (images.unposed.empty()) throw Error(rawlog.string(), "", "has no images");
  throw Error(rawlog.string(), "",
              "in none of its " + count +
                  " images markers tell where it was taken; the first: " + images.unposed.front().why);
}

void requireImages(const fs::path& rawlog, const SynchronizedImages& synchronized) {
  if (synchronized.images.size() >= kFewestImages) return;
  const std::string count = std::to_string(synchronized.images.size());
  if (synchronized.rejected.empty())
    throw Error(rawlog.string(), "",
                "only " + count + " images have a pose that is certain enough to fit on");
  const RejectedImage& first = synchronized.rejected.front();
  throw Error(
      rawlog.string(), "",
      "only " + count + " images can be fitted on; " + first.file.filename().string() + ": " + first.why);
}

}  // namespace

WaterStudy studyWater(const fs::path& rawlog, const PosedImages& images, const PairMaker& maker,
                      const WaterStudyOptions& options) {
  if (images.posed.empty()) complainOfNoPose(rawlog, images);
  WaterStudy study;
  study.images = images.posed.size() + images.unposed.size();
  study.posed = images.posed.size();
  study.remarks = images.remarks;
  if (const auto panels = maker.world().panels.size(); panels > 1)
    study.remarks.push_back(
        "panel poses (task T_P) are not checked: that takes a map of one panel, this one has " +
        std::to_string(panels));
  study.choice = chooseImages(images.posed, maker.world().panels, options.choice);
  study.synchronized = synchronize(images.posed, study.choice.fitted, maker);
  requireImages(rawlog, study.synchronized);
  study.jpeg_quality = jpegQuality(images.posed.front().image.file);
  const OneOpenCvThread one_thread;
  const Studio studio{images.posed, maker, {maker, study.jpeg_quality, options.seed}, {}, options};
  WaterFitOptions fit = options.fit;
  fit.known = {maker.world().effects, maker.world().vehicle.lamps};
  study.fit = fitWater(study.synchronized.patches, study.synchronized.images.size(), fit);
  if (!study.fit.solved) throw Error(rawlog.string(), "", "water cannot be fitted: " + study.fit.why_not);

  study.search = searchIn(study.synchronized.images, studio);
  study.truth = trueEnvironment(rawlog);
  study.candidates = {{"default", options.fit.start, {}},
                      {"paper's search", study.search.environment, {}},
                      {"fitted", study.fit.environment, {}}};
  if (study.truth) study.candidates.push_back({"truth", *study.truth, {}});
  scoreCandidates(study.choice.held_out, studio, study);
  study.recommended = study.choice.held_out.empty() ? 2 : recommended(study.candidates, 3);
  study.sheet = sheetOf(study.choice.held_out, studio, study);
  PanelPoseCheckOptions poses = options.panel_poses;
  poses.jpeg_quality = study.jpeg_quality;
  poses.seed = options.seed;
  study.panel_poses =
      checkPanelPoses(rawlog, images.posed, maker.world(), study.recommendedWater().environment, poses);
  return study;
}

std::string formatEnvironment(const Environment& environment, const std::string& comment) {
  std::string text;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) text += "# " + line + "\n";
  const auto colour = [](const Vector3d& c) { return print("[%.5f, %.5f, %.5f]", c[0], c[1], c[2]); };
  text += "water:\n  attenuation_per_m: " + colour(environment.water.attenuation_per_m) +
          "\n  veil: " + colour(environment.water.veil) + "\nambient: " + colour(environment.ambient) + "\n";
  if (environment.lamps_irradiance_1m)
    text += "lamps_irradiance_1m: " + colour(*environment.lamps_irradiance_1m) + "\n";
  return text;
}

}  // namespace fathom
