#include "panel/marker_family.h"

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
#include <map>
#include <memory>
#include <opencv2/aruco/dictionary.hpp>
#include <stdexcept>

namespace fathom {
namespace {

const std::map<std::string, cv::aruco::PREDEFINED_DICTIONARY_NAME> kDictionaries{
    {"DICT_4X4_50", cv::aruco::DICT_4X4_50},
    {"DICT_4X4_100", cv::aruco::DICT_4X4_100},
    {"DICT_4X4_250", cv::aruco::DICT_4X4_250},
    {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
    {"DICT_5X5_50", cv::aruco::DICT_5X5_50},
    {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
    {"DICT_5X5_250", cv::aruco::DICT_5X5_250},
    {"DICT_5X5_1000", cv::aruco::DICT_5X5_1000},
    {"DICT_6X6_50", cv::aruco::DICT_6X6_50},
    {"DICT_6X6_100", cv::aruco::DICT_6X6_100},
    {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
    {"DICT_6X6_1000", cv::aruco::DICT_6X6_1000},
    {"DICT_7X7_50", cv::aruco::DICT_7X7_50},
    {"DICT_7X7_100", cv::aruco::DICT_7X7_100},
    {"DICT_7X7_250", cv::aruco::DICT_7X7_250},
    {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
    {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
    {"DICT_APRILTAG_16h5", cv::aruco::DICT_APRILTAG_16h5},
    {"DICT_APRILTAG_25h9", cv::aruco::DICT_APRILTAG_25h9},
    {"DICT_APRILTAG_36h10", cv::aruco::DICT_APRILTAG_36h10},
    {"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11},
};

struct TagFunctions {
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};

const std::map<std::string, TagFunctions> kTags{
    {"tag16h5", {tag16h5_create, tag16h5_destroy}},
    {"tag25h9", {tag25h9_create, tag25h9_destroy}},
    {"tag36h10", {tag36h10_create, tag36h10_destroy}},
    {"tag36h11", {tag36h11_create, tag36h11_destroy}},
    {"tagCircle21h7", {tagCircle21h7_create, tagCircle21h7_destroy}},
    {"tagCircle49h12", {tagCircle49h12_create, tagCircle49h12_destroy}},
    {"tagCustom48h12", {tagCustom48h12_create, tagCustom48h12_destroy}},
    {"tagStandard41h12", {tagStandard41h12_create, tagStandard41h12_destroy}},
    {"tagStandard52h13", {tagStandard52h13_create, tagStandard52h13_destroy}},
};

using TagFamily = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;
TagFamily createTagFamily(const std::string& family) {
  const TagFunctions& functions = kTags.at(family);
  return {functions.create(), functions.destroy};
}

void requireId(const std::string& family, int id, int count) {
  if (id < 0 || id >= count)
    throw std::invalid_argument(family + " has no id " + std::to_string(id) + ", only 0 to " +
                                std::to_string(count - 1));
}

MarkerPattern blackPattern(int cells, int border_cells) {
  const auto side = static_cast<std::size_t>(cells);
  return {cells, border_cells, std::vector<std::uint8_t>(side * side, 0)};
}

void setWhite(MarkerPattern& pattern, int row, int column) {
  pattern.white.at(pattern.index(row, column)) = 1;
}

/// The bits inside a black border of one cell.
MarkerPattern arucoPattern(const cv::aruco::Dictionary& dictionary, int id) {
  const int bits = dictionary.markerSize;
  const cv::Mat inner =
      cv::aruco::Dictionary::getBitsFromByteList(dictionary.bytesList.rowRange(id, id + 1), bits);
  MarkerPattern pattern = blackPattern(bits + 2, bits + 2);
  for (int row = 0; row < bits; ++row)
    for (int column = 0; column < bits; ++column)
      if (inner.at<std::uint8_t>(row, column) != 0) setWhite(pattern, row + 1, column + 1);
  return pattern;
}

/// A square ring, one cell wide, as many cells along each side, centred.
void drawWhiteRing(MarkerPattern& pattern, int side_cells) {
  const int first = (pattern.cells - side_cells) / 2, last = first + side_cells - 1;
  for (int i = first; i <= last; ++i) {
    setWhite(pattern, first, i);
    setWhite(pattern, last, i);
    setWhite(pattern, i, first);
    setWhite(pattern, i, last);
  }
}

/// As apriltag_to_image() draws it: bit_x and bit_y count from the corner of the border square, which has
/// white outside (or, with a reversed border, inside).
MarkerPattern tagPattern(const apriltag_family_t& tag, int id) {
  MarkerPattern pattern = blackPattern(tag.total_width, tag.width_at_border);
  drawWhiteRing(pattern, tag.width_at_border + (tag.reversed_border ? 0 : 2));
  const int origin = (tag.total_width - tag.width_at_border) / 2;
  for (std::uint32_t bit = 0; bit < tag.nbits; ++bit)
    if ((tag.codes[id] >> (tag.nbits - 1 - bit) & 1U) != 0)
      setWhite(pattern, origin + static_cast<int>(tag.bit_y[bit]), origin + static_cast<int>(tag.bit_x[bit]));
  return pattern;
}

/// The border square alone, inside as many cells of `white` as there are to be more around it.
MarkerPattern borderSquareInside(const MarkerPattern& pattern, int more_cells, bool white) {
  const int n = pattern.border_cells, from = (pattern.cells - n) / 2;
  MarkerPattern wider = blackPattern(n + 2 * more_cells, n);
  if (white) std::fill(wider.white.begin(), wider.white.end(), std::uint8_t{1});
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column)
      wider.white[wider.index(row + more_cells, column + more_cells)] =
          pattern.white[pattern.index(row + from, column + from)];
  return wider;
}

MarkerPattern withWiderBorder(const MarkerPattern& pattern, const std::string& family, int border_width) {
  if (!hasPlainBorder(family) || border_width != 2)
    throw std::invalid_argument(family + " has no border " + std::to_string(border_width) + " cells wide");
  MarkerPattern wider = borderSquareInside(pattern, border_width - 1, false);
  wider.border_cells = wider.cells;
  const bool has_ring = pattern.cells > pattern.border_cells;
  return has_ring ? borderSquareInside(wider, 1, true) : wider;
}

MarkerPattern reversed(const MarkerPattern& pattern) {
  const bool has_ring = pattern.cells > pattern.border_cells;
  MarkerPattern reversed = has_ring ? pattern : borderSquareInside(pattern, 1, true);
  for (std::uint8_t& white : reversed.white) white = white == 0 ? 1 : 0;
  return reversed;
}

void requireFamily(const std::string& family) {
  if (!isMarkerFamily(family)) throw std::invalid_argument("no such marker family: `" + family + "`");
}

}  // namespace

const std::vector<std::string>& markerFamilies() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    all.reserve(kDictionaries.size() + kTags.size());
    for (const auto& entry : kDictionaries) all.push_back(entry.first);
    for (const auto& entry : kTags) all.push_back(entry.first);
    return all;  // "DICT_…" before "tag…": sorted
  }();
  return names;
}

bool isMarkerFamily(const std::string& family) {
  return kDictionaries.contains(family) || kTags.contains(family);
}

int markerCount(const std::string& family) {
  requireFamily(family);
  if (kTags.contains(family)) return static_cast<int>(createTagFamily(family)->ncodes);
  return cv::aruco::getPredefinedDictionary(kDictionaries.at(family))->bytesList.rows;
}

bool hasPlainBorder(const std::string& family) {
  return family.starts_with("DICT_") || family == "tag16h5" || family == "tag25h9" || family == "tag36h10" ||
         family == "tag36h11";
}

MarkerPattern markerPattern(const std::string& family, int id, const MarkerLook& look) {
  requireId(family, id, markerCount(family));
  MarkerPattern pattern =
      kTags.contains(family)
          ? tagPattern(*createTagFamily(family), id)
          : arucoPattern(*cv::aruco::getPredefinedDictionary(kDictionaries.at(family)), id);
  if (look.border_width != 1) pattern = withWiderBorder(pattern, family, look.border_width);
  if (look.white_on_black) pattern = reversed(pattern);
  return pattern;
}

}  // namespace fathom
