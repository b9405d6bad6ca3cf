#pragma once

#include <filesystem>
#include <string>

namespace fathom {

/// An output file that is written aside (NAME.part) and renamed when whole, so that an interrupted or failed
/// run never leaves half a file under the real name. Destroyed without commit(), the part file is removed.
class PendingFile {
 public:
  /// Creates missing parent folders. Throws Error where that fails.
  explicit PendingFile(std::filesystem::path target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::filesystem::path& path() const { return part_; }  ///< write here, close, then commit()
  const std::filesystem::path& target() const { return target_; }
  void commit();  ///< throws Error where the rename fails

 private:
  std::filesystem::path target_, part_;
  bool committed_ = false;
};

/// Writes a whole text file by way of PendingFile. Throws Error.
void writeTextFile(const std::filesystem::path& target, const std::string& text);
/// Reads a whole file. Throws Error.
std::string readTextFile(const std::filesystem::path& file);

}  // namespace fathom
