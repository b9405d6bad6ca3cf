// Keys of a localization config: what they set, and what is refused.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "localization/options.h"
#include "support/panels.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

LocalizationOptions readOptionsText(const std::string& text) {
  const auto folder = test::scratchFolder();
  std::filesystem::remove(folder / "task.yaml");
  test::writeNew(folder / "task.yaml", text);
  return readLocalizationOptions(folder / "task.yaml");
}

TEST(LocalizationOptions, LandmarksAndLost) {
  const LocalizationOptions defaults = readOptionsText("task: TL4\n");
  EXPECT_EQ(defaults.landmarks.form, LandmarkOptions::Form::joint);
  EXPECT_NEAR(defaults.landmarks.position_sigma_m * defaults.landmarks.position_sigma_m, 1e-3, 2e-6);
  const LocalizationOptions options = readOptionsText(
      "landmarks: {pose: mean, position_sigma_m: 0.2, angle_sigma_deg: 4}\n"
      "lost: {position_sigma_m: 2, angle_sigma_deg: 30, contradiction_s: 5, blind_s: 20}\n");
  EXPECT_EQ(options.landmarks.form, LandmarkOptions::Form::mean);
  EXPECT_EQ(options.landmarks.position_sigma_m, 0.2);
  EXPECT_NEAR(options.landmarks.angle_sigma_rad, radians(4), 1e-12);
  EXPECT_EQ(options.lost.position_sigma_m, 2.0);
  EXPECT_NEAR(options.lost.angle_sigma_rad, radians(30), 1e-12);
  EXPECT_EQ(options.lost.contradiction_s, 5.0);
  EXPECT_EQ(options.lost.blind_s, 20.0);
}

TEST(LocalizationOptions, WrongValuesAreNamed) {
  for (const char* text : {"landmarks: {pose: median}", "landmarks: {position_sigma_m: 0}",
                           "lost: {blind_s: -1}", "landmarks: {sigma: 1}", "lost: 3"})
    EXPECT_THROW(readOptionsText(text), Error) << text;
}

}  // namespace
}  // namespace fathom
