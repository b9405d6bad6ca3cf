// What markers look like, against the drawing functions of the libraries that detect them.
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
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <opencv2/aruco.hpp>
#include <opencv2/aruco/dictionary.hpp>
#include <tuple>
#include <utility>

namespace fathom {
namespace {

/// First, last and some between.
std::vector<int> someIds(const std::string& family) {
  const int last = markerCount(family) - 1;
  return {0, 1, last / 3, last / 2, last - 1, last};
}

/// Rows of '#' (black) and '.' (white).
std::string text(const MarkerPattern& pattern) {
  std::string rows;
  for (int row = 0; row < pattern.cells; ++row) {
    for (int column = 0; column < pattern.cells; ++column) rows += pattern.whiteAt(row, column) ? '.' : '#';
    rows += '\n';
  }
  return rows;
}

struct Dictionary {
  const char* family;
  cv::aruco::PREDEFINED_DICTIONARY_NAME name;
};
const Dictionary kDictionaries[] = {{"DICT_4X4_50", cv::aruco::DICT_4X4_50},
                                    {"DICT_4X4_1000", cv::aruco::DICT_4X4_1000},
                                    {"DICT_5X5_100", cv::aruco::DICT_5X5_100},
                                    {"DICT_6X6_250", cv::aruco::DICT_6X6_250},
                                    {"DICT_7X7_1000", cv::aruco::DICT_7X7_1000},
                                    {"DICT_ARUCO_ORIGINAL", cv::aruco::DICT_ARUCO_ORIGINAL},
                                    {"DICT_APRILTAG_16h5", cv::aruco::DICT_APRILTAG_16h5},
                                    {"DICT_APRILTAG_25h9", cv::aruco::DICT_APRILTAG_25h9},
                                    {"DICT_APRILTAG_36h10", cv::aruco::DICT_APRILTAG_36h10},
                                    {"DICT_APRILTAG_36h11", cv::aruco::DICT_APRILTAG_36h11}};

TEST(MarkerFamily, BordersOfTwoCellsLookAsOpenCvDrawsThem) {
  for (const auto& [family, name] : kDictionaries) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(name);
    const MarkerPattern pattern = markerPattern(family, 3, {2, false});
    ASSERT_EQ(pattern.cells, dictionary->markerSize + 4);
    ASSERT_EQ(pattern.border_cells, pattern.cells);
    constexpr int kCellPx = 5;
    cv::Mat image;
    cv::aruco::drawMarker(dictionary, 3, pattern.cells * kCellPx, image, 2);
    for (int row = 0; row < pattern.cells; ++row)
      for (int column = 0; column < pattern.cells; ++column)
        ASSERT_EQ(pattern.whiteAt(row, column),
                  image.at<std::uint8_t>(row * kCellPx + 2, column * kCellPx + 2) > 127)
            << family << " row " << row << " column " << column;
  }
  EXPECT_THROW(markerPattern("tagStandard41h12", 3, {2, false}), std::invalid_argument);
}

TEST(MarkerFamily, WhiteOnBlackIsTheReverseWithItsQuietZone) {
  for (const std::string family : {"DICT_4X4_50", "tag36h11"}) {
    const MarkerPattern usual = markerPattern(family, 3), reverse = markerPattern(family, 3, {1, true});
    EXPECT_EQ(reverse.border_cells, usual.border_cells);
    ASSERT_EQ(reverse.cells, usual.border_cells + 2) << "one cell around";
    const int ring = (usual.cells - usual.border_cells) / 2;
    for (int row = 0; row < reverse.cells; ++row)
      for (int column = 0; column < reverse.cells; ++column) {
        const bool inside = std::min(row, column) >= 1 && std::max(row, column) < reverse.cells - 1;
        EXPECT_EQ(reverse.whiteAt(row, column), inside && !usual.whiteAt(row - 1 + ring, column - 1 + ring));
      }
  }
}

TEST(MarkerFamily, DictionariesLookAsOpenCvDrawsThem) {
  for (const auto& [family, name] : kDictionaries) {
    const auto dictionary = cv::aruco::getPredefinedDictionary(name);
    ASSERT_EQ(markerCount(family), dictionary->bytesList.rows) << family;
    for (const int id : someIds(family)) {
      const MarkerPattern pattern = markerPattern(family, id);
      ASSERT_EQ(pattern.cells, dictionary->markerSize + 2);
      ASSERT_EQ(pattern.border_cells, pattern.cells);
      constexpr int kCellPx = 5;
      cv::Mat image;
      cv::aruco::drawMarker(dictionary, id, pattern.cells * kCellPx, image, 1);
      for (int row = 0; row < pattern.cells; ++row)
        for (int column = 0; column < pattern.cells; ++column)
          ASSERT_EQ(pattern.whiteAt(row, column),
                    image.at<std::uint8_t>(row * kCellPx + 2, column * kCellPx + 2) > 127)
              << family << " " << id << " row " << row << " column " << column;
    }
  }
}

struct Tag {
  const char* family;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};
const Tag kTags[] = {{"tag16h5", tag16h5_create, tag16h5_destroy},
                     {"tag25h9", tag25h9_create, tag25h9_destroy},
                     {"tag36h10", tag36h10_create, tag36h10_destroy},
                     {"tag36h11", tag36h11_create, tag36h11_destroy},
                     {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
                     {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
                     {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
                     {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
                     {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy}};

TEST(MarkerFamily, TagsLookAsAprilTagDrawsThem) {
  for (const auto& [family, create, destroy] : kTags) {
    apriltag_family_t* tag = create();
    ASSERT_EQ(markerCount(family), static_cast<int>(tag->ncodes)) << family;
    for (const int id : someIds(family)) {
      const MarkerPattern pattern = markerPattern(family, id);
      ASSERT_EQ(pattern.cells, tag->total_width);
      ASSERT_EQ(pattern.border_cells, tag->width_at_border);
      image_u8_t* image = apriltag_to_image(tag, id);
      for (int row = 0; row < pattern.cells; ++row)
        for (int column = 0; column < pattern.cells; ++column)
          ASSERT_EQ(pattern.whiteAt(row, column), image->buf[row * image->stride + column] > 127)
              << family << " " << id << " row " << row << " column " << column;
      std::free(image->buf);  // image_u8_destroy() is in a library of its own
      std::free(image);
    }
    destroy(tag);
  }
}

/// The pattern inside the black border square, turned by quarter turns clockwise.
MarkerPattern turnedBorderSquare(const MarkerPattern& pattern, int quarter_turns) {
  MarkerPattern inner;
  inner.cells = inner.border_cells = pattern.border_cells;
  const int first = (pattern.cells - pattern.border_cells) / 2, last = inner.cells - 1;
  for (int row = 0; row < inner.cells; ++row)
    for (int column = 0; column < inner.cells; ++column) {
      int r = row, c = column;
      for (int turn = 0; turn < quarter_turns; ++turn) std::tie(r, c) = std::pair(last - c, r);
      inner.white.push_back(pattern.whiteAt(first + r, first + c));
    }
  return inner;
}

TEST(MarkerFamily, OpenCvAndAprilTagDrawTheSameTagHalfATurnApart) {
  const std::pair<const char*, const char*> twins[] = {{"DICT_APRILTAG_16h5", "tag16h5"},
                                                       {"DICT_APRILTAG_25h9", "tag25h9"},
                                                       {"DICT_APRILTAG_36h10", "tag36h10"},
                                                       {"DICT_APRILTAG_36h11", "tag36h11"}};
  for (const auto& [dictionary, tag] : twins) {
    ASSERT_EQ(markerCount(dictionary), markerCount(tag));
    for (const int id : someIds(tag))
      EXPECT_EQ(text(markerPattern(dictionary, id)), text(turnedBorderSquare(markerPattern(tag, id), 2)))
          << tag << " " << id;
  }
}

TEST(MarkerFamily, ArucoOriginal0AsPrinted) {
  // Id 0 of the original dictionary: five rows of the code word 10000 (Garrido-Jurado et al. 2014).
  EXPECT_EQ(text(markerPattern("DICT_ARUCO_ORIGINAL", 0)),
            "#######\n#.#####\n#.#####\n#.#####\n#.#####\n#.#####\n#######\n");
}

TEST(MarkerFamily, AllAreNamedOnceAndSorted) {
  const auto& families = markerFamilies();
  EXPECT_EQ(families.size(), 21U + 9U);
  EXPECT_TRUE(std::is_sorted(families.begin(), families.end()));
  for (const auto& family : families) {
    EXPECT_TRUE(isMarkerFamily(family));
    EXPECT_GT(markerCount(family), 0) << family;
  }
}

TEST(MarkerFamily, WhatThereIsNotIsRefused) {
  EXPECT_FALSE(isMarkerFamily("tag36h12"));
  EXPECT_THROW(markerCount("tag36h12"), std::invalid_argument);
  EXPECT_THROW(markerPattern("", 0), std::invalid_argument);
  for (const std::string family : {"DICT_4X4_50", "tag36h11"}) {
    EXPECT_THROW(markerPattern(family, -1), std::invalid_argument);
    EXPECT_THROW(markerPattern(family, markerCount(family)), std::invalid_argument);
  }
}

}  // namespace
}  // namespace fathom
