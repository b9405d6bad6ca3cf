// Files that are small and claim to be huge, or are made so that looking at them takes forever: the program
// says one line and ends, in 1.5 GB and 20 s. (Random damage, and every length of a rawlog: the other tests
// here.)
#include <gtest/gtest.h>
#include <zlib.h>

#include "support/bags.h"
#include "support/panels.h"
#include "support/recordings.h"
#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom::test {
namespace {
namespace fs = std::filesystem;

constexpr std::uint32_t kFourGigabytes = 0xffffffff;

std::string littleEndian(std::uint32_t value) {
  std::string bytes(4, '\0');
  std::memcpy(bytes.data(), &value, 4);
  return bytes;
}

std::string bigEndian(std::uint32_t value) {
  const std::string bytes = littleEndian(value);
  return {bytes.rbegin(), bytes.rend()};
}

std::string repeated(const std::string& piece, std::size_t times) {
  std::string text;
  text.reserve(piece.size() * times);
  for (std::size_t i = 0; i < times; ++i) text += piece;
  return text;
}

/// A file of these bytes in the test's folder; its path, quoted.
std::string fileOf(const fs::path& folder, const std::string& name, const std::string& bytes) {
  writeNew(folder / name, bytes);
  return shellQuoted((folder / name).string());
}

// ---- bags

/// Where the bytes of a record begin that hold `text`, and a length that lies before it.
struct Claim {
  std::string what, text;
  std::size_t length_before;  ///< that many bytes before the text
  std::uint32_t claimed = kFourGigabytes;
};
std::ostream& operator<<(std::ostream& out, const Claim& claim) { return out << claim.what; }

class HostileBag : public testing::TestWithParam<Claim> {
 protected:
  /// Two images, not compressed, so that all lengths can be found.
  static std::string bytes(const fs::path& folder, rosbag::CompressionType compression) {
    rosbag::Bag bag((folder / "whole.bag").string(), rosbag::bagmode::Write);
    bag.setCompression(compression);
    for (unsigned k = 1; k <= 2; ++k) {
      auto image = stamped<ros1::Image>(rosTime(k));
      image.width = image.height = 8;
      image.step = 8;
      image.encoding = "mono8";
      image.data.assign(64, 'p');
      bag.write("/camera", rosTime(k), image);
      bag.write("/imu", rosTime(k), imuMessage(rosTime(k)));
    }
    bag.close();
    return readTextFile(folder / "whole.bag");
  }
  static std::string import(const fs::path& folder) {
    return " --topics " +
           fileOf(
               folder, "topics.yaml",
               "topics:\n"
               "  - {topic: /imu, as: INS, pose: {x: 0, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}}\n"
               "  - topic: /camera\n    as: CAMERA\n"
               "    pose: {x: 0, y: 0, z: 0, yaw_deg: 0, pitch_deg: 0, roll_deg: 0}\n"
               "    intrinsics: {width_px: 8, height_px: 8, fx_px: 10, fy_px: 10, cx_px: 4, cy_px: 4,\n"
               "                 distortion: {k1: 0, k2: 0, p1: 0, p2: 0, k3: 0}}\n") +
           " --out " + shellQuoted((folder / "out").string());
  }
  static ProgramResult imported(const fs::path& folder, const std::string& bag) {
    return runFathomWithinLimits("import bag --strict " + fileOf(folder, "hostile.bag", bag) +
                                 import(folder));
  }
};

TEST_P(HostileBag, IsOneLine) {
  const fs::path folder = scratchFolder();
  std::string bag = bytes(folder, rosbag::compression::Uncompressed);
  ASSERT_EQ(imported(folder, bag).status, 0);
  const auto at = bag.find(GetParam().text);
  ASSERT_NE(at, std::string::npos);
  bag.replace(at - GetParam().length_before, 4, littleEndian(GetParam().claimed));
  fs::remove_all(folder / "out");
  expectBadInput(imported(folder, bag), "hostile.bag");
  EXPECT_FALSE(fs::exists(folder / "out/hostile.rawlog"));
}

const std::string kPixels = std::string(64, 'p');
INSTANTIATE_TEST_SUITE_P(
    ClaimsLengthOf, HostileBag,
    testing::Values(Claim{"chunk's header", "compression=none", 8},
                    Claim{"compression", "compression=none", 4}, Claim{"chunk", "size=", 4},
                    Claim{"chunk's content", "size=", 4, 0x7fffffff}, Claim{"topic", "topic=/camera", 4},
                    Claim{"definition", "message_definition=", 4}, Claim{"frame", "frame\x08", 4},
                    Claim{"encoding", "mono8", 4}, Claim{"pixels", kPixels, 4},
                    Claim{"a gigabyte of pixels", kPixels, 4, 1U << 30U}),
    [](const auto& info) {
      std::string name = info.param.what;
      std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
      return name;
    });

TEST_F(HostileBag, CompressedChunkThatClaimsTooMuch) {
  const fs::path folder = scratchFolder();
  for (const auto compression : {rosbag::compression::BZ2, rosbag::compression::LZ4})
    for (const std::uint32_t claimed : {kFourGigabytes, 1U << 30U}) {
      std::string bag = bytes(folder, compression);
      bag.replace(bag.find("size=") + 5, 4, littleEndian(claimed));
      expectBadInput(imported(folder, bag), "a chunk's length is absurd");
    }
}

// A file with a hole really has the 3 GB that a record claims.
TEST_F(HostileBag, SparseFileThatHasWhatItClaims) {
  const fs::path folder = scratchFolder();
  std::string bag = bytes(folder, rosbag::compression::Uncompressed);
  const auto header = bag.find("compression=none") - 8;
  std::uint32_t header_bytes = 0;
  std::memcpy(&header_bytes, bag.data() + header, 4);
  bag.replace(header + 4 + header_bytes, 4, littleEndian(3'000'000'000));
  fileOf(folder, "hostile.bag", bag);
  fs::resize_file(folder / "hostile.bag", 3'100'000'000);
  expectBadInput(
      runFathomWithinLimits("import bag " + shellQuoted((folder / "hostile.bag").string()) + import(folder)),
      "a record's length is absurd");
  fs::remove(folder / "hostile.bag");
}

// ---- rawlogs

class HostileRawlog : public testing::Test {
 protected:
  void SetUp() override {
    Random random(3);
    writeRecording(folder_ / "whole.rawlog", randomSamples(20, random), {"", "", "a test"});
    whole_ = inflated(folder_ / "whole.rawlog");
  }
  /// What is left is told, and that something is lost.
  void expectLoss(const std::string& rawlog) {
    const auto result = runFathomWithinLimits("info " + fileOf(folder_, "hostile.rawlog", rawlog));
    EXPECT_EQ(result.status, 0) << result.err;
    EXPECT_NE(result.out.find("21 entries"), std::string::npos) << result.out;
    EXPECT_NE(result.out.find("lost"), std::string::npos) << result.out;
  }
  static std::string begin(const std::string& mrpt_class, char version) {
    return static_cast<char>(0x80 + mrpt_class.size()) + mrpt_class + version;
  }

  fs::path folder_ = scratchFolder();
  std::string whole_;
};

// Each would have to be searched for its end, all through the others.
TEST_F(HostileRawlog, ObservationsWithoutEnd) {
  expectLoss(whole_ + repeated(begin("mrpt::obs::CObservationGPS", 12), 300'000));
}

// At each byte the entry could end.
TEST_F(HostileRawlog, NothingButEnds) {
  expectLoss(whole_ + begin("mrpt::obs::CObservationGPS", 12) + std::string(60'000'000, '\x88') + "x");
}

TEST_F(HostileRawlog, BeamsThatClaimOthers) {
  expectLoss(whole_ + repeated(begin("mrpt::obs::CObservationRange", 3) + std::string(12, '\0') +
                                   littleEndian(100'000),
                               100'000));
}

TEST_F(HostileRawlog, AGigabyteOfZerosInAMegabyte) {
  writeNew(folder_ / "hostile.rawlog", "");
  const gzFile out = gzopen((folder_ / "hostile.rawlog").c_str(), "wb1");
  gzwrite(out, whole_.data(), static_cast<unsigned>(whole_.size()));
  const std::string zeros(1 << 20, '\0');
  for (int i = 0; i < 300; ++i) gzwrite(out, zeros.data(), static_cast<unsigned>(zeros.size()));
  gzclose(out);
  const auto result = runFathomWithinLimits("info " + shellQuoted((folder_ / "hostile.rawlog").string()));
  EXPECT_EQ(result.status, 0) << result.err;
  EXPECT_NE(result.out.find("lost"), std::string::npos) << result.out;
}

// ---- panels

class HostilePanel : public testing::Test {
 protected:
  void expectRefused(const std::string& obj, const std::string& why) {
    files_.obj = obj;
    expectBadInput(runFathomWithinLimits("map check " + shellQuoted(files_.write(folder_).string())), why);
  }

  fs::path folder_ = scratchFolder();
  BoardFiles files_;
};

TEST_F(HostilePanel, IndicesBeyondAnyMesh) {
  for (const char* vertex : {"2147483647", "-2147483648", "4000000000", "99999999999999999999"})
    expectRefused(with(kBoardObj, "f 5 6 8 7", std::string("f 5 6 8 ") + vertex), "board.obj: line 12");
}

TEST_F(HostilePanel, AFaceOfAHundredThousandVertices) {
  std::string vertices, face = "f";
  for (int k = 0; k < 100'000; ++k) {
    vertices += "v " + std::to_string(1e-5 * k) + " 0.2 0\n";
    face += " " + std::to_string(9 + k);
  }
  expectRefused(with(kBoardObj, "f 5 6 8 7", vertices + face), "board.obj: line 100012");
}

TEST_F(HostilePanel, AnEdgeOfTenThousandFaces) {
  expectRefused(kBoardObj + repeated("f 3 1 5 7\n", 10'000), "not manifold");
}

TEST_F(HostilePanel, FilesWithoutEnd) {
  for (const char* library : {"/dev/zero", "../../../../../../../../../../dev/zero"})
    expectRefused(with(kBoardObj, "mtllib board.mtl", std::string("mtllib ") + library), "board.obj: line 1");
  files_.yaml = with(kBoardYaml, "board.obj", "/dev/zero");
  expectRefused(kBoardObj, "mesh");
  expectBadInput(runFathomWithinLimits("map check /dev/zero"), "/dev/zero: is larger than 256 MB");
}

// ---- YAML

TEST(HostileYaml, ManyValuesInFewBytes) {
  const fs::path folder = scratchFolder();
  const std::string list = "panel: board\nmarkers: [" + repeated("1,", 7'000'000) + "1]\n";
  expectBadInput(runFathomWithinLimits("map check " + fileOf(folder, "list.yaml", list)),
                 "list.yaml: line 2: too large");
  const std::string long_text = "panel: " + std::string(100'000'000, 'x') + "\n";
  expectBadInput(runFathomWithinLimits("map check " + fileOf(folder, "long.yaml", long_text)),
                 "is larger than 16 MB");
}

// ---- images

std::string pngPart(const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const auto checksum = crc32(0, reinterpret_cast<const Bytef*>(body.data()), static_cast<uInt>(body.size()));
  return bigEndian(static_cast<std::uint32_t>(data.size())) + body +
         bigEndian(static_cast<std::uint32_t>(checksum));
}

std::string deflatedZeros(std::size_t size) {
  const std::string zeros(size, '\0');
  std::string data(compressBound(size), '\0');
  uLongf length = data.size();
  compress2(reinterpret_cast<Bytef*>(data.data()), &length, reinterpret_cast<const Bytef*>(zeros.data()),
            size, 9);
  data.resize(length);
  return data;
}

/// Its checksums are right. kind: bits, colour, compression, filter, interlace.
std::string png(std::uint32_t width, std::uint32_t height, const std::string& data,
                const std::string& kind = std::string("\x08\0\0\0\0", 5)) {
  return "\x89PNG\r\n\x1a\n" + pngPart("IHDR", bigEndian(width) + bigEndian(height) + kind) +
         pngPart("IDAT", data) + pngPart("IEND", "");
}

class HostileImage : public testing::Test {
 protected:
  void expectRefused(const std::string& name, const std::string& bytes, const std::string& why) const {
    expectBadInput(runFathomWithinLimits("detect --family tag36h11 " + fileOf(folder_, name, bytes)),
                   name + ": " + why);
  }
  fs::path folder_ = scratchFolder();
};

TEST_F(HostileImage, Png) {
  const std::string little = deflatedZeros(1000);
  expectRefused("wide.png", png(60000, 60000, little), "byte 16: an image of 60000 x 60000 pixels");
  expectRefused("line.png", png(0x7fffffff, 1, little), "byte 16: an image of 2147483647 x 1 pixels");
  expectRefused("none.png", png(0, 0, little), "byte 16: damaged: an image without a pixel");
  expectRefused("lying.png", png(9000, 9000, little), "byte 16: damaged: too few data");
  expectRefused("kind.png", png(8, 8, little, std::string("\x07\0\0\0\0", 5)),
                "byte 24: damaged: no such kind");
  expectRefused("colour.png", png(8, 8, little, std::string("\x08\x55\0\0\0", 5)),
                "byte 24: damaged: no such kind");
  // It has all the pixels that it claims, in a few hundred kilobytes.
  expectRefused("bomb.png", png(20000, 20000, deflatedZeros(20001UL * 20000UL)),
                "byte 16: an image of 20000 x 20000");
}

TEST_F(HostileImage, JpegAndBmp) {
  const fs::path corpus = kSource / "tests/fuzz/corpus";
  std::string jpeg = readTextFile(corpus / "colour.jpg");
  const auto frame = jpeg.find(std::string("\xff\xc0\x00\x11", 4));
  ASSERT_NE(frame, std::string::npos);
  expectRefused("wide.jpg", jpeg.replace(frame + 5, 4, "\xea\x60\xea\x60"), "byte");
  expectRefused("none.jpg", jpeg.replace(frame + 5, 4, std::string(4, '\0')), "byte");
  const std::string bmp = readTextFile(corpus / "colour.bmp");
  for (const std::uint32_t side : {60000U, 0U, 0x80000000U, 0x7fffffffU})
    expectRefused("size.bmp", std::string(bmp).replace(18, 8, littleEndian(side) + littleEndian(side)),
                  "byte 18");
}

// ---- tables

TEST(HostileTable, ALineOfAHundredMegabytes) {
  const fs::path folder = scratchFolder();
  const std::string camera =
      " --camera " +
      fileOf(folder, "camera.yaml",
             "fx_px: 500\nfy_px: 500\ncx_px: 320\ncy_px: 240\ndistortion: [0, 0, 0, 0, 0]\n") +
      " --out " + shellQuoted((folder / "out").string());
  const std::string digits(100'000'000, '1'), header = "x_mm,y_mm,z_mm,u_px,v_px\n";
  for (const std::string& text : {digits, header + digits, header + repeated("1,", 50'000'000)})
    expectBadInput(runFathomWithinLimits("import corners " + fileOf(folder, "line.csv", text) + camera),
                   "line.csv: line");
}

}  // namespace
}  // namespace fathom::test
