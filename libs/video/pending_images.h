#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>

#include "core/files.h"

namespace fathom {

/// A recording's folder of images that are written aside (CAMERA_000012.png.part) and renamed together when
/// all are there; those of an earlier import are then removed, files of other names left alone. Destroyed
/// without commit(), none of its images is left, and all that was there before. The folder is one run's at a
/// time.
class PendingImages {
 public:
  /// What a killed run has left half done is removed. Throws Error where the folder cannot be made or written
  /// to, or another run has it.
  explicit PendingImages(std::filesystem::path folder);
  ~PendingImages();
  PendingImages(const PendingImages&) = delete;
  PendingImages& operator=(const PendingImages&) = delete;

  /// The name of a frame's image.
  static std::string nameOf(std::int64_t frame);
  /// Bytes of a PNG file. Throws Error where the disk is full.
  void write(const std::string& name, const std::string& bytes);
  void commit();  ///< throws Error where a rename fails

 private:
  std::filesystem::path partOf(const std::string& name) const { return folder_ / (name + ".part"); }
  void removeOthers(bool half_done) const;

  std::filesystem::path folder_;
  FolderClaim claim_;
  std::set<std::string> written_;
};

}  // namespace fathom
