// Videos with bytes changed or cut off: all their frames, or one line of complaint.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "core/random.h"
#include "core/text.h"
#include "support/folder_contents.h"
#include "support/shared_data.h"
#include "support/small_vehicle.h"
#include "support/videos.h"
#include "video/import_video.h"

namespace fathom {
namespace {

class DamagedVideo : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(DamagedVideo, IsReadWhollyOrRefused) {
  constexpr int kFilmFrames = 12, kTimes = 60;
  const auto [codec, ending] = GetParam();
  const auto folder = test::scratchFolder(), images = folder / "images";
  VideoImport source;
  source.video = folder / (std::string("film") + ending);
  source.stamps = folder / "stamps.csv";
  source.vehicle = test::writeSmallVehicle(folder);
  std::string stamps;
  for (int k = 0; k < kFilmFrames; ++k) stamps += print("%.2f\n", 1'700'000'000 + 0.04 * k);
  writeTextFile(source.stamps, stamps);
  test::writeVideo(source.video, codec, kFilmFrames);
  const std::string whole = readTextFile(source.video);
  Random random(8);
  int refused = 0;
  for (int i = 0; i < kTimes; ++i) {
    std::string bytes = whole;
    // Headers, at the beginning, by turns with all of it.
    const std::size_t reach = i % 2 == 0 ? 500 : bytes.size();
    for (auto changes = 1 + random.bits() % 8; changes > 0; --changes)
      bytes[random.bits() % reach] = static_cast<char>(random.bits());
    if (i % 3 == 0) bytes.resize(random.bits() % bytes.size());
    writeTextFile(source.video, bytes);
    int samples = 0;
    try {
      streamVideo(source, images, [&](Sample&&) { ++samples; });
      EXPECT_EQ(samples, kFilmFrames);
      EXPECT_EQ(test::contentsOf(images).size(), static_cast<std::size_t>(kFilmFrames));
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << e.what();
      EXPECT_TRUE(test::contentsOf(images).empty());
    }
    std::filesystem::remove_all(images);
  }
  EXPECT_GE(refused, kTimes / 3) << "what is cut off has not all its frames";
}
INSTANTIATE_TEST_SUITE_P(Codecs, DamagedVideo,
                         testing::Values(std::pair("MJPG", ".avi"), std::pair("mp4v", ".mp4"),
                                         std::pair("avc1", ".mp4")),
                         [](const auto& codec) { return std::string(codec.param.first); });

}  // namespace
}  // namespace fathom
