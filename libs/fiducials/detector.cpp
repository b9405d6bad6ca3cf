#include "fiducials/detector.h"

#include <algorithm>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <tuple>

#include "fiducials/corner_refinement.h"
#include "fiducials/marker_reader.h"
#include "panel/marker_family.h"

namespace fathom {
namespace {

/// Of a marker confirmed: chance makes differences too, by a digital number or less.
constexpr double kConfirmedMargin = 2.0;
/// Corners better than this (three sigma) need no search from afar.
constexpr double kNear_px = 1.0;
/// What refinement asks for, of a cell; and how far it may then move a corner.
constexpr double kRough = 1.0 / 3.0, kFarthestMove = 0.5;
/// A cell this wide is read safely; larger ones are scaled down to it.
constexpr double kReadableCell_px = 4.0;

int borderCells(const std::string& family, int border_width) {
  return markerPattern(family, 0).border_cells + 2 * (border_width - 1);
}

double meanSide_px(const std::array<Vector2d, 4>& corners) {
  const auto sides = sides_px(corners);
  return 0.25 * (sides[0] + sides[1] + sides[2] + sides[3]);
}

bool isSameMarker(const Detection& a, const Detection& b) {
  return a.family == b.family && a.id == b.id &&
         (a.centre_px() - b.centre_px()).norm() < 0.5 * meanSide_px(a.corners_px);
}

void sortByPlace(std::vector<Detection>& detections) {
  std::sort(detections.begin(), detections.end(), comesBefore);
}

/// Those of `more` that are not among `detections` yet.
void addNew(const std::vector<Detection>& more, std::vector<Detection>& detections) {
  for (const Detection& candidate : more)
    if (std::none_of(detections.begin(), detections.end(),
                     [&](const Detection& known) { return isSameMarker(known, candidate); }))
      detections.push_back(candidate);
}

/// Whether the image's border may cut the marker off: a reader then takes what is left for a square, its
/// corners pixels off.
bool mayBeCutOff(const Detection& detection, double cell_px, const cv::Mat& image) {
  const double margin_px = 0.5 * cell_px;
  return std::any_of(detection.corners_px.begin(), detection.corners_px.end(), [&](const Vector2d& corner) {
    return std::min(corner.x(), corner.y()) < margin_px || corner.x() > image.cols - 1 - margin_px ||
           corner.y() > image.rows - 1 - margin_px;
  });
}

/// What there is to know of a backend beside its reader.
struct BackendEntry {
  std::string_view name;
  std::unique_ptr<MarkerReader> (*makeReader)(const std::vector<std::string>& families,
                                              int largest_corrected_bits, int border_width);
  bool reads_any_border, rough_corners;
  Backend fallback;  ///< for what it does not find
};

/// The only registration, in the order of Backend.
const BackendEntry& entryOf(Backend backend) {
  static constexpr std::array<BackendEntry, kBackends.size()> kEntries{
      {{"aruco", makeArucoReader, false, true, Backend::apriltag},
       {"apriltag", makeAprilTagReader, true, false, Backend::aruco}}};
  static_assert(kEntries.back().makeReader != nullptr);
  return kEntries[static_cast<std::size_t>(backend)];
}

/// What is common to the backends: regions and their scale, preprocessing, refinement.
class ReaderDetector : public Detector {
 public:
  ReaderDetector(std::unique_ptr<MarkerReader> reader, const std::vector<std::string>& families,
                 const DetectorOptions& options)
      : reader_(std::move(reader)), options_(options) {
    for (const auto& family : families)
      border_cells_.emplace_back(family, borderCells(family, options.look.border_width));
  }

  std::optional<Detection> confirm(const cv::Mat& image, const ExpectedMarker& expected) override {
    if (!options_.refine || !isRead(expected.family) || !hasPlainBorder(expected.family)) return std::nullopt;
    const cv::Mat gray = options_.look.white_on_black ? cv::Mat(255 - image) : image;
    const MarkerPattern& pattern = patternOf(expected.family, expected.id);
    Detection detection;
    detection.family = expected.family;
    detection.id = expected.id;
    detection.corners_px = expected.corners_px;
    const double cell_px = cellOf(detection), farthest_px = 3.0 * expected.sigma_px;
    if (farthest_px > kRough * cell_px) {
      const auto located = locateMarker(gray, pattern, expected);
      if (!located) return std::nullopt;
      detection.corners_px = *located;
    }
    const auto rough_px = detection.corners_px;
    const bool near = farthest_px <= std::min(kNear_px, kRough * cell_px);
    refine(gray, detection, near ? expected.blur_sigma_px : std::nullopt);
    if (!detection.refined || mayBeCutOff(detection, cell_px, gray)) return std::nullopt;
    for (std::size_t k = 0; k < 4; ++k)
      if ((detection.corners_px[k] - rough_px[k]).norm() > kFarthestMove * cell_px) return std::nullopt;

    const CellReading reading = readCells(gray, pattern, detection.corners_px);
    if (!reading.border_is_whole || reading.margin < kConfirmedMargin ||
        reading.wrong_bits > correctableBits(expected.family, options_.largest_corrected_bits))
      return std::nullopt;
    detection.corrected_bits = reading.wrong_bits;
    detection.decision_margin = reading.margin;
    return detection;
  }

  using Detector::detect;
  std::vector<Detection> detect(const cv::Mat& image, const std::vector<SearchRegion>& regions) override {
    cv::Mat gray = toGray(image);
    if (options_.look.white_on_black) gray = 255 - gray;
    const bool is_expected = options_.expected_range && image.depth() == CV_8U;
    const GrayRange* range = is_expected ? &*options_.expected_range : nullptr;
    const cv::Mat searched = regions.empty() ? gray : preprocessed(gray, options_.preprocess, range);
    std::vector<Detection> detections;
    for (const SearchRegion& region : regions) {
      const cv::Rect area = region.area & cv::Rect(0, 0, gray.cols, gray.rows);
      if (area.width < kSmallestArea_px || area.height < kSmallestArea_px) continue;
      addNew(search(searched, area, region.smallest_side_px), detections);
    }
    std::erase_if(detections, [&](const auto& d) { return mayBeCutOff(d, cellOf(d), gray); });
    if (options_.refine)
      for (Detection& detection : detections) refine(gray, detection);
    sortByPlace(detections);
    return detections;
  }

 private:
  static constexpr int kSmallestArea_px = 12;

  bool isRead(const std::string& family) const {
    return std::any_of(border_cells_.begin(), border_cells_.end(),
                       [&](const auto& entry) { return entry.first == family; });
  }

  const MarkerPattern& patternOf(const std::string& family, int id) {
    const auto [entry, is_new] = patterns_.try_emplace({family, id});
    // Reversed images are searched for what is black on white.
    if (is_new) entry->second = markerPattern(family, id, {options_.look.border_width, false});
    return entry->second;
  }

  int cellsOf(const std::string& family) const {
    return std::find_if(border_cells_.begin(), border_cells_.end(),
                        [&](const auto& entry) { return entry.first == family; })
        ->second;
  }

  double cellOf(const Detection& detection) const {
    return meanSide_px(detection.corners_px) / cellsOf(detection.family);
  }

  /// Whole factor by which a region may be scaled down.
  int scaleFor(double smallest_side_px) const {
    int most_cells = 0;
    for (const auto& [family, cells] : border_cells_) most_cells = std::max(most_cells, cells);
    return std::clamp(static_cast<int>(smallest_side_px / (kReadableCell_px * most_cells)), 1, 8);
  }

  /// Not refined.
  std::vector<Detection> search(const cv::Mat& image, const cv::Rect& area, double smallest_side_px) {
    const int scale = scaleFor(smallest_side_px);
    const cv::Rect divisible(area.x, area.y, area.width / scale * scale, area.height / scale * scale);
    cv::Mat part = image(divisible);
    if (scale > 1) cv::resize(image(divisible), part, divisible.size() / scale, 0, 0, cv::INTER_AREA);
    std::vector<Detection> detections = reader_->read(part, smallest_side_px / scale);
    for (Detection& detection : detections) {
      for (Vector2d& corner : detection.corners_px)
        corner = ((corner.array() + 0.5) * scale - 0.5).matrix() + Vector2d(area.x, area.y);
      detection.covariance_px2 *= scale * scale;
    }
    return detections;
  }

  void refine(const cv::Mat& gray, Detection& detection,
              const std::optional<double>& blur_sigma_px = std::nullopt) const {
    const auto refined = refineCorners(gray, detection.corners_px, cellOf(detection),
                                       options_.camera ? &*options_.camera : nullptr, blur_sigma_px);
    if (!refined) return;
    detection.corners_px = refined->corners_px;
    detection.covariance_px2 = refined->covariance_px2;
    detection.contrast = refined->contrast;
    detection.blur_sigma_px = refined->blur_sigma_px;
    detection.refined = true;
  }

  std::unique_ptr<MarkerReader> reader_;
  DetectorOptions options_;
  std::vector<std::pair<std::string, int>> border_cells_;
  std::map<std::pair<std::string, int>, MarkerPattern> patterns_;  ///< of markers expected so far
};

}  // namespace

bool comesBefore(const Detection& a, const Detection& b) {
  const auto key = [](const Detection& d) {
    return std::tuple(std::string_view(d.family), d.id, d.corners_px[0].x(), d.corners_px[0].y());
  };
  return key(a) < key(b);
}

std::string_view nameOf(Backend backend) { return entryOf(backend).name; }

std::vector<std::string> backendNames() {
  std::vector<std::string> names;
  for (const Backend backend : kBackends) names.emplace_back(nameOf(backend));
  return names;
}

Backend backendNamed(const std::string& name) {
  std::string known;
  for (const Backend backend : kBackends) {
    if (name == nameOf(backend)) return backend;
    known += (known.empty() ? "" : ", ") + std::string(nameOf(backend));
  }
  throw std::invalid_argument("`" + name + "` is none of " + known);
}

Backend fallbackOf(Backend backend) { return entryOf(backend).fallback; }

bool hasRoughCorners(Backend backend) { return entryOf(backend).rough_corners; }

bool canRead(Backend backend, const std::string& family, const MarkerLook& look) {
  if (!isMarkerFamily(family)) return false;
  return hasPlainBorder(family) || (entryOf(backend).reads_any_border && look.border_width == 1);
}

std::vector<Detection> Detector::detect(const cv::Mat& image) {
  if (image.empty()) throw std::invalid_argument("the image is empty");
  return detect(image, {SearchRegion{cv::Rect(0, 0, image.cols, image.rows), 0}});
}

std::optional<Detection> Detector::confirm(const cv::Mat& /*gray*/, const ExpectedMarker& /*expected*/) {
  return std::nullopt;
}

std::unique_ptr<Detector> makeDetector(Backend backend, const std::vector<std::string>& families,
                                       const DetectorOptions& options) {
  if (families.empty()) throw std::invalid_argument("no marker family given");
  for (const auto& family : families) {
    if (!isMarkerFamily(family)) throw std::invalid_argument("no such marker family: `" + family + "`");
    if (!canRead(backend, family, options.look))
      throw std::invalid_argument("the " + std::string(nameOf(backend)) + " backend cannot read " + family +
                                  (options.look.border_width == 1 ? "" : " with such a border"));
  }
  auto unique = families;
  std::sort(unique.begin(), unique.end());
  unique.erase(std::unique(unique.begin(), unique.end()), unique.end());
  auto reader =
      entryOf(backend).makeReader(unique, options.largest_corrected_bits, options.look.border_width);
  return std::make_unique<ReaderDetector>(std::move(reader), unique, options);
}

std::vector<Detection> FallbackDetector::detect(const cv::Mat& image,
                                                const std::vector<SearchRegion>& regions) {
  std::vector<Detection> detections = first_->detect(image, regions);
  if (detections.size() >= expected_count_) return detections;
  addNew(second_->detect(image, regions), detections);
  sortByPlace(detections);
  return detections;
}

std::optional<Detection> FallbackDetector::confirm(const cv::Mat& gray, const ExpectedMarker& expected) {
  auto detection = first_->confirm(gray, expected);
  return detection ? detection : second_->confirm(gray, expected);
}

}  // namespace fathom
