// Bags cut off or damaged anywhere: one Error, never a crash.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "core/random.h"
#include "support/bags.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

/// The bytes of a bag with several chunks.
std::string wholeBag(const std::filesystem::path& folder, rosbag::CompressionType compression) {
  const auto file = folder / "whole.bag";
  rosbag::Bag bag(file.string(), rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(4096);
  for (unsigned k = 1; k <= 60; ++k) bag.write("/imu", test::rosTime(k), test::imuMessage(test::rosTime(k)));
  bag.close();
  return readTextFile(file);
}

class Bag : public testing::TestWithParam<rosbag::CompressionType> {
 protected:
  void SetUp() override { folder_ = test::scratchFolder(), whole_ = wholeBag(folder_, GetParam()); }

  /// Imports these bytes; the number of samples, or nothing after an Error.
  std::optional<std::size_t> import(const std::string& bytes) const {
    writeTextFile(folder_ / "part.bag", bytes);
    try {
      std::size_t count = 0;
      streamBag(folder_ / "part.bag", map_, [&](Sample&&) { ++count; });
      return count;
    } catch (const Error& e) {
      EXPECT_NE(e.file.find("part.bag"), std::string::npos) << e.what();
      EXPECT_EQ(std::string(e.what()).find('\n'), std::string::npos) << "one line";
      return std::nullopt;
    }
  }

  std::filesystem::path folder_;
  std::string whole_;
  TopicMap map_ = test::topicMap({test::bagTopic("/imu", TopicRole::ins)});
};

TEST_P(Bag, WholeIsRead) { EXPECT_EQ(import(whole_), 60U); }

TEST_P(Bag, CutAnywhereIsAnError) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const auto keep = static_cast<std::size_t>(random.uniform(0, static_cast<double>(whole_.size())));
    EXPECT_FALSE(import(whole_.substr(0, keep))) << keep << " of " << whole_.size() << " bytes";
  }
}

/// A flipped byte may be harmless (a covariance) or not; it must never do more than an Error.
TEST_P(Bag, DamagedBytesNeverCrash) {
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    std::string bytes = whole_;
    const auto at = static_cast<std::size_t>(random.uniform(0, static_cast<double>(bytes.size())));
    bytes[at] = static_cast<char>(random.bits());
    const auto count = import(bytes);
    if (count) {
      EXPECT_LE(*count, 60U) << "byte " << at;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Compression, Bag,
                         testing::Values(rosbag::compression::Uncompressed, rosbag::compression::BZ2,
                                         rosbag::compression::LZ4));

}  // namespace
}  // namespace fathom
