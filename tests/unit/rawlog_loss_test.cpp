// Rawlogs that are cut off or damaged: what is lost, and that nothing wrong is handed on.
#include <gtest/gtest.h>
#include <zlib.h>
#include <zstd.h>

#include "recording/rawlog.h"
#include "support/recordings.h"
#include "support/shared_data.h"

namespace fathom::test {
namespace {

namespace fs = std::filesystem;

class RawlogLoss : public testing::Test {
 protected:
  void SetUp() override {
    folder = scratchFolder();
    Random random(6);
    samples = randomSamples(3000, random);  // 30 s
    writeRecording(folder / "gzip.rawlog", samples);
    gzip = readTextFile(folder / "gzip.rawlog");
    plain = inflated(folder / "gzip.rawlog");
    writeTextFile(folder / "plain.rawlog", plain);
    all = fingerprints(readRecording(folder / "plain.rawlog").samples);
  }
  ReadBack read(const std::string& bytes) {
    writeTextFile(folder / "damaged.rawlog", bytes);
    return readRecording(folder / "damaged.rawlog");
  }
  void expectPrefix(const ReadBack& back, std::size_t at_least, std::size_t at_most) {
    EXPECT_GE(back.samples.size(), at_least);
    EXPECT_LE(back.samples.size(), at_most);
    for (std::size_t i = 0; i < back.samples.size(); ++i)
      ASSERT_EQ(fingerprint(back.samples[i]), all[i]) << i;
  }

  fs::path folder;
  std::vector<Sample> samples;
  std::vector<std::string> all;
  std::string gzip, plain;
};

TEST_F(RawlogLoss, PlainAndGzipAreTheSame) {
  EXPECT_EQ(all.size(), 3000U);
  EXPECT_EQ(fingerprints(readRecording(folder / "gzip.rawlog").samples), all);
  EXPECT_GT(plain.size(), std::size_t{1} << 20);  // more than one of the writer's blocks
}

TEST_F(RawlogLoss, PlainCutWithinAnEntry) {
  const auto last = plain.rfind("mrpt::obs::CObservation") - 1;
  const ReadBack back = read(plain.substr(0, last + 100));
  expectPrefix(back, 2999, 2999);
  ASSERT_TRUE(back.loss);
  EXPECT_EQ(back.loss->at_byte, last);
  EXPECT_EQ(back.loss->lost_bytes, 100U);
  EXPECT_TRUE(back.loss->cut_off);
  EXPECT_TRUE(std::isnan(back.loss->lost_seconds));
  EXPECT_NE(describe(*back.loss).find("how much is lost is not known"), std::string::npos);
  EXPECT_EQ(back.loss->reason, "the data end inside an entry");
}

TEST_F(RawlogLoss, PlainDamageKnowsTheSecondsLost) {
  const auto at = plain.find("mrpt::obs::CObservationIMU", plain.size() / 3) - 1;
  std::string bytes = plain;
  bytes[at + 5] = '\xff';
  const ReadBack back = read(bytes);
  expectPrefix(back, 900, 1100);
  ASSERT_TRUE(back.loss);
  EXPECT_EQ(back.loss->at_byte, at);
  EXPECT_EQ(back.loss->lost_bytes, plain.size() - at);
  EXPECT_FALSE(back.loss->estimated);
  EXPECT_NEAR(back.loss->lost_seconds, secondsBetween(back.samples.back().time, samples.back().time), 1e-9);
  EXPECT_NE(describe(*back.loss).find("are lost"), std::string::npos);
}

TEST_F(RawlogLoss, GzipCut) {
  const ReadBack back = read(gzip.substr(0, gzip.size() / 2));
  expectPrefix(back, 1300, 1700);
  ASSERT_TRUE(back.loss);
  EXPECT_EQ(back.loss->at_byte + back.loss->lost_bytes, gzip.size() / 2);
  EXPECT_GT(back.loss->lost_bytes, 0U);
  EXPECT_LT(back.loss->lost_bytes, 2000U);  // a part of one entry
  EXPECT_NE(back.loss->reason.find("cut short"), std::string::npos);
}

TEST_F(RawlogLoss, GzipDamageHandsOnNothingWrong) {
  std::string bytes = gzip;
  bytes[gzip.size() / 2] = static_cast<char>(bytes[gzip.size() / 2] ^ 0x10);
  const ReadBack back = read(bytes);
  expectPrefix(back, 800, 1600);  // up to the end of the block before: 256 KiB are some 500 entries
  ASSERT_TRUE(back.loss);
  EXPECT_TRUE(back.loss->estimated);
  EXPECT_LE(back.loss->at_byte, gzip.size() / 2);
  const double lost_s = secondsBetween(back.samples.back().time, samples.back().time);
  EXPECT_NEAR(back.loss->lost_seconds, lost_s, 0.1 * lost_s);  // the entries are much alike
}

TEST_F(RawlogLoss, GzipChecksum) {
  // One member, as MRPT writes it: all entries come, the checksum shows that some may be wrong.
  const auto file = folder / "one.rawlog";
  const gzFile out = gzopen(file.c_str(), "wb6");
  gzwrite(out, plain.data(), static_cast<unsigned>(plain.size()));
  gzclose(out);
  std::string bytes = readTextFile(file);
  EXPECT_FALSE(read(bytes).loss);
  bytes[bytes.size() - 6] ^= 1;
  const ReadBack back = read(bytes);
  expectPrefix(back, 3000, 3000);
  ASSERT_TRUE(back.loss);
  EXPECT_EQ(back.loss->reason,
            "the checksum of the gzip data does not fit: values that were read may be wrong");
  EXPECT_GT(back.loss->lost_bytes, 0U);
}

/// As MRPT writes from 2.15.7 on, with a checksum.
std::string zstandard(const std::string& bytes) {
  const std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> zstd(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(zstd.get(), ZSTD_c_checksumFlag, 1);
  std::string out(ZSTD_compressBound(bytes.size()), '\0');
  const std::size_t size = ZSTD_compress2(zstd.get(), out.data(), out.size(), bytes.data(), bytes.size());
  EXPECT_FALSE(ZSTD_isError(size));
  out.resize(size);
  return out;
}

TEST_F(RawlogLoss, ZstandardIsTheSame) {
  const ReadBack back = read(zstandard(plain));
  EXPECT_FALSE(back.loss);
  EXPECT_EQ(fingerprints(back.samples), all);
  // Of several frames, as such files are appended to each other.
  const std::size_t half = plain.size() / 2;
  EXPECT_EQ(fingerprints(read(zstandard(plain.substr(0, half)) + zstandard(plain.substr(half))).samples),
            all);
}

TEST_F(RawlogLoss, ZstandardCutAndDamaged) {
  const std::string whole = zstandard(plain);
  const ReadBack cut = read(whole.substr(0, whole.size() / 2));
  expectPrefix(cut, 1000, 2000);
  ASSERT_TRUE(cut.loss);
  EXPECT_EQ(cut.loss->reason, "the data end inside an entry: the Zstandard data are cut short");
  EXPECT_NE(describe(*cut.loss).find("how much is lost is not known"), std::string::npos);
  std::string bytes = whole;
  bytes.back() = static_cast<char>(bytes.back() ^ 1);  // of the checksum
  const ReadBack damaged = read(bytes);
  ASSERT_TRUE(damaged.loss);
  EXPECT_NE(damaged.loss->reason.find("the checksum of the Zstandard data does not fit"), std::string::npos)
      << damaged.loss->reason;
}

/// Notes, as programs put them before the data or between.
TEST_F(RawlogLoss, ZstandardFramesOfNotesArePassedOver) {
  using namespace std::string_literals;
  const std::string note = "\x5a\x2a\x4d\x18\x04\0\0\0note"s;
  const ReadBack back = read(note + zstandard(plain) + note);
  EXPECT_FALSE(back.loss);
  EXPECT_EQ(fingerprints(back.samples), all);
}

TEST_F(RawlogLoss, TrailingBytes) {
  for (const std::string& whole : {gzip, plain, zstandard(plain)}) {
    const ReadBack back = read(whole + "trailing");
    expectPrefix(back, 3000, 3000);
    ASSERT_TRUE(back.loss);
    EXPECT_EQ(back.loss->at_byte, whole.size());
    EXPECT_EQ(back.loss->lost_bytes, 8U);
  }
}

}  // namespace
}  // namespace fathom::test
