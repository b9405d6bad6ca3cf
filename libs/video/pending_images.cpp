#include "video/pending_images.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/text.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kBefore = "CAMERA_", kBehind = ".png", kPart = ".part";

bool isImageName(std::string_view name) {
  if (!name.starts_with(kBefore) || !name.ends_with(kBehind)) return false;
  name.remove_prefix(kBefore.size());
  name.remove_suffix(std::min(name.size(), kBehind.size()));
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

bool isPartName(std::string_view name) {
  return name.ends_with(kPart) && isImageName(name.substr(0, name.size() - kPart.size()));
}

}  // namespace

PendingImages::PendingImages(fs::path folder) : folder_(std::move(folder)), claim_(folder_) {
  removeOthers(true);
}

PendingImages::~PendingImages() {
  std::error_code ignored;
  for (const std::string& name : written_) fs::remove(partOf(name), ignored);
}

std::string PendingImages::nameOf(std::int64_t frame) {
  return std::string(kBefore) + print("%06lld", static_cast<long long>(frame)) + std::string(kBehind);
}

void PendingImages::write(const std::string& name, const std::string& bytes) {
  const fs::path part = partOf(name);
  written_.insert(name);
  std::ofstream out(part, std::ios::binary);
  out << bytes;
  out.close();
  if (!out)
    throw Error((folder_ / name).string(), "", std::string("cannot be written: ") + std::strerror(errno));
}

void PendingImages::commit() {
  for (const std::string& name : written_) {
    std::error_code problem;
    fs::rename(partOf(name), folder_ / name, problem);
    if (problem) throw Error((folder_ / name).string(), "", "cannot be written: " + problem.message());
  }
  removeOthers(false);
  written_.clear();
}

/// Images, or half done ones, that this run has not written.
void PendingImages::removeOthers(bool half_done) const {
  std::vector<fs::path> others;
  for (const auto& entry : fs::directory_iterator(folder_)) {
    const std::string name = entry.path().filename().string();
    const bool ours = half_done ? isPartName(name) : isImageName(name);
    if (ours && !written_.contains(name)) others.push_back(entry.path());
  }
  for (const fs::path& other : others) {
    std::error_code problem;
    if (!fs::remove(other, problem) && problem)
      throw Error(other.string(), "", "cannot be removed: " + problem.message());
  }
}

}  // namespace fathom
