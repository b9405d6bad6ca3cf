// Families compared on images of a panel: what is found where, the same on however many cores, kept and taken
// up.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "evaluation/chunk_store.h"
#include "evaluation/fiducial_results.h"
#include "support/shared_data.h"
#include "support/small_vehicle.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

FiducialGrid smallGrid() {
  FiducialGrid grid;
  grid.families = {"DICT_4X4_50", "tag36h11"};
  grid.ranges_m = {1.2, 8};
  grid.tilts_rad = {radians(20)};
  grid.waters = {grid.waters.front(), grid.waters.back()};
  grid.blurs_px = {0, 1.5};
  grid.repeats = 2;
  return grid;
}

std::vector<FiducialResult> compared(const FiducialGrid& grid, const fs::path& folder, std::size_t threads) {
  const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
  fs::create_directories(folder);
  const Vehicle vehicle = readVehicle(test::writeSmallVehicle(folder));
  const PanelMap map = readPanelMap(std::string(FATHOM_SOURCE_DIR) + "/maps/dexrov/panel.yaml");
  return compareFiducials(grid, map, vehicle, folder);
}

TEST(FiducialComparison, NearMarkersAreFoundAndFarOnesAreNot) {
  const FiducialGrid grid = smallGrid();
  const auto results = compared(grid, test::scratchFolder() / "chunks", 2);
  ASSERT_EQ(results.size(), grid.imageCount() * kBackends.size());
  for (const auto& [key, group] : grouped(results, [](const FiducialResult& r) {
         return FiducialKey{r.image.range, r.image.water, r.image.blur, r.image.family, r.reader};
       })) {
    SCOPED_TRACE(testing::PrintToString(key));
    EXPECT_EQ(group.score.images(), 2U);
    EXPECT_GT(group.score.visible(), 0U);
    if (key[0] == 0 && key[1] == 0 && key[2] == 0) {  // near, clear and sharp
      EXPECT_EQ(group.score.found(), group.score.visible());
      // A marker whose edges cannot be fitted keeps ArUco's corners, pixels off: one of thirteen is.
      EXPECT_LT(group.score.cornerRms_px(), 1.0);
      EXPECT_LT(group.score.medianPositionError_m(), 0.005);  // a thousandth of a marker's range is 1.2 mm
      EXPECT_GT(group.detect_s, 0);
    }
    if (key[0] == 1 && key[1] == 1) {  // far in turbid water: contrast below a thousandth
      EXPECT_EQ(group.score.found(), 0U);
      EXPECT_TRUE(std::isnan(group.score.cornerRms_px()));
    }
  }
}

// One blur does not add to the next: what is found of four alike differs by noise only. (Two of them added up
// would be 2.1 px, and four 3 px: a third of a cell.)
TEST(FiducialComparison, EachBlurIsOfTheSharpImage) {
  FiducialGrid grid = smallGrid();
  grid.families = {"tag36h11"};
  grid.ranges_m = {1.2};
  grid.tilts_rad = {0};
  grid.waters.resize(1);
  grid.blurs_px = {1.5, 1.5, 1.5, 1.5};
  std::array<int, 4> found{};
  for (const FiducialResult& result : compared(grid, test::scratchFolder() / "chunks", 2))
    found.at(result.image.blur) += result.score.found;
  EXPECT_GT(found[0], 4);
  for (const int of_blur : found) EXPECT_NEAR(of_blur, found[0], 3);
}

TEST(FiducialComparison, AllFamiliesShowTheSameMarkers) {
  FiducialGrid grid = smallGrid();
  grid.families.emplace_back("tag16h5");
  grid.tilts_rad = {radians(60)};
  grid.waters.resize(1);
  grid.blurs_px.resize(1);
  const auto results = compared(grid, test::scratchFolder() / "chunks", 2);
  const std::size_t images = results.size() / grid.families.size();
  for (std::size_t i = 0; i < results.size(); ++i)
    EXPECT_EQ(results[i].score.visible, results[i % images].score.visible) << i;
}

TEST(FiducialComparison, IsTheSameOnAnyNumberOfCores) {
  const FiducialGrid grid = smallGrid();
  const auto folder = test::scratchFolder();
  const auto one = compared(grid, folder / "one", 1), four = compared(grid, folder / "four", 4),
             again = compared(grid, folder / "one", 2);
  EXPECT_EQ(formatResults(grid, one), formatResults(grid, four));
  EXPECT_EQ(formatResults(grid, one), formatResults(grid, again));
  EXPECT_EQ(formatTimes(grid, one), formatTimes(grid, again));  // not measured again
}

TEST(FiducialComparison, OtherInputsBeginAnew) {
  FiducialGrid grid = smallGrid();
  grid.families.resize(1);
  grid.ranges_m.resize(1);
  const auto folder = test::scratchFolder();
  const auto first = formatResults(grid, compared(grid, folder / "a", 2));
  grid.seed = 2;
  const auto other = formatResults(grid, compared(grid, folder / "a", 2));
  EXPECT_NE(first, other);
  EXPECT_EQ(other, formatResults(grid, compared(grid, folder / "b", 2)));
  grid.effects.add<Gamma>({0.5});
  const auto with_effect = formatResults(grid, compared(grid, folder / "a", 2));
  EXPECT_NE(with_effect, other);
  EXPECT_EQ(with_effect, formatResults(grid, compared(grid, folder / "c", 2)));
  grid.effects.active_s[kEffectIndex<Gamma>] = {10, 20};  // the views are taken at 0
  EXPECT_EQ(formatResults(grid, compared(grid, folder / "a", 2)), other);
  grid.t_s = 15;
  EXPECT_EQ(formatResults(grid, compared(grid, folder / "a", 2)), with_effect);
}

TEST(FiducialComparison, RefusesAnEmptyGrid) {
  FiducialGrid grid = smallGrid();
  grid.waters.clear();
  EXPECT_THROW(compared(grid, test::scratchFolder(), 1), std::invalid_argument);
  grid = smallGrid();
  grid.families = {"tagStandard41h12"};
  EXPECT_THROW(compared(grid, test::scratchFolder(), 1), std::invalid_argument);
}

TEST(ChunkStore, KeepsWholePiecesOfTheSameInputs) {
  const auto folder = test::scratchFolder() / "chunks";
  {
    const ChunkStore store(folder, "inputs\n");
    store.write(3, "1 2 3\n");
    store.write(4, "");
    store.write(5, "4 5 6\n");
  }
  const std::string piece = readTextFile(folder / "chunk_000005.txt");
  test::writeNew(folder / "chunk_000005.txt", piece.substr(0, piece.size() - 1));
  test::writeNew(folder / "chunk_000006.txt.part", "half");
  test::writeNew(folder / "mine.txt", "kept");
  {
    const ChunkStore store(folder, "inputs\n");
    EXPECT_EQ(store.read(3), "1 2 3\n");
    EXPECT_EQ(store.read(4), "");
    EXPECT_EQ(store.read(5), std::nullopt);
    EXPECT_EQ(store.read(6), std::nullopt);
    EXPECT_FALSE(fs::exists(folder / "chunk_000006.txt.part"));
  }
  const ChunkStore store(folder, "other inputs\n");
  EXPECT_EQ(store.read(3), std::nullopt);
  EXPECT_FALSE(fs::exists(folder / "chunk_000003.txt"));
  EXPECT_EQ(readTextFile(folder / "mine.txt"), "kept");
}

}  // namespace
}  // namespace fathom
