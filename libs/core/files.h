#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace fathom {

// Whether a path is of something, of a file, of a folder. Not where nobody can look: names in files may be
// anything, and be longer than a name may be.
bool isThere(const std::filesystem::path& path);
bool isFile(const std::filesystem::path& path);
bool isFolder(const std::filesystem::path& path);

/// An output file that is written aside (NAME.part) and renamed when whole, so that an interrupted or failed
/// run never leaves half a file under the real name. Destroyed without commit(), the part file is removed.
/// One run at a time: what is left by one that was killed is taken over.
class PendingFile {
 public:
  /// Creates missing parent folders. Throws Error where that fails, where the file cannot be written or is a
  /// folder, device, pipe or socket (a link to one, too), and where another run is writing it. A link to a
  /// file is replaced: what it leads to may be somebody else's.
  explicit PendingFile(std::filesystem::path target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  const std::filesystem::path& path() const { return part_; }  ///< write here, close, then commit()
  const std::filesystem::path& target() const { return target_; }
  void commit();  ///< throws Error where the rename fails

 private:
  std::filesystem::path target_, part_;
  int claim_ = -1;  ///< the part file, open and locked
  bool committed_ = false;
};

/// A folder of results that is one run's until destroyed: two at once would mix theirs. Made where it is
/// missing; what is still empty of it at the end is removed again. A folder that cannot be locked is not
/// claimed. Throws Error where it cannot be made or written to, or another run has it.
class FolderClaim {
 public:
  explicit FolderClaim(const std::filesystem::path& folder);
  ~FolderClaim();
  FolderClaim(const FolderClaim&) = delete;
  FolderClaim& operator=(const FolderClaim&) = delete;

 private:
  void removeEmpty() const;

  std::vector<std::filesystem::path> made_;  ///< the innermost first
  int claim_ = -1;                           ///< the folder, open and locked
};

/// Writes a whole text file by way of PendingFile. Throws Error.
void writeTextFile(const std::filesystem::path& target, const std::string& text);
/// Reads a whole file. Throws Error, also where it is larger than 256 MB: no text, image or mesh of ours is.
std::string readTextFile(const std::filesystem::path& file);

}  // namespace fathom
