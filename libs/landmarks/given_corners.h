#pragma once

#include <filesystem>

#include "landmarks/detection_cache.h"

/// Markers that somebody else has found: a table beside a rawlog, which is taken instead of a search.
namespace fathom {

/// A marker as somebody else has found it: corners' coordinates independent, each of so much sigma.
Detection givenDetection(std::string family, int id, const std::array<Vector2d, 4>& corners_px,
                         double sigma_px);

/// NAME_corners.csv.
std::filesystem::path cornersBeside(const std::filesystem::path& rawlog);

/// A row a marker: image (the file's name in the image folder), family, id, sigma_px of each coordinate, and
/// the corners x0_px, y0_px … y3_px: top-left, top-right, bottom-right, bottom-left, seen upright. Throws
/// Error where it cannot be written.
void writeGivenCorners(const std::filesystem::path& file,
                       const std::map<std::string, std::vector<Detection>>& by_image);

/// Corners' errors are taken as independent. Throws Error: another column, an unknown family, a value that is
/// none, a marker twice in an image.
Detections readGivenCorners(const std::filesystem::path& file, const std::filesystem::path& image_folder);

}  // namespace fathom
