// Which images of a long recording light is compared in.
#include "observables/posed_images.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

/// So many moments with a pair of images each; of every third entry none is posed.
std::vector<PosedImage> pairs(std::size_t moments) {
  std::vector<PosedImage> posed;
  for (std::size_t k = 0; k < moments; ++k)
    for (const std::size_t eye : {std::size_t{0}, std::size_t{1}}) {
      PosedImage image;
      image.entry = k + k / 2;
      image.eye = eye;
      posed.push_back(image);
    }
  return posed;
}

TEST(KeepSpread, KeepsPairsEvenlySpread) {
  std::vector<PosedImage> posed = pairs(18);
  EXPECT_EQ(keepSpread(posed, 5), 18u);
  ASSERT_EQ(posed.size(), 10u);
  for (std::size_t i = 0; i < posed.size(); i += 2) {
    EXPECT_EQ(posed[i].entry, posed[i + 1].entry);
    EXPECT_NE(posed[i].eye, posed[i + 1].eye);
    // Of 18 moments each fifth part has three or four: of 27 entries four to six.
    if (i > 0) EXPECT_NEAR(static_cast<double>(posed[i].entry - posed[i - 2].entry), 5, 1);
  }
}

TEST(KeepSpread, LeavesFewerAsTheyAre) {
  std::vector<PosedImage> posed = pairs(4);
  EXPECT_EQ(keepSpread(posed, 4), 4u);
  EXPECT_EQ(posed.size(), 8u);
}

}  // namespace
}  // namespace fathom
