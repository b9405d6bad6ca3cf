#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "support/memory.h"
#include "support/recordings.h"
#include "support/sanitized.h"
#include "support/shared_data.h"

// Damaged rawlogs: reading them ends, with everything before the damage as it was, and says so.
namespace fathom::test {
namespace {

constexpr int kRuns = 200;

struct Outcome {
  std::vector<std::string> entries;  ///< fingerprints, the header comment included
  bool lost = false;
  bool refused = false;  ///< an Error was thrown
};

/// Anything but Error fails the test, by leaving it.
Outcome readDamaged(const std::string& bytes) {
  static const auto file = scratchFolder() / "damaged.rawlog";
  std::filesystem::remove(file);  // a new file is not flushed to the disk, a replaced one is
  std::ofstream(file, std::ios::binary) << bytes;
  Outcome outcome;
  try {
    RawlogReader reader(file);
    while (const auto sample = reader.next()) outcome.entries.push_back(fingerprint(*sample));
    outcome.lost = reader.loss().has_value();
    if (outcome.lost) {
      EXPECT_GT(reader.loss()->lost_bytes, 0U);
      EXPECT_LE(reader.loss()->at_byte + reader.loss()->lost_bytes, bytes.size());
      EXPECT_FALSE(reader.loss()->reason.empty());
    }
  } catch (const Error&) {
    outcome.refused = true;
  }
  return outcome;
}

class RawlogFuzz : public testing::Test {
 protected:
  void SetUp() override {
    const auto file = scratchFolder() / "whole.rawlog";
    Random random(11);
    writeRecording(file, randomSamples(1200, random));
    gzip = readTextFile(file);
    plain = inflated(file);
    whole = readDamaged(gzip).entries;
    ASSERT_EQ(whole.size(), 1201U);
    for (std::size_t at = 0; (at = plain.find("mrpt::obs::CObservation", at)) != std::string::npos; ++at)
      begins.push_back(at - 1);
    ASSERT_EQ(begins.size(), whole.size());
  }

  std::size_t entriesEndingBefore(std::size_t byte) const {
    const auto after = std::upper_bound(begins.begin(), begins.end(), byte);
    return static_cast<std::size_t>(after - begins.begin()) - 1;
  }
  void expectWholeUpTo(const Outcome& outcome, std::size_t count) const {
    ASSERT_GE(outcome.entries.size(), count);
    for (std::size_t i = 0; i < count; ++i) ASSERT_EQ(outcome.entries[i], whole[i]) << "entry " << i;
  }

  std::string gzip, plain;
  std::vector<std::string> whole;
  std::vector<std::size_t> begins;  ///< of each entry in `plain`
};

TEST_F(RawlogFuzz, PlainCuts) {
  Random random(12);
  for (int run = 0; run < kRuns; ++run) {
    const std::size_t size = 1 + random.bits() % (plain.size() - 1);
    const Outcome outcome = readDamaged(plain.substr(0, size));
    const std::size_t entries = entriesEndingBefore(size);
    if (entries == 0) {
      EXPECT_TRUE(outcome.refused);
      continue;
    }
    ASSERT_EQ(outcome.entries.size(), entries);
    expectWholeUpTo(outcome, entries);
    const bool between_entries = begins[entries] == size;
    EXPECT_EQ(outcome.lost, !between_entries);
  }
}

TEST_F(RawlogFuzz, GzipCuts) {
  Random random(13);
  for (int run = 0; run < kRuns; ++run) {
    const std::size_t size = 1 + random.bits() % (gzip.size() - 1);
    const Outcome outcome = readDamaged(gzip.substr(0, size));
    expectWholeUpTo(outcome, outcome.entries.size());
    const bool between_blocks = gzip.compare(size, 3, "\x1f\x8b\x08") == 0;
    EXPECT_TRUE(outcome.refused || outcome.lost || between_blocks) << size;
    // Deflated sizes are much the same all along, so that about this share of the entries must be there.
    const double share = static_cast<double>(size) / static_cast<double>(gzip.size());
    if (outcome.refused) continue;
    EXPECT_GT(static_cast<double>(outcome.entries.size()) / 1201.0, share - 0.1);
  }
}

TEST_F(RawlogFuzz, PlainFlips) {
  Random random(14);
  int noticed = 0;
  for (int run = 0; run < kRuns; ++run) {
    std::string bytes = plain;
    const std::size_t at = random.bits() % bytes.size();
    bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1 + random.bits() % 255));
    const Outcome outcome = readDamaged(bytes);
    if (!outcome.refused) expectWholeUpTo(outcome, entriesEndingBefore(at));
    // A changed number is another number, which nobody can see; entries that are gone must be admitted.
    EXPECT_TRUE(outcome.refused || outcome.lost || outcome.entries.size() == whole.size()) << at;
    noticed += outcome.refused || outcome.lost;
  }
  EXPECT_GT(noticed, kRuns / 10);  // names, lengths and flags are more than a tenth of the bytes
}

TEST_F(RawlogFuzz, GzipFlips) {
  Random random(15);
  for (int run = 0; run < kRuns; ++run) {
    std::string bytes = gzip;
    const std::size_t at = random.bits() % bytes.size();
    bytes[at] = static_cast<char>(bytes[at] ^ static_cast<char>(1 + random.bits() % 255));
    const Outcome outcome = readDamaged(bytes);
    expectWholeUpTo(outcome, outcome.entries.size());  // nothing wrong is handed on
    EXPECT_TRUE(outcome.refused || outcome.lost || outcome.entries.size() == whole.size()) << at;
  }
}

TEST_F(RawlogFuzz, PlainBursts) {
  Random random(16);
  for (int run = 0; run < kRuns; ++run) {
    std::string bytes = plain;
    const std::size_t at = random.bits() % (bytes.size() - 600);
    for (std::size_t i = 0; i < 600; ++i) bytes[at + i] = static_cast<char>(random.bits());
    const Outcome outcome = readDamaged(bytes);
    if (outcome.refused) continue;
    expectWholeUpTo(outcome, entriesEndingBefore(at));
    EXPECT_TRUE(outcome.lost) << at;  // 600 bytes are longer than any entry's numbers
  }
}

/// Every byte of one entry of each kind, with flips that make lengths huge or negative.
TEST_F(RawlogFuzz, EveryByteOfEveryKind) {
  const std::string each = plain.substr(0, begins[kKinds + 1]);
  for (std::size_t at = 0; at < each.size(); ++at)
    for (const int flip : {0x01, 0x80, 0xff}) {
      std::string bytes = each;
      bytes[at] = static_cast<char>(bytes[at] ^ flip);
      const Outcome outcome = readDamaged(bytes);
      if (!outcome.refused) expectWholeUpTo(outcome, entriesEndingBefore(at));
    }
}

TEST_F(RawlogFuzz, MemoryStaysBounded) {
  if (test::kSanitized) GTEST_SKIP() << "the address sanitizer keeps freed memory";
  // A single length believed would be up to 4 GB. What the tests before have had does not count.
  std::ofstream("/proc/self/clear_refs") << 5;  // proc(5): the peak is what it is now
  const double before_mb = peakMegabytes();
  Random random(17);
  for (int run = 0; run < kRuns; ++run) {
    std::string bytes = plain.substr(0, 20000);
    for (int flips = 0; flips < 5; ++flips) bytes[random.bits() % bytes.size()] = '\xff';
    readDamaged(bytes);
  }
  EXPECT_LT(peakMegabytes() - before_mb, 150);
}

}  // namespace
}  // namespace fathom::test
