#include "truth.h"

#include <nlohmann/json.hpp>

#include "core/files.h"
#include "recording/tum.h"
#include "sha256.h"

namespace fathom::sealed {
namespace fs = std::filesystem;
namespace {

constexpr double kPathRate_hz = 20;

nlohmann::json sealOf(const fs::path& folder) {
  nlohmann::json seal;  // sorted by name
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file())
      seal[entry.path().lexically_relative(folder).generic_string()] = sha256(readTextFile(entry.path()));
  return seal;
}

}  // namespace

void writeTruth(const fs::path& folder, const fs::path& recording, const SealedCase& sealed, const Dive& dive,
                Time start) {
  std::vector<StampedPose> path;
  for (int i = 0; i <= sealed.dive.duration_s * kPathRate_hz; ++i)
    path.push_back({after(start, i / kPathRate_hz), dive.poseAt(i / kPathRate_hz)});
  writeTum(folder / "truth.tum", path);
  const nlohmann::json truth{{"case", sealed.document}, {"sha256", sealOf(recording)}};
  writeTextFile(folder / "truth.json", truth.dump(2) + "\n");
}

}  // namespace fathom::sealed
