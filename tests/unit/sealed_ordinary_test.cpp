// The sealed generator's ordinary imperfections, and worlds that differ from the model in a declared way.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "core/error.h"
#include "sealed/corners.h"
#include "sealed/dive.h"
#include "sealed/doppler.h"
#include "sealed/manipulator.h"
#include "sealed/ordinary.h"
#include "sealed/panel_design.h"
#include "sealed/water_light.h"
#include "support/sealed_example.h"
#include "support/shared_data.h"

namespace fathom::sealed {
namespace {
namespace fs = std::filesystem;

const Vector3d kOrdinaryPanel_odom(kPanelX_m, kPanelY_m, kPanelZ_m);
const std::vector<double> kStamps_s{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};

SealedCase caseWith(const std::string& effects, const std::string& outside = "[]", double ordinary = 0) {
  SealedCase sealed = parseSealedCase(exampleCaseText(effects, "corners", outside), "case.json");
  sealed.ordinary = ordinary;
  return sealed;
}

using CornerPixels = std::map<std::string, std::vector<double>>;  // by image and marker

class SealedWorld : public testing::Test {
 protected:
  void SetUp() override { writePanel(folder_, false); }
  void TearDown() override { fs::remove_all(folder_); }

  TruePanel panelOf(const SealedCase& sealed) const { return {readPanelMap(folder_ / "panel.yaml"), sealed}; }
  CornerPixels cornersOf(const SealedCase& sealed) const {
    const Vehicle vehicle;
    const Dive dive = makeDive(sealed.dive, kOrdinaryPanel_odom);
    const TruePanel panel = panelOf(sealed);
    std::istringstream table(
        cornersTable(vehicle, sealed, panel, Viewpoint(vehicle, sealed, dive), kStamps_s));
    CornerPixels corners;
    std::string line, field;
    std::getline(table, line);
    while (std::getline(table, line)) {
      std::istringstream fields(line);
      std::vector<std::string> all;
      while (std::getline(fields, field, ',')) all.push_back(field);
      std::vector<double>& pixels = corners[all[0] + " " + all[2]];
      for (std::size_t i = 4; i < all.size(); ++i) pixels.push_back(std::stod(all[i]));
    }
    return corners;
  }

  const fs::path folder_ = test::scratchFolder();
};

double area(const std::vector<double>& c) {
  double twice = 0;
  for (std::size_t i = 0; i < 4; ++i)
    twice += c[2 * i] * c[(2 * i + 3) % 8] - c[(2 * i + 2) % 8] * c[2 * i + 1];
  return std::abs(twice) / 2;
}
double perimeter(const std::vector<double>& c) {
  double sum = 0;
  for (std::size_t i = 0; i < 4; ++i)
    sum += std::hypot(c[(2 * i + 2) % 8] - c[2 * i], c[(2 * i + 3) % 8] - c[2 * i + 1]);
  return sum;
}

TEST_F(SealedWorld, EdgeBiasTakesAStripOffTheBlackSquare) {
  const CornerPixels plain = cornersOf(caseWith("[]"));
  const CornerPixels grown =
      cornersOf(caseWith(R"([{"id": "edge-bias", "parameters": {"offset_px": 0.1}}])"));
  ASSERT_GT(plain.size(), 30U);
  for (const auto& [name, corners] : plain)
    EXPECT_NEAR(area(corners) - area(grown.at(name)), 0.1 * perimeter(corners), 0.06) << name;
}

TEST_F(SealedWorld, PanelShapeIsWhatItsParametersSay) {
  const SealedCase sealed = caseWith(
      R"([{"id": "panel-shape", "parameters": {"stretch_x": 0.003, "shear": 0.001, "twist_m": 0.004}}])");
  const TruePanel panel = panelOf(sealed);
  const Vector3d corner = panel.bent({kHalfWidth_m, kHalfHeight_m, 0}, 0);
  EXPECT_NEAR(corner.x(), kHalfWidth_m * 1.003 + 0.001 * kHalfHeight_m, 1e-12);
  EXPECT_NEAR(corner.y(), kHalfHeight_m, 1e-12);
  EXPECT_NEAR(corner.z(), 0.004, 1e-12);
  EXPECT_NEAR(panel.bent({-kHalfWidth_m, kHalfHeight_m, 0}, 0).z(), -0.004, 1e-12);
  EXPECT_FALSE(panel.flat());
}

TEST_F(SealedWorld, MarkersAreWiderThanHighInTheirOwnAxes) {
  const SealedCase sealed = caseWith("[]", R"([{"kind": "markers-wide", "size": 0.006}])");
  const TruePanel panel = panelOf(sealed);
  for (const Marker& marker : panel.map().markers) {
    const auto corners = panel.corners_panel(marker, 0);
    EXPECT_NEAR((corners[1] - corners[0]).norm() / (corners[3] - corners[0]).norm(), 1.006, 1e-12);
  }
}

TEST(SealedClock, StampsRunAheadOfTrueTime) {
  const SealedCase sealed = caseWith(
      R"([{"id": "clock-drift", "parameters": {"sensor": "INS", "rate_ppm": 100}},
          {"id": "clock-drift", "parameters": {"sensor": "DVL", "rate_ppm": -20}}])");
  EXPECT_NEAR(sealed.trueTime_s("INS", 100), 100 - 0.01, 1e-6);
  EXPECT_NEAR(sealed.trueTime_s("DVL", 100), 100 + 0.002, 1e-6);
  EXPECT_EQ(sealed.trueTime_s("CAMERA", 100), 100);
}

TEST(SealedIntervals, AnEffectIsOnInEachOfThem) {
  const SealedCase sealed = caseWith(
      R"([{"id": "water-current", "parameters": {"current_m_s": [1, 0, 0]}, "active_s": [[1, 2], [4, 5]]}])");
  std::string on;
  for (const double t_s : {0.5, 1.5, 3.0, 4.5, 5.5}) on += sealed.find("water-current", t_s) ? '1' : '0';
  EXPECT_EQ(on, "01010");
}

TEST(SealedIntervals, OnesOfTheWrongFormAreErrors) {
  for (const char* wrong : {"[2, 1]", "[[1, 2], [3]]", "[1, [2, 3]]", "\"always\"", "[]"})
    EXPECT_THROW(caseWith(R"([{"id": "dvl-scale", "parameters": {"scale_error": 0.1}, "active_s": )" +
                          std::string(wrong) + "}]"),
                 Error)
        << wrong;
  EXPECT_THROW(
      caseWith(
          R"([{"id": "clock-drift", "parameters": {"sensor": "INS", "rate_ppm": 9}, "active_s": [1, 2]}])"),
      Error);
}

TEST(SealedFields, HaveTheirSizeAndLength) {
  double square = 0, product = 0;
  constexpr int kFields = 4000;
  for (int i = 0; i < kFields; ++i) {
    const SmoothField field(2, 0.5, Random(static_cast<std::uint64_t>(i)));
    square += field.at(0.3) * field.at(0.3) / kFields;
    product += field.at(0.3) * field.at(0.8) / kFields;
  }
  EXPECT_NEAR(square, 4, 0.3);
  EXPECT_NEAR(product / square, std::exp(-0.5), 0.05);
}

TEST(SealedFields, TablesAreNearThem) {
  const SmoothField field(1, 0.05, Random(1));
  const FieldTable table = onPanel(field);
  for (double x = -0.8; x < 0.8; x += 0.037)
    EXPECT_NEAR(table.at(x, -x / 2), field.at({x, -x / 2, 0}), 0.04) << x;
  EXPECT_EQ(FieldTable().at(1, 2), 0);
}

TEST(SealedOutliers, AreAsManyAsSaid) {
  const SealedCase sealed = caseWith("[]", R"([{"kind": "dvl-outliers", "size": 0.03}])");
  const SealedCase clean = caseWith("[]");
  const Vehicle vehicle;
  const Dive dive = makeDive("rich", 3, kOrdinaryPanel_odom);
  DopplerLog with(vehicle, sealed, dive, kFloorDepth_m), without(vehicle, clean, dive, kFloorDepth_m);
  int outliers = 0;
  for (int i = 0; i < 4000; ++i) {
    const double off_m_s = (*with.read(i / 10.0).velocity_dvl - *without.read(i / 10.0).velocity_dvl).norm();
    if (off_m_s == 0) continue;
    ++outliers;
    EXPECT_GE(off_m_s, 0.1 - 1e-9);
    EXPECT_LE(off_m_s, 0.5 + 1e-9);
  }
  EXPECT_NEAR(outliers, 120, 40);
}

TEST(SealedArm, IsThereForItsFractionOfTheTime) {
  const SealedCase sealed = caseWith("[]", R"([{"kind": "manipulator", "size": 0.4}])");
  const Vehicle vehicle;
  int there = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto arm = armAt(sealed, vehicle, i * 0.2);
    if (!arm) continue;
    ++there;
    EXPECT_TRUE(arm->hides(1.5 * arm->tip_camera));
    EXPECT_FALSE(arm->hides(0.5 * arm->tip_camera));
    EXPECT_FALSE(arm->hides({-0.5, -0.5, 2}));
  }
  EXPECT_EQ(there, 400);
}

TEST(SealedCloud, ItsDepthIsTheIntegralOfItsAttenuation) {
  const MurkyCloud cloud{1.5, 0.4, {0.1, -0.2, 1.3}};
  const Vector3d from(0.01, 0, 0), to(0.3, 0.1, 2.2);
  double sum = 0;
  constexpr int kSteps = 1000;
  for (int i = 0; i < kSteps; ++i) {
    const Vector3d at = from + (i + 0.5) / kSteps * (to - from);
    const double off_m2 = (at - cloud.middle_camera).squaredNorm();
    sum += cloud.peak_per_m * std::exp(-off_m2 / (2 * cloud.sigma_m * cloud.sigma_m)) * (to - from).norm() /
           kSteps;
  }
  EXPECT_NEAR(cloud.opticalDepth(from, to), sum, 1e-5);
}

TEST_F(SealedWorld, OrdinaryMovesCornersByLessThanTheyAreMeasuredBy) {
  const CornerPixels plain = cornersOf(caseWith("[]")), ordinary = cornersOf(caseWith("[]", "[]", 1));
  std::vector<double> moved_px;
  for (const auto& [name, corners] : plain)
    if (const auto found = ordinary.find(name); found != ordinary.end())
      for (std::size_t i = 0; i < 8; ++i) moved_px.push_back(std::abs(found->second[i] - corners[i]));
  std::sort(moved_px.begin(), moved_px.end());
  EXPECT_GT(moved_px[moved_px.size() / 2], 0.02);
  EXPECT_LT(moved_px[moved_px.size() / 2], 0.6);
  EXPECT_GT(moved_px.back(), 1);  // an outlier
}

}  // namespace
}  // namespace fathom::sealed
