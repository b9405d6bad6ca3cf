// `fathom fsim` as people meet it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "support/run_program.h"
#include "support/shared_data.h"
#include "support/textured_images.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::expectBadInput;
using test::runFathom;
using test::shellQuoted;

fs::path saved(const fs::path& file, const cv::Mat& image) {
  cv::imwrite(file.string(), image);
  return file;
}

test::ProgramResult fsimOf(const fs::path& reference, const fs::path& image,
                           const std::string& options = "") {
  return runFathom("fsim " + shellQuoted(reference.string()) + " " + shellQuoted(image.string()) + options);
}

TEST(FsimCommand, GivesTheAuthorsValues) {
  FATHOM_NEEDS_SHARED("data/fsim");
  const fs::path folder = test::sharedData("data/fsim");
  const auto text = fsimOf(folder / "i01.bmp", folder / "i01_01_5.bmp");
  EXPECT_EQ(text.status, 0) << text.err;
  EXPECT_EQ(text.out, "FSIM   0.936738\nFSIMc  0.925871\n");
  const auto json = nlohmann::json::parse(fsimOf(folder / "i01.bmp", folder / "i01_01_5.bmp", " --json").out);
  EXPECT_NEAR(json["fsim"], 0.93674, 1e-5);
  EXPECT_NEAR(json["fsimc"], 0.92587, 1e-5);
}

TEST(FsimCommand, OfOneImageItIsOne) {
  const fs::path image = saved(test::scratchFolder() / "a.png", test::texturedImage({160, 120}, 1));
  EXPECT_EQ(fsimOf(image, image).out, "FSIM   1.000000\nFSIMc  1.000000\n");
}

TEST(FsimCommand, RefusesWhatItCannotCompare) {
  const fs::path folder = test::scratchFolder();
  const fs::path good = saved(folder / "good.png", test::texturedImage({160, 120}, 1));
  expectBadInput(fsimOf(good, folder / "missing.png"), "missing.png");
  expectBadInput(fsimOf(folder / "missing.png", good), "missing.png");
  writeTextFile(folder / "notes.txt", "no image\n");
  expectBadInput(fsimOf(good, folder / "notes.txt"), "notes.txt: neither a PNG");
  expectBadInput(fsimOf(good, saved(folder / "wide.png", test::texturedImage({200, 120}, 1))),
                 "wide.png: the image is of 200 x 120 pixels, the reference of 160 x 120");
  const fs::path small = saved(folder / "small.png", test::texturedImage({60, 40}, 1));
  expectBadInput(fsimOf(small, small), "48 or more");
  const fs::path plain = saved(folder / "plain.png", cv::Mat(120, 160, CV_8UC3, cv::Scalar(9, 9, 9)));
  expectBadInput(fsimOf(plain, plain), "nothing to see");
  expectBadInput(runFathom("fsim " + shellQuoted(good.string())), "IMAGE is required");
}

}  // namespace
}  // namespace fathom
