// Recordings of cameras, panels and markers that are not as drawn: the simulation in the loop is as like them
// as it is to plain ones where it is given the calibration, and visibly less so without.
#include <gtest/gtest.h>

#include "sil/pair_maker.h"
#include "similarity/measures.h"
#include "support/shared_data.h"
#include "support/sil_recordings.h"

namespace fathom {
namespace {

struct Alike {
  double fsim = 0;
  double angle_error_rad = 0;  ///< of the robot; both are means over the images
};

/// What the loop makes of a recording when it is told of `known`.
Alike alikeness(const RecordingFiles& recording, const EffectParameters<double>& known) {
  KnownWorld world = test::silWorld();
  world.effects = known;
  const DetectionSettings detection = test::silDetection();
  const PosedImages images = posedImages(recording.rawlog, {}, world.panels, detection, known);
  const PosedImages truth = test::atTruth(images, recording.rawlog);
  const PairMaker maker(world, {}, detection);
  const PairMeasurer measurer({"fsim"});
  Alike alike;
  const auto count = static_cast<double>(images.posed.size());
  EXPECT_EQ(images.posed.size(), 2U);
  for (std::size_t i = 0; i < images.posed.size(); ++i) {
    const auto measured = measurer.measure(maker.make(images.posed[i]).images);
    alike.fsim += measured.at(0).outcome.values.at(0).value() / count;
    alike.angle_error_rad +=
        angleBetween(images.posed[i].T_odom_robot.pose.rotation, truth.posed[i].T_odom_robot.pose.rotation) /
        count;
  }
  return alike;
}

RecordingFiles recordingWith(const EffectParameters<double>& effects) {
  return test::simulateForSil(test::scratchFolder(), {.images = 2, .effects = effects});
}

double plainFsim() {
  static const double fsim = alikeness(recordingWith({}), {}).fsim;
  return fsim;
}

// FSIM of two images of the same scene, each with its noise, is 0.998 here.
constexpr double kSame = 0.003, kVisiblyLess = 0.01;

TEST(SilCalibration, OfALens) {
  EffectParameters<double> effects;
  effects.add<LensDistortion>({-0.1, 0.03, 0, 0});
  const auto recording = recordingWith(effects);
  const double with = alikeness(recording, effects).fsim, without = alikeness(recording, {}).fsim;
  EXPECT_NEAR(with, plainFsim(), kSame);
  EXPECT_LT(without, with - kVisiblyLess);
}

TEST(SilCalibration, OfAPortWhichBendsTheLight) {
  EffectParameters<double> effects;
  effects.add<FlatPortRefraction>({0.1, 0.01, 10, 5, 0.05});
  const auto recording = recordingWith(effects);
  const double with = alikeness(recording, effects).fsim, without = alikeness(recording, {}).fsim;
  EXPECT_NEAR(with, plainFsim(), kSame);
  EXPECT_LT(without, with - kVisiblyLess);
}

TEST(SilCalibration, OfAMarkerThatWasMoved) {
  EffectParameters<double> effects;
  const int id = readPanelMaps(test::kDexrovMap).front().markers.front().id;
  effects.add<MarkerMoved>({1.0 * id, 0.06, 0.02, 0, 15});
  const auto recording = recordingWith(effects);
  const double with = alikeness(recording, effects).fsim, without = alikeness(recording, {}).fsim;
  EXPECT_NEAR(with, plainFsim(), kSame);
  EXPECT_LT(without, with - kVisiblyLess);
}

// A camera that looks elsewhere sees the panel where it does whichever the robot's pose: that pose tells.
TEST(SilCalibration, OfACameraThatLooksElsewhere) {
  EffectParameters<double> effects;
  effects.add<CameraMisalignment>({1.0, -2.0, 0.5});
  const auto recording = recordingWith(effects);
  const Alike with = alikeness(recording, effects), without = alikeness(recording, {});
  EXPECT_NEAR(with.fsim, plainFsim(), kSame);
  EXPECT_LT(with.angle_error_rad, radians(0.5));
  EXPECT_NEAR(without.angle_error_rad, radians(2.3), radians(0.5));  // as long as the rotation vector
}

}  // namespace
}  // namespace fathom
