#include "core/files.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include "core/error.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kLargestFile_bytes = std::size_t{256} << 20;

/// Whether the path still leads to the file that was opened there.
bool isStill(int descriptor, const fs::path& file) {
  struct stat opened {
  }, there{};
  return fstat(descriptor, &opened) == 0 && stat(file.c_str(), &there) == 0 &&
         opened.st_dev == there.st_dev && opened.st_ino == there.st_ino;
}

/// Locks an open file or folder, where another run has not. The lock ends with the process, however that
/// ends. A file system without locks (errno other than EWOULDBLOCK) gives none.
bool isAnothers(int descriptor) { return flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK; }

/// Opens and locks a part file, none that a link of its name leads to. A pipe of its name is not waited for.
int claim(const fs::path& part, const fs::path& target) {
  while (true) {
    const int descriptor = open(part.c_str(), O_WRONLY | O_CREAT | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC, 0666);
    if (descriptor < 0)
      throw Error(target.string(), "", std::string("cannot be written: ") + std::strerror(errno));
    if (isAnothers(descriptor)) {
      close(descriptor);
      throw Error(target.string(), "", "is being written by another run");
    }
    // Its owner may have renamed or removed it since it was opened here.
    if (isStill(descriptor, part)) return descriptor;
    close(descriptor);
  }
}

/// Renaming a file over a device or a pipe would replace it for everybody.
void refuseSpecial(const fs::path& target) {
  std::error_code nobody_can_look;
  const fs::file_status there = fs::status(target, nobody_can_look);
  if (!fs::exists(there) || fs::is_regular_file(there)) return;
  throw Error(target.string(), "",
              fs::is_directory(there) ? "is a folder: cannot be written as a file"
                                      : "is a device, a pipe or a socket: only a file can be written");
}

}  // namespace

bool isThere(const fs::path& path) {
  std::error_code nobody_can_look;
  return fs::exists(path, nobody_can_look);
}
bool isFile(const fs::path& path) {
  std::error_code nobody_can_look;
  return fs::is_regular_file(path, nobody_can_look);
}
bool isFolder(const fs::path& path) {
  std::error_code nobody_can_look;
  return fs::is_directory(path, nobody_can_look);
}

PendingFile::PendingFile(fs::path target) : target_(std::move(target)), part_(target_) {
  refuseSpecial(target_);
  part_ += ".part";
  std::error_code problem;
  if (target_.has_parent_path()) fs::create_directories(target_.parent_path(), problem);
  if (problem) throw Error(target_.string(), "", "cannot create its folder: " + problem.message());
  claim_ = claim(part_, target_);
}

PendingFile::~PendingFile() {
  std::error_code ignored;
  if (!committed_) fs::remove(part_, ignored);
  close(claim_);  // last: until then nobody else takes the part file over
}

void PendingFile::commit() {
  std::error_code problem;
  fs::rename(part_, target_, problem);
  if (problem) throw Error(target_.string(), "", "cannot be written: " + problem.message());
  committed_ = true;
}

FolderClaim::FolderClaim(const fs::path& folder) {
  if (folder.empty()) return;
  std::error_code problem;
  for (fs::path part = folder; !part.empty() && !isThere(part); part = part.parent_path())
    made_.push_back(part);
  fs::create_directories(folder, problem);
  if (problem) {
    removeEmpty();
    throw Error(folder.string(), "", "cannot create its folder: " + problem.message());
  }
  if (access(folder.c_str(), W_OK) != 0) throw Error(folder.string(), "", "cannot be written to");
  claim_ = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (claim_ < 0 || !isAnothers(claim_)) return;
  close(claim_);
  throw Error(folder.string(), "", "another run is writing its results there");
}

FolderClaim::~FolderClaim() {
  removeEmpty();
  if (claim_ >= 0) close(claim_);
}

void FolderClaim::removeEmpty() const {
  std::error_code not_empty;
  for (const fs::path& part : made_) fs::remove(part, not_empty);
}

void writeTextFile(const fs::path& target, const std::string& text) {
  PendingFile file(target);
  std::ofstream out(file.path(), std::ios::binary);
  out << text;
  out.close();
  if (!out) throw Error(target.string(), "", "cannot be written");
  file.commit();
}

std::string readTextFile(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in || isFolder(file)) throw Error(file.string(), "", "cannot be read");
  std::string text;
  constexpr std::size_t kPiece = std::size_t{1} << 16;
  // Not by its size: what is no regular file has none.
  for (std::size_t size = 0; in; text.resize(size)) {
    text.resize(size + kPiece);
    size += static_cast<std::size_t>(in.read(text.data() + size, kPiece).gcount());
    if (size > kLargestFile_bytes) throw Error(file.string(), "", "is larger than 256 MB");
  }
  if (in.bad()) throw Error(file.string(), "", "cannot be read");
  return text;
}

}  // namespace fathom
