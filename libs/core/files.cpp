#include "core/files.h"

#include <fstream>
#include <sstream>

#include "core/error.h"

namespace fathom {
namespace fs = std::filesystem;

PendingFile::PendingFile(fs::path target) : target_(std::move(target)), part_(target_) {
  part_ += ".part";
  std::error_code problem;
  if (target_.has_parent_path()) fs::create_directories(target_.parent_path(), problem);
  if (problem) throw Error(target_.string(), "", "cannot create its folder: " + problem.message());
}

PendingFile::~PendingFile() {
  std::error_code ignored;
  if (!committed_) fs::remove(part_, ignored);
}

void PendingFile::commit() {
  std::error_code problem;
  fs::rename(part_, target_, problem);
  if (problem) throw Error(target_.string(), "", "cannot be written: " + problem.message());
  committed_ = true;
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
  if (!in || fs::is_directory(file)) throw Error(file.string(), "", "cannot be read");
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace fathom
