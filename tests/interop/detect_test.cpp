// `fathom detect` as people meet it, on photos with expected detections among others.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>
#include <vector>

#include "core/camera_model.h"
#include "support/run_program.h"
#include "support/shared_data.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;
using test::runFathom;
using test::shellQuoted;

struct Tag {
  int id = 0;
  std::array<Vector2d, 4> corners{};
};

/// `id, (x y), (x y), (x y), (x y)`; AprilTag's pixels and order, made ours.
std::vector<Tag> expectedTags(const fs::path& file) {
  std::ifstream in(file);
  std::vector<Tag> tags;
  for (std::string line; std::getline(in, line);) {
    for (char& c : line)
      if (c == '(' || c == ')' || c == ',') c = ' ';
    std::istringstream words(line);
    Tag tag;
    words >> tag.id;
    for (std::size_t k = 0; k < 4; ++k) words >> tag.corners[3 - k].x() >> tag.corners[3 - k].y();
    for (Vector2d& corner : tag.corners) corner.array() -= 0.5;
    if (words) tags.push_back(tag);
  }
  return tags;
}

std::vector<Tag> tagsOf(const std::string& csv) {
  std::istringstream lines(csv);
  std::vector<Tag> tags;
  std::string line;
  std::getline(lines, line);
  EXPECT_TRUE(line.starts_with("image,id,x0,y0,x1,y1,x2,y2,x3,y3,family")) << line;
  while (std::getline(lines, line)) {
    for (char& c : line)
      if (c == ',') c = ' ';
    std::istringstream words(line);
    std::string image;
    Tag tag;
    words >> image >> tag.id;
    for (Vector2d& corner : tag.corners) words >> corner.x() >> corner.y();
    tags.push_back(tag);
  }
  return tags;
}

double largestGap_px(const Tag& a, const Tag& b) {
  double gap = 0;
  for (std::size_t k = 0; k < 4; ++k) gap = std::max(gap, (a.corners[k] - b.corners[k]).norm());
  return gap;
}

TEST(Detect, FindsEveryExpectedTagInPhotos) {
  FATHOM_NEEDS_SHARED("data/apriltag");
  for (const char* name : {"33369213973_9d9bb4cc96_c", "34085369442_304b6bafd9_c"}) {
    const fs::path photo = test::sharedData("data/apriltag") / name;
    const auto expected = expectedTags(photo.string() + ".txt");
    ASSERT_GE(expected.size(), 12U);
    const auto result =
        runFathom("detect --family tag36h11 --backend apriltag " + shellQuoted(photo.string() + ".jpg"));
    ASSERT_EQ(result.status, 0) << result.err;
    const auto found = tagsOf(result.out);
    EXPECT_EQ(found.size(), expected.size());
    for (const Tag& tag : expected) {
      double nearest = 1e9;
      for (const Tag& candidate : found)
        if (candidate.id == tag.id) nearest = std::min(nearest, largestGap_px(tag, candidate));
      EXPECT_LT(nearest, 0.5) << name << " at " << tag.corners[0].transpose();
    }
  }
}

TEST(Detect, TellsWhatIsWrongWithAnImage) {
  FATHOM_NEEDS_SHARED("data/apriltag");
  const auto folder = test::scratchFolder();
  const fs::path photo = test::sharedData("data/apriltag/33369213973_9d9bb4cc96_c.jpg");
  const std::string bytes = readTextFile(photo);
  writeTextFile(folder / "cut.jpg", bytes.substr(0, bytes.size() / 2));
  writeTextFile(folder / "empty.png", "");
  writeTextFile(folder / "table.png", "image,id\n");
  const auto expectRefused = [&](const std::string& arguments, const std::string& part) {
    const auto result = runFathom("detect " + arguments);
    EXPECT_EQ(result.status, 2) << arguments;
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
  };
  const auto file = [&](const char* name) { return shellQuoted((folder / name).string()); };
  expectRefused("--family tag36h11 " + file("cut.jpg"), "cut.jpg: byte");
  expectRefused("--family tag36h11 " + file("empty.png"), "empty.png: the file is empty");
  expectRefused("--family tag36h11 " + file("table.png"), "neither");
  expectRefused("--family tag36h11 " + file("absent.png"), "absent.png");
  expectRefused("--family tag36h12 " + shellQuoted(photo.string()), "tag36h12");
  expectRefused("--family tagStandard41h12 --backend aruco " + shellQuoted(photo.string()), "aruco");
  expectRefused("--family tag36h11 --backend artoolkit " + shellQuoted(photo.string()), "artoolkit");
  expectRefused(shellQuoted(photo.string()), "--family");
  // A good image before a bad one leaves no half table.
  expectRefused("--family tag36h11 " + shellQuoted(photo.string()) + " " + file("cut.jpg") + " --out " +
                    file("table.csv"),
                "cut.jpg");
  EXPECT_FALSE(fs::exists(folder / "table.csv"));
}

TEST(Detect, WritesTheSameTableToAFile) {
  FATHOM_NEEDS_SHARED("data/sample/none");
  const auto folder = test::scratchFolder();
  const std::string image =
      shellQuoted(test::sharedData("data/sample/none/recording_Images/CAMERA_0030.png"));
  for (const char* options : {"--backend aruco", "--backend apriltag --corners fitted --preprocess clahe",
                              "--backend aruco --preprocess stretch --fallback"}) {
    const std::string command =
        std::string("detect --family DICT_ARUCO_ORIGINAL,tag36h11 ") + options + " " + image;
    const auto printed = runFathom(command);
    EXPECT_EQ(printed.status, 0) << printed.err;
    EXPECT_EQ(tagsOf(printed.out).size(), 12U) << options;  // all of the panel's
    const auto written = runFathom(command + " --out " + shellQuoted((folder / "t.csv").string()));
    EXPECT_EQ(written.out, "");
    EXPECT_EQ(readTextFile(folder / "t.csv"), printed.out);
  }
}

}  // namespace
}  // namespace fathom
