#include "sil/sil_run.h"

#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "core/version.h"
#include "effects/calibration.h"
#include "evaluation/contact_sheet.h"
#include "image_files/encode_image.h"
#include "image_files/one_opencv_thread.h"
#include "imaging/fingerprints.h"
#include "recording/rawlog.h"
#include "sil/pair_video.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLongestVideo = 3000;  // pictures: five minutes, some 300 MB
constexpr int kVideoWidth_px = 400;          // of each of the three
constexpr int kSheetTile_px = 400;

// ---- what all pairs depend on

std::string inputsOf(const KnownWorld& world, const SilOptions& options,
                     const std::vector<SilColumn>& columns) {
  std::string text = "What these pairs were made from; a run with other inputs removes them.\nversion " +
                     std::string(programVersion()) + "\ncamera " + fingerprintOf(*world.vehicle.camera) +
                     "\nlamps " + fingerprintOf(world.vehicle.lamps) + "\n";
  for (const PanelMap& panel : world.panels) text += "panel " + fingerprintOf(panel) + "\n";
  text += "water and light " + fingerprintOf(world.environment) + "\n";
  if (world.sea_floor)
    text += print("sea floor %.17g m, sand %zu\n", world.sea_floor->z_m,
                  static_cast<std::size_t>(world.sea_floor->sand_seed));
  text += print("%s of seed %zu\n", options.pairs.noise ? "noise" : "no noise, draws",
                static_cast<std::size_t>(options.pairs.seed));
  text += print("offset %.17g px\ndetector ", options.pairs.largest_offset_px) +
          std::string(nameOf(options.detection.backend)) + "\n";
  text += print("residuals to %.17g\n", options.residual.full_scale);
  for (const SilColumn& column : columns) text += "measure " + column.name + "\n";
  return text + formatCalibration(world.effects);
}

// ---- columns

std::vector<std::string> measureIds(const SilOptions& options) {
  std::vector<std::string> ids = options.measures;
  if (ids.empty())
    for (const RegisteredMeasure& measure : kMeasures) ids.emplace_back(measure.id);
  return ids;
}

std::string columnName(const RegisteredMeasure& measure, const Quantity& quantity) {
  std::string name(measure.id);
  if (measure.quantities.size() > 1) name.append("-").append(quantity.name);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

std::vector<SilColumn> columnsOf(const std::vector<std::string>& ids) {
  std::vector<SilColumn> columns;
  for (std::size_t i = 0; i < ids.size(); ++i)
    for (const RegisteredMeasure& measure : kMeasures)
      if (measure.id == ids[i])
        for (const Quantity& quantity : measure.quantities)
          columns.push_back({columnName(measure, quantity), std::string(quantity.unit), quantity.better, i});
  return columns;
}

/// Values of all measures, one beside the other.
void put(const std::vector<Measurement>& measurements, PairRecord& record) {
  for (const Measurement& measurement : measurements) {
    auto values = measurement.outcome.values;
    values.resize(measurement.measure->quantities.size());
    record.values.insert(record.values.end(), values.begin(), values.end());
    record.unmeasured.push_back(measurement.outcome.why_not);
  }
}

// ---- one pair

/// What becomes of one image on its way through the pipeline.
struct Finished {
  std::size_t index = 0;  ///< among the images chosen
  PairRecord record;
  bool taken_over = false;
  cv::Mat video_picture;  ///< where one is wanted
};

std::string frameName(const PosedImage& posed) { return print("%06zu_frame.jpg", posed.number); }

/// What all threads share.
struct Workshop {
  const PairMaker& maker;
  const PairMeasurer& measurer;
  const PairStore& store;
  const SilOptions& options;
  fs::path frames;
  std::size_t video_step;  ///< each so many-th pair is in the video; 0: none

  Finished finish(std::size_t index, const PosedImage& posed) const {
    Finished finished{index, {}, false, {}};
    if (auto kept = store.read(posed)) {
      finished.record = std::move(*kept);
      finished.taken_over = true;
      takeOver(posed, finished);
    } else {
      make(posed, finished);
    }
    return finished;
  }

 private:
  bool isInVideo(const Finished& finished) const {
    return video_step > 0 && finished.index % video_step == 0;
  }

  void takeOver(const PosedImage& posed, Finished& finished) const {
    if (!finished.record.why_not.empty()) return;
    const bool frame = options.frames && !isThere(frames / frameName(posed));
    if (frame || isInVideo(finished)) draw(posed, store.readImages(posed, maker), frame, finished);
  }

  void make(const PosedImage& posed, Finished& finished) const {
    PairRecord& record = finished.record;
    SilPair pair;
    try {
      pair = maker.make(posed);
    } catch (const Error& error) {
      record.why_not = (error.where.empty() ? "" : error.where + ": ") + error.why;
      return store.write(posed, record, nullptr);
    }
    record.range_m = pair.range_m;
    record.view_angle_rad = pair.view_angle_rad;
    record.panel_share = pair.panel_share;
    put(measurer.measure(maker.compared(pair.images)), record);
    draw(posed, pair.images, options.frames, finished);
    store.write(posed, record, &pair);
  }

  void draw(const PosedImage& posed, const ImagePair& images, bool frame, Finished& finished) const {
    const cv::Mat region = maker.comparedRegion(images);
    const std::string caption = print("%s  %.2f m  %.0f deg  ", posed.image.file.filename().c_str(),
                                      finished.record.range_m, degrees(finished.record.view_angle_rad)) +
                                legendOf(options.residual);
    if (frame)
      writeTextFile(frames / frameName(posed),
                    jpegBytes(pairPicture(images, region, options.residual, caption), 95));
    if (isInVideo(finished))
      finished.video_picture = pairPicture(images, region, options.residual, caption, kVideoWidth_px);
  }
};

// ---- what goes out, in order

/// Takes finished pairs one by one.
class Outputs {
 public:
  Outputs(const SilTarget& target, Time start, SilResults& results)
      : rawlog_(rawlogFile(target), target.header, start), video_(videoFile(target)), results_(results) {}

  static fs::path rawlogFile(const SilTarget& target) {
    return target.folder / (target.name + "_pairs.rawlog");
  }

  static fs::path videoFile(const SilTarget& target) { return target.folder / (target.name + "_pairs.avi"); }

  void take(const PosedImage& posed, const Finished& finished) {
    if (!finished.record.why_not.empty()) {
      results_.unpaired.push_back({posed.time, posed.number, posed.image.file, finished.record.why_not});
      return;
    }
    const PairFiles files = PairStore::filesOf(posed);
    writeImage(posed, labels::kCamera, files.recorded);
    writeImage(posed, labels::kSimulated, files.simulated);
    rawlog_.write({posed.time, labels::kMarkers, PoseSample{posed.T_odom_robot.toYawPitchRoll(), {}}});
    if (!finished.video_picture.empty()) video_.write(finished.video_picture);
    results_.taken_over += finished.taken_over ? 1 : 0;
    results_.pairs.push_back({posed, finished.record});
  }
  void finish() {
    video_.finish();
    rawlog_.finish();
  }

 private:
  void writeImage(const PosedImage& posed, const char* label, const std::string& file) {
    rawlog_.write(
        {posed.time, label, ImageSample{posed.T_robot_camera, recordedCamera(posed.image.camera), file}});
  }

  RawlogWriter rawlog_;
  PairVideo video_;
  SilResults& results_;
};

/// What would tell of other pairs than this run's.
void removeStale(const SilOptions& options, const SilTarget& target, const fs::path& frames) {
  std::error_code absent;
  fs::remove(Outputs::rawlogFile(target), absent);
  if (!options.video) fs::remove(Outputs::videoFile(target), absent);
  if (!options.frames) keepOnly(frames, {});
}

/// Pictures of pairs of an earlier run that are none of this one.
void removeOthers(const SilResults& results, const fs::path& images, const fs::path& frames) {
  std::set<std::string> files;
  for (const SilPairResult& pair : results.pairs) {
    for (const std::string& file : PairStore::filesOf(pair.posed).all()) files.insert(file);
    files.insert(frameName(pair.posed));
  }
  keepOnly(images, files);
  keepOnly(frames, files);
}

// ---- all

std::vector<const PosedImage*> chosen(const PosedImages& images, std::size_t every) {
  std::vector<const PosedImage*> some;
  for (const PosedImage& posed : images.posed)
    if (posed.number % every == 0) some.push_back(&posed);
  return some;
}

std::vector<UnposedImage> unposed(const PosedImages& images, std::size_t every) {
  std::vector<UnposedImage> some;
  for (const UnposedImage& image : images.unposed)
    if (image.number % every == 0) some.push_back(image);
  return some;
}

[[noreturn]] void complainOfNone(const SilResults& results, const fs::path& recording) {
  std::map<std::string, std::size_t> reasons;
  for (const UnposedImage& image : results.unpaired) ++reasons[image.why];
  const auto most = std::max_element(reasons.begin(), reasons.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  throw Error(recording.string(), "",
              print("none of its %zu images can be paired (%zu times: %s)", results.unpaired.size(),
                    most->second, most->first.c_str()));
}

/// Makes many at a time and takes them in their order.
void pairAll(const std::vector<const PosedImage*>& posed, const Workshop& workshop, Outputs& outputs) {
  Progress progress("pairing " + std::to_string(posed.size()) + " images");
  std::size_t next = 0;
  const auto hand_out = [&](tbb::flow_control& control) {
    if (next == posed.size()) control.stop();
    return next == posed.size() ? next : next++;
  };
  const auto finish = [&](std::size_t i) { return workshop.finish(i, *posed[i]); };
  const auto take = [&](const Finished& finished) {
    outputs.take(*posed[finished.index], finished);
    progress.update(static_cast<double>(finished.index + 1) / static_cast<double>(posed.size()));
  };
  using enum tbb::filter_mode;
  const auto threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  tbb::task_group_context apart(tbb::task_group_context::isolated);  // as loops are, see parallel.cpp
  tbb::parallel_pipeline(2 * threads,
                         tbb::make_filter<void, std::size_t>(serial_in_order, hand_out) &
                             tbb::make_filter<std::size_t, Finished>(parallel, finish) &
                             tbb::make_filter<Finished, void>(serial_in_order, take),
                         apart);
}

/// For each of `count` ranges, evenly spread, the pair that is nearest to it.
std::vector<const SilPairResult*> spreadOverRange(const SilResults& results, std::size_t count) {
  const auto [near, far] =
      std::minmax_element(results.pairs.begin(), results.pairs.end(),
                          [](const auto& a, const auto& b) { return a.record.range_m < b.record.range_m; });
  std::vector<const SilPairResult*> some;
  for (std::size_t i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count);
    const double range_m = near->record.range_m + share * (far->record.range_m - near->record.range_m);
    const auto pair =
        std::min_element(results.pairs.begin(), results.pairs.end(), [&](const auto& a, const auto& b) {
          return std::abs(a.record.range_m - range_m) < std::abs(b.record.range_m - range_m);
        });
    if (some.empty() || some.back() != &*pair) some.push_back(&*pair);
  }
  return some;
}

}  // namespace

SilResults runSil(const PosedImages& images, const PairMaker& maker, const SilOptions& options,
                  const SilTarget& target) {
  const OneOpenCvThread one_thread;
  SilResults results;
  results.unpaired = unposed(images, options.every);
  results.measures = measureIds(options);
  results.columns = columnsOf(results.measures);
  const PairMeasurer measurer(results.measures);
  const auto posed = chosen(images, options.every);
  if (posed.empty()) complainOfNone(results, target.recording);

  const fs::path frames = target.folder / (target.name + "_frames");
  removeStale(options, target, frames);
  const PairStore store(target.folder, target.name, inputsOf(maker.world(), options, results.columns));
  const Workshop workshop{maker,   measurer, store,
                          options, frames,   options.video ? 1 + (posed.size() - 1) / kLongestVideo : 0};
  Outputs outputs(target, posed.front()->time, results);
  pairAll(posed, workshop, outputs);
  if (results.pairs.empty()) complainOfNone(results, target.recording);
  removeOthers(results, store.images(), frames);
  outputs.finish();
  stableSort(results.unpaired, [](const auto& a, const auto& b) { return a.time < b.time; });
  return results;
}

cv::Mat silSheet(const SilResults& results, const PairMaker& maker, const SilOptions& options,
                 const SilTarget& target, std::size_t count) {
  const OneOpenCvThread one_thread;
  const fs::path folder = PairStore::imageFolder(target.folder, target.name);
  std::vector<SheetRow> rows;
  for (const SilPairResult* pair : spreadOverRange(results, count)) {
    const PairRecord& record = pair->record;
    SheetRow row{{pair->posed.image.file.filename().string(),
                  print("%.2f m, %.0f deg", record.range_m, degrees(record.view_angle_rad))},
                 {}};
    for (std::size_t i = 0; i < std::min<std::size_t>(4, results.columns.size()); ++i)
      row.label.push_back(print("%s %.4f", results.columns[i].name.c_str(),
                                record.values[i].value_or(std::numeric_limits<double>::quiet_NaN())));
    const ImagePair images = PairStore::readImages(folder, pair->posed, maker);
    row.tiles = pairTiles(images, maker.comparedRegion(images), options.residual, kSheetTile_px);
    rows.push_back(std::move(row));
  }
  return contactSheet(legendOf(options.residual) + " of full scale", {"recorded", "simulated", "residual"},
                      rows);
}

}  // namespace fathom
