#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <algorithm>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "fiducials/marker_reader.h"
#include "panel/marker_family.h"

namespace fathom {
namespace {

using TagFamily = std::unique_ptr<apriltag_family_t, std::function<void(apriltag_family_t*)>>;

/// The table of codes with up to n wrong bits takes 48 bytes an entry: at most 200 MB.
constexpr double kLargestTable = 4e6;
/// Of a corner coordinate, seen on synthetic images (0.05 to 0.15 px) with some caution.
constexpr double kApriltagSigma_px = 0.2;
/// Chance makes code words of flat noise too, by a digital number or less.
constexpr double kSmallestMargin = 2.0;
constexpr double kLargestBorderErrorRate = 0.25;

struct NativeFamily {
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};
const std::map<std::string, NativeFamily>& nativeFamilies() {
  static const std::map<std::string, NativeFamily> families{
      {"tag16h5", {tag16h5_create, tag16h5_destroy}},
      {"tag25h9", {tag25h9_create, tag25h9_destroy}},
      {"tag36h10", {tag36h10_create, tag36h10_destroy}},
      {"tag36h11", {tag36h11_create, tag36h11_destroy}},
      {"tagCircle21h7", {tagCircle21h7_create, tagCircle21h7_destroy}},
      {"tagCircle49h12", {tagCircle49h12_create, tagCircle49h12_destroy}},
      {"tagCustom48h12", {tagCustom48h12_create, tagCustom48h12_destroy}},
      {"tagStandard41h12", {tagStandard41h12_create, tagStandard41h12_destroy}},
      {"tagStandard52h13", {tagStandard52h13_create, tagStandard52h13_destroy}}};
  return families;
}

/// An AprilTag family with the code words of an OpenCV dictionary, and the arrays it points to.
struct DictionaryFamily {
  apriltag_family_t family{};
  std::vector<std::uint64_t> codes;
  std::vector<std::uint32_t> bit_x, bit_y;
  std::string name;
};

struct Cell {
  int x, y;
};

/// AprilTag turns a code word by shifting it by a quarter of its bits: the first quarter are the cells of one
/// quadrant, the next the same cells turned clockwise, and so on; the centre cell of an odd square is last.
std::vector<Cell> cellsInTurningOrder(int bits) {
  std::vector<Cell> cells;
  for (int y = 0; y < bits / 2; ++y)
    for (int x = y; x < bits - 1 - y; ++x) cells.push_back({x, y});
  const std::size_t quarter = cells.size();
  for (std::size_t i = 0; i < 3 * quarter; ++i) {
    const Cell cell = cells[i];
    cells.push_back({bits - 1 - cell.y, cell.x});
  }
  if (bits % 2 == 1) cells.push_back({bits / 2, bits / 2});
  return cells;
}

/// `bits`: the side of the square of cells that carry the code, in the pattern's middle.
std::uint64_t codeWord(const MarkerPattern& pattern, int bits, const std::vector<Cell>& cells) {
  std::uint64_t code = 0;
  const int origin = (pattern.cells - bits) / 2;
  for (const Cell& cell : cells)
    code = code << 1U | static_cast<std::uint64_t>(pattern.whiteAt(origin + cell.y, origin + cell.x));
  return code;
}

TagFamily familyFromDictionary(const std::string& name, int border_width) {
  auto owned = std::make_unique<DictionaryFamily>();
  const int bits = markerPattern(name, 0).border_cells - 2;
  const auto cells = cellsInTurningOrder(bits);
  for (int id = 0; id < markerCount(name); ++id)
    owned->codes.push_back(codeWord(markerPattern(name, id), bits, cells));
  for (const Cell& cell : cells) {  // counted from the corner of the border
    owned->bit_x.push_back(static_cast<std::uint32_t>(cell.x + border_width));
    owned->bit_y.push_back(static_cast<std::uint32_t>(cell.y + border_width));
  }
  owned->name = name;
  apriltag_family_t& family = owned->family;
  family.ncodes = static_cast<std::uint32_t>(owned->codes.size());
  family.codes = owned->codes.data();
  family.width_at_border = bits + 2 * border_width;
  family.total_width = family.width_at_border + 2;
  family.reversed_border = false;
  family.nbits = static_cast<std::uint32_t>(cells.size());
  family.bit_x = owned->bit_x.data();
  family.bit_y = owned->bit_y.data();
  family.h = static_cast<std::uint32_t>(hammingDistance(name));
  family.name = owned->name.data();
  DictionaryFamily* released = owned.release();
  return {&released->family, [released](apriltag_family_t*) { delete released; }};
}

TagFamily makeFamily(const std::string& name, int border_width) {
  const auto native = nativeFamilies().find(name);
  if (native == nativeFamilies().end() || border_width != 1) return familyFromDictionary(name, border_width);
  return {native->second.create(), native->second.destroy};
}

int affordableBits(const apriltag_family_t& family, int wanted) {
  const double n = family.nbits;
  const double entries[] = {1.0, 1.0 + n, 1.0 + n + n * (n - 1.0) / 2.0};
  int bits = std::min(wanted, 2);
  while (bits > 0 && family.ncodes * entries[bits] > kLargestTable) --bits;
  return bits;
}

/// AprilTag counts pixels from the top left pixel's corner, and corners from the bottom left
/// counter-clockwise.
std::array<Vector2d, 4> ourCorners(const apriltag_detection_t& tag) {
  std::array<Vector2d, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) corners[k] = {tag.p[3 - k][0] - 0.5, tag.p[3 - k][1] - 0.5};
  return corners;
}

/// What of the border square is not as it must be: share of its cells that do not differ from the cell
/// outside them as most do. AprilTag reads any quadrangle; where codes are many, chance makes words of some.
double borderErrorRate(const cv::Mat& gray, const std::array<Vector2d, 4>& corners, int border_cells) {
  const auto n = static_cast<float>(border_cells);
  const std::array<cv::Point2f, 4> square{cv::Point2f(0, 0), {n, 0}, {n, n}, {0, n}};
  std::array<cv::Point2f, 4> seen;
  for (std::size_t k = 0; k < 4; ++k)
    seen[k] = {static_cast<float>(corners[k].x()), static_cast<float>(corners[k].y())};
  const cv::Matx33d H = cv::getPerspectiveTransform(square.data(), seen.data());
  const auto valueAt = [&](double x, double y) {
    const cv::Vec3d p = H * cv::Vec3d(x, y, 1);
    const int column = std::clamp(cvRound(p[0] / p[2]), 0, gray.cols - 1);
    const int row = std::clamp(cvRound(p[1] / p[2]), 0, gray.rows - 1);
    return static_cast<double>(gray.at<std::uint8_t>(row, column));
  };
  std::vector<double> steps;
  double mean = 0;
  for (int i = 0; i < border_cells; ++i) {
    const double along = i + 0.5, outside = -0.5, inside = 0.5;
    const double far_outside = border_cells + 0.5, far_inside = border_cells - 0.5;
    for (const double step : {valueAt(along, outside) - valueAt(along, inside),
                              valueAt(along, far_outside) - valueAt(along, far_inside),
                              valueAt(outside, along) - valueAt(inside, along),
                              valueAt(far_outside, along) - valueAt(far_inside, along)}) {
      steps.push_back(step);
      mean += step;
    }
  }
  mean /= static_cast<double>(steps.size());
  const auto wrong = std::count_if(steps.begin(), steps.end(),
                                   [&](double step) { return step * mean < 0.25 * mean * mean; });
  return static_cast<double>(wrong) / static_cast<double>(steps.size());
}

bool isBelievable(const cv::Mat& gray, const apriltag_detection_t& tag, const Detection& detection) {
  return detection.decision_margin >= kSmallestMargin &&
         borderErrorRate(gray, detection.corners_px, tag.family->width_at_border) <= kLargestBorderErrorRate;
}

class AprilTagReader : public MarkerReader {
 public:
  AprilTagReader(const std::vector<std::string>& families, int largest_corrected_bits, int border_width)
      : detector_(apriltag_detector_create(), apriltag_detector_destroy) {
    detector_->nthreads = 1;
    detector_->quad_decimate = 1.0F;  // regions of large markers come scaled down
    detector_->refine_edges = false;  // see refineCorners()
    for (const auto& name : families) {
      families_.push_back(makeFamily(name, border_width));
      const int wanted = correctableBits(name, largest_corrected_bits);
      apriltag_detector_add_family_bits(detector_.get(), families_.back().get(),
                                        affordableBits(*families_.back(), wanted));
    }
  }
  ~AprilTagReader() override { apriltag_detector_clear_families(detector_.get()); }
  AprilTagReader(const AprilTagReader&) = delete;
  AprilTagReader& operator=(const AprilTagReader&) = delete;

  std::vector<Detection> read(const cv::Mat& gray, double /*smallest_side_px*/) override {
    image_u8_t image{gray.cols, gray.rows, static_cast<std::int32_t>(gray.step), gray.data};
    const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(
        apriltag_detector_detect(detector_.get(), &image), apriltag_detections_destroy);
    std::vector<Detection> detections;
    for (int i = 0; i < zarray_size(found.get()); ++i) {
      apriltag_detection_t* tag = nullptr;
      zarray_get(found.get(), i, &tag);
      Detection detection;
      detection.family = tag->family->name;
      detection.id = tag->id;
      detection.corners_px = ourCorners(*tag);
      detection.covariance_px2 *= kApriltagSigma_px * kApriltagSigma_px;
      detection.corrected_bits = tag->hamming;
      detection.decision_margin = tag->decision_margin;
      if (isBelievable(gray, *tag, detection)) detections.push_back(detection);
    }
    return detections;
  }

 private:
  std::vector<TagFamily> families_;  // outlive the detector, which points to them
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector_;
};

}  // namespace

std::unique_ptr<MarkerReader> makeAprilTagReader(const std::vector<std::string>& families,
                                                 int largest_corrected_bits, int border_width) {
  return std::make_unique<AprilTagReader>(families, largest_corrected_bits, border_width);
}

}  // namespace fathom
