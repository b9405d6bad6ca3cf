#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <optional>

/// What JPEG does to images: a recorded image that came by way of it is compared with a simulated one that
/// did too.
namespace fathom {

/// The quality (1 to 100) with which libjpeg wrote a file, from its table of luminance; nothing where it is
/// no JPEG file. To one or two; of other encoders, that which has about the same table.
std::optional<int> jpegQuality(const std::filesystem::path& file);

/// The image as it is read again where it was written with this quality; without one, as it is.
cv::Mat throughJpeg(const cv::Mat& image, std::optional<int> quality);

}  // namespace fathom
