// Damaged panel maps, meshes and materials: an Error or a map that can be drawn, and nothing else.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "support/damaged_text.h"
#include "support/panels.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

/// Whether it was read. Anything but an Error of one line fails the test.
bool survives(const test::BoardFiles& files, const fs::path& folder) {
  try {
    const PanelMap map = readPanelMap(files.write(folder));
    const Surface all = surfaceOf(map);
    for (const auto& v : all.vertices) EXPECT_TRUE(v.position.allFinite() && v.normal.allFinite());
    for (const auto& triangle : all.triangles)
      for (const auto corner : triangle) EXPECT_LT(corner, all.vertices.size());
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    return false;
  }
}

void fuzz(std::string test::BoardFiles::*which, std::uint64_t seed) {
  Random random(seed);
  const auto folder = test::scratchFolder();
  constexpr int kRuns = 1500;
  int refused = 0;
  for (int run = 0; run < kRuns; ++run) {
    test::BoardFiles files;
    const auto wounds = 1 + random.bits() % 3;
    for (std::size_t i = 0; i < wounds && !(files.*which).empty(); ++i)
      files.*which = test::damaged(files.*which, random);
    refused += survives(files, folder) ? 0 : 1;
    if (testing::Test::HasFailure()) FAIL() << "run " << run << ":\n" << files.*which;
  }
  EXPECT_GT(refused, kRuns / 10);
  EXPECT_LT(refused, kRuns);
}

TEST(PanelMapFuzz, Map) { fuzz(&test::BoardFiles::yaml, 21); }
TEST(PanelMapFuzz, Mesh) { fuzz(&test::BoardFiles::obj, 22); }
TEST(PanelMapFuzz, Materials) { fuzz(&test::BoardFiles::mtl, 23); }

}  // namespace
}  // namespace fathom
