#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "evaluation/marker_score.h"

/// Many images on one, for people to look at.
namespace fathom {

/// An image of a linear camera (CV_8UC1 or CV_8UC3, BGR) as wide as asked, brightened for the eye (power 1
/// / 2.2), with the border squares of markers: found (green), wrong (red) and visible but missed (orange);
/// how many of each stands in a line of text below. With no places, where truth is unknown, all detections
/// are blue.
cv::Mat markedTile(const cv::Mat& image, const std::vector<Detection>& detections,
                   const std::vector<MarkerPlace>* places, double tolerance_px, int width_px = 360);

struct SheetRow {
  std::vector<std::string> label;  ///< lines
  std::vector<cv::Mat> tiles;      ///< CV_8UC3
};

/// Rows of tiles, labelled at their left and on top. ASCII text only.
cv::Mat contactSheet(const std::string& title, const std::vector<std::string>& column_labels,
                     const std::vector<SheetRow>& rows);

}  // namespace fathom
