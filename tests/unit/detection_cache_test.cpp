// Detections are made once: what is kept, when it counts, and what damage does to it.
#include "landmarks/detection_cache.h"

#include <bit>
#include <csignal>
#include <cstdint>
#include <opencv2/imgcodecs.hpp>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "support/detections.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

const CameraModel kKeptCamera{
    .width_px = 320, .height_px = 240, .fx_px = 277, .fy_px = 277, .cx_px = 160, .cy_px = 120};

bool sameBits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

void expectSame(const Detection& a, const Detection& b) {
  EXPECT_EQ(a.family, b.family);
  EXPECT_EQ(a.id, b.id);
  for (std::size_t k = 0; k < 4; ++k)
    for (Eigen::Index i = 0; i < 2; ++i) EXPECT_TRUE(sameBits(a.corners_px[k][i], b.corners_px[k][i]));
  for (Eigen::Index i = 0; i < 64; ++i)
    EXPECT_TRUE(sameBits(a.covariance_px2.reshaped()[i], b.covariance_px2.reshaped()[i]));
  EXPECT_EQ(a.refined, b.refined);
  EXPECT_EQ(a.corrected_bits, b.corrected_bits);
  EXPECT_TRUE(sameBits(a.decision_margin, b.decision_margin));
  EXPECT_TRUE(sameBits(a.contrast, b.contrast));
  EXPECT_TRUE(sameBits(a.blur_sigma_px, b.blur_sigma_px));
}

void expectSame(const Detections& a, const Detections& b) {
  ASSERT_EQ(a.by_file.size(), b.by_file.size());
  for (const auto& [file, detections] : a.by_file) {
    ASSERT_NE(b.find(file), nullptr) << file;
    ASSERT_EQ(detections.size(), b.find(file)->size());
    for (std::size_t k = 0; k < detections.size(); ++k) expectSame(detections[k], b.find(file)->at(k));
  }
}

/// The one file that keeps detections.
fs::path keptFile(const fs::path& folder) {
  fs::path found;
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().extension() == ".gz") found = entry.path();
  return found;
}

class DetectionCache : public testing::Test {
 protected:
  DetectionCache() {
    settings = settingsFor({map});
    for (int i = 0; i < kImages; ++i) draw(i, 2.0 + 0.1 * i);
  }
  void draw(int number, double distance_m) {
    Random random(static_cast<std::uint64_t>(number + 1));
    const Pose T_camera_panel = test::lookingAtPanel(distance_m, 0.3, 0.5);
    const cv::Mat image = test::drawMarkers(map.markers, kKeptCamera, T_camera_panel, look, random);
    const fs::path file = folder / ("CAMERA_" + std::to_string(number) + ".png");
    cv::imwrite(file.string(), image);
    if (number >= static_cast<int>(images.size())) images.push_back({file, kKeptCamera});
  }
  Detections found() const { return detectImages(images, settings, keep_in); }

  static constexpr int kImages = 5;
  test::Look look{.supersampling = 2};
  fs::path folder = test::scratchFolder(), keep_in = folder / "dive_detections";
  PanelMap map = test::gridPanel(2, 1);
  std::vector<CameraImage> images;
  DetectionSettings settings;
};

TEST_F(DetectionCache, SearchesOnceAndKeepsEveryBit) {
  const Detections first = found();
  EXPECT_EQ(first.kept_before, 0U);
  EXPECT_EQ(first.by_file.size(), 5U);
  EXPECT_EQ(first.markerCount(), 10U);
  EXPECT_EQ(first.kept_in, keptFile(folder));
  EXPECT_EQ(first.not_kept_why, "");
  const Detections again = found();
  EXPECT_EQ(again.kept_before, 5U);
  expectSame(first, again);
}

TEST_F(DetectionCache, IsWhatADetectorFinds) {
  DetectorOptions options;
  options.camera = kKeptCamera;
  const auto detector = makeDetector(Backend::aruco, settings.families, options);
  const Detections all = found();
  for (const CameraImage& image : images) {
    const auto direct = detector->detect(cv::imread(image.file.string(), cv::IMREAD_GRAYSCALE));
    ASSERT_NE(all.find(image.file), nullptr);
    ASSERT_EQ(all.find(image.file)->size(), direct.size());
    for (std::size_t k = 0; k < direct.size(); ++k) expectSame(direct[k], all.find(image.file)->at(k));
  }
}

TEST_F(DetectionCache, OnlyWhatChangedIsSearchedAgain) {
  found();
  draw(2, 3.0);
  const Detections again = found();
  EXPECT_EQ(again.kept_before, 4U);
  EXPECT_EQ(found().kept_before, 5U);
  images[1].camera.k1 = 0.01;
  EXPECT_EQ(found().kept_before, 4U);
}

TEST_F(DetectionCache, CountsForTheSameImagesElsewhere) {
  const Detections here = found();
  fs::create_directories(folder / "moved");
  for (CameraImage& image : images) {
    const fs::path moved = folder / "moved" / ("other_" + image.file.filename().string());
    fs::rename(image.file, moved);
    image.file = moved;
  }
  const Detections there = found();
  EXPECT_EQ(there.kept_before, 5U);
  EXPECT_EQ(there.markerCount(), here.markerCount());
}

TEST_F(DetectionCache, OtherSettingsAreKeptApart) {
  const fs::path first = found().kept_in;
  settings.refine = false;
  const Detections rough = found();
  EXPECT_EQ(rough.kept_before, 0U);
  EXPECT_NE(rough.kept_in, first);
  settings.backend = Backend::apriltag;
  EXPECT_EQ(found().kept_before, 0U);
  settings.fallback = Backend::aruco;
  EXPECT_EQ(found().kept_before, 0U);
  settings = settingsFor({map});
  EXPECT_EQ(found().kept_before, 5U);
}

TEST_F(DetectionCache, DamageIsMadeGood) {
  const Detections whole = found();
  const std::string bytes = readTextFile(whole.kept_in);
  for (std::size_t i = 0; i < 12; ++i) {
    std::string damaged = bytes;
    const std::size_t at = i * (bytes.size() - 1) / 11;
    if (i % 2 == 0)
      damaged.resize(at);
    else
      damaged[at] = static_cast<char>(damaged[at] ^ 0x20);
    writeTextFile(whole.kept_in, damaged);
    expectSame(found(), whole);
    EXPECT_EQ(found().kept_before, 5U) << "made anew";
  }
}

TEST_F(DetectionCache, SomeoneElsesFileIsNotBelieved) {
  const fs::path file = found().kept_in;
  settings.refine = false;
  const fs::path other = found().kept_in;
  fs::copy_file(file, other, fs::copy_options::overwrite_existing);
  EXPECT_EQ(found().kept_before, 0U);
}

TEST_F(DetectionCache, UnreadableImagesAreNamed) {
  fs::remove(images[0].file);
  fs::resize_file(images[1].file, fs::file_size(images[1].file) / 2);
  images[2].camera.width_px = 640;
  writeTextFile(images[3].file, "");
  const Detections result = found();
  ASSERT_EQ(result.unreadable.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(result.unreadable[i].file, images[i].file);
  EXPECT_NE(result.unreadable[1].why.find("cut off"), std::string::npos) << result.unreadable[1].why;
  EXPECT_EQ(result.unreadable[2].why, "is of 320 x 240 pixels, its camera of 640 x 240");
  EXPECT_EQ(result.by_file.size(), 1U);
  EXPECT_EQ(result.find(images[0].file), nullptr);
  EXPECT_EQ(found().kept_before, 1U);
}

TEST_F(DetectionCache, AFolderThatCannotBeWrittenDoesNoHarm) {
  writeTextFile(folder / "file", "");
  keep_in = folder / "file/dive_detections";
  const Detections result = found();
  EXPECT_EQ(result.markerCount(), 10U);
  EXPECT_EQ(result.kept_in, "");
  EXPECT_NE(result.not_kept_why.find("dive_detections"), std::string::npos) << result.not_kept_why;
  keep_in.clear();
  EXPECT_EQ(found().not_kept_why, "");
}

TEST_F(DetectionCache, AnInterruptedRunLeavesNothingHalf) {
  // A process of its own: the wish to stop cannot be taken back.
  testing::GTEST_FLAG(death_test_style) = "threadsafe";
  const auto stopped = [&] {
    const fs::path kept = found().kept_in;
    const std::string before = readTextFile(kept);
    draw(4, 3.0);
    catchInterrupts();
    std::raise(SIGINT);
    try {
      found();
    } catch (const Interrupted&) {
      const bool part = fs::exists(kept.string() + ".part");
      std::exit(!part && readTextFile(kept) == before ? 7 : 1);
    }
    std::exit(2);
  };
  EXPECT_EXIT(stopped(), testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace fathom
