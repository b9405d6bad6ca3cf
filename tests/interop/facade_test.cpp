// The facade as a program of one's own calls it, on the shipped dive and on what is wrong with copies of it.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "facade/fathom.h"
#include "recording/rawlog.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

class Facade : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = test::scratchFolder();
    fs::copy(test::kSource / "rawlogs/dive", folder_ / "dive", fs::copy_options::recursive);
  }
  fs::path dive() const { return folder_ / "dive/dive.rawlog"; }

  fs::path folder_;
};

TEST_F(Facade, LocalizeSaysWhatIsLost) {
  const LocalizedPath whole = localize(dive());
  EXPECT_FALSE(whole.loss);
  const std::string bytes = readTextFile(dive());
  writeTextFile(dive(), bytes.substr(0, bytes.size() / 5));
  const LocalizedPath cut = localize(dive());
  EXPECT_LT(cut.filtered.size(), whole.filtered.size() / 3);
  ASSERT_TRUE(cut.loss);
  ASSERT_FALSE(cut.remarks.empty());
  EXPECT_TRUE(cut.remarks.back().starts_with("The recording is damaged: reading stopped at byte "))
      << cut.remarks.back();
}

/// What an error advises can be done here too.
TEST_F(Facade, AcceptsAndCorrectsWhatTheAuditFinds) {
  const LocalizedPath right = localize(dive());
  RawlogReader reader(dive());
  RawlogWriter writer(folder_ / "dive/millimetres.rawlog", reader.header(), reader.next()->time);
  while (auto sample = reader.next()) {
    auto* dvl = std::get_if<DvlSample>(&sample->reading);
    if (dvl != nullptr && dvl->velocity_dvl) *dvl->velocity_dvl *= 1000.0;
    writer.write(*sample);
  }
  writer.finish();
  const fs::path file = folder_ / "dive/millimetres.rawlog";
  EXPECT_THROW(localize(file), Error);
  EXPECT_THROW(openRecording(file), Error);

  RecordingOptions options;
  options.audit.correct = {"dvl-in-millimetres"};
  const LocalizedPath corrected = localize(file, {}, options);
  ASSERT_EQ(corrected.filtered.size(), right.filtered.size());
  const auto end = [](const LocalizedPath& path) { return path.filtered.back().state.motion.position_odom; };
  EXPECT_LT((end(corrected) - end(right)).norm(), 1e-6);  // times 1000, divided by 1000
  options.audit = {.accept = {"dvl-in-millimetres"}, .correct = {}};
  EXPECT_NO_THROW(localize(file, {}, options));
}

}  // namespace
}  // namespace fathom
