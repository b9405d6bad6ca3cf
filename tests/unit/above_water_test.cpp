// Whether a camera is above water is the vehicle file's to say, and only its markers tell of the surface.
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/files.h"
#include "estimation/readings.h"
#include "imaging/fingerprints.h"
#include "recording/samples.h"
#include "support/shared_data.h"
#include "support/shipped.h"

namespace fathom {
namespace {

Vehicle vehicleWith(const std::string& line) {
  std::string text = readTextFile(test::kRov);
  const std::string before = "  corner_sigma_px:";
  const auto at = text.find(before);
  if (at != std::string::npos) text.insert(at, line);
  const auto file = test::scratchFolder() / "vehicle.yaml";
  writeTextFile(file, text);
  return readVehicle(file);
}

TEST(AboveWater, IsAKeyOfTheCamera) {
  EXPECT_FALSE(vehicleWith("").camera.value().model.above_water);
  EXPECT_FALSE(vehicleWith("  above_water: false\n").camera.value().model.above_water);
  EXPECT_TRUE(vehicleWith("  above_water: true\n").camera.value().model.above_water);
  EXPECT_THROW(vehicleWith("  above_water: 0.4\n"), Error);
}

TEST(AboveWater, ImagesAreMadeAnewWhereItChanges) {
  CameraSheet sheet;
  const std::string below = fingerprintOf(sheet);
  sheet.model.above_water = true;
  EXPECT_NE(fingerprintOf(sheet), below);
}

// Rawlogs have no place for it: what is written reads back the same.
TEST(AboveWater, RawlogsDoNotKeepIt) {
  const CameraModel above{.above_water = true};
  EXPECT_EQ(recordedCamera(above).model, CameraModel{});
}

// Whichever is asked first.
TEST(AboveWater, OnlySuchCamerasMarkersDependOnTheSurface) {
  BatchMarker below, above;
  above.camera.above_water = true;
  for (int round = 0; round < 2; ++round) {
    EXPECT_FALSE(markerModel(below)->dependsOn(kEffectIndex<FlatWaterSurface>));
    EXPECT_TRUE(markerModel(above)->dependsOn(kEffectIndex<FlatWaterSurface>));
    for (const BatchMarker& seen : {below, above}) {
      EXPECT_TRUE(markerModel(seen)->dependsOn(kEffectIndex<FlatPortRefraction>));
      EXPECT_FALSE(markerModel(seen)->dependsOn(kEffectIndex<DvlScale>));
    }
  }
}

}  // namespace
}  // namespace fathom
