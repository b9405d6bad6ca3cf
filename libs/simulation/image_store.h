#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "simulation/image_format.h"

namespace fathom {

/// The folder of a recording's images, and what they were made from: inputs.txt beside them.
class ImageStore {
 public:
  /// `inputs` is a text that differs where images would. Where the folder holds images of other inputs, they
  /// are removed, and half-written ones always; files with other names than imageFiles() gives are left
  /// alone. Throws Error.
  ImageStore(std::filesystem::path folder, const std::string& inputs, const ImageFormat& format = {});

  /// Whether the file is there as it was written: checks the checksums of a PNG's parts. A JPEG has none:
  /// that it has its beginning and its end, which a cut one has not.
  bool has(const std::string& file) const;
  /// In this store's format; appears under its name when whole. Throws Error.
  void write(const std::string& file, const cv::Mat& image_bgr) const;

 private:
  std::filesystem::path folder_;
  ImageFormat format_;
};

}  // namespace fathom
