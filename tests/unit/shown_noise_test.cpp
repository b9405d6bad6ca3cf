#include "diagnosis/shown_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/candidate.h"
#include "effects/catalogue.h"
#include "support/linear_run.h"

namespace fathom {
namespace {

/// Weights as a robust fit has them that ended at these residuals.
void takeRobustWeights(Linearization& linear) {
  for (std::size_t first = 0, behind = 0; first < linear.rows.size(); first = behind) {
    while (behind < linear.rows.size() && linear.rows[behind].reading == linear.rows[first].reading) ++behind;
    const double norm =
        linear.residual.segment(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(behind - first))
            .norm();
    for (std::size_t i = first; i < behind; ++i)
      linear.rows[i].robust_weight = huberWeight(norm, linear.rows[i].robust_threshold);
  }
  applyRobustWeights(linear);
}

ChannelNoise shownOfMarkers(Linearization linear) {
  takeRobustWeights(linear);
  NoiseModel stated;
  return shownNoise(linear, stated, 1).of(kChannel<Markers>);
}

double markersNoise(const Linearization& linear) { return shownOfMarkers(linear).scale; }

// Where the panel is not the map's every corner is far off and counts as an outlier for it, whose square has
// little weight: taken at that, there would be a fraction of the noise. Explained, they are no outliers. The
// truth is the noise without the stretch.
TEST(ShownNoise, OfCornersIsNotLessWhereAllAreFarOff) {
  const Linearization linear = test::LinearRun(15.0).linear();
  const double plain = markersNoise(linear);
  Linearization stretched = linear;
  for (std::size_t c = 0; c < linear.columns.size(); ++c)
    if (linear.columns[c].effect == kEffectIndex<PanelShape>) {
      const Eigen::VectorXd change = linear.C.col(static_cast<Eigen::Index>(c));
      constexpr double kSigmas = 30;  // of a reading, root mean square
      std::size_t markers = 0;
      for (const RowInfo& row : linear.rows) markers += row.channel == kChannel<Markers>;
      stretched.residual += change * (kSigmas * std::sqrt(static_cast<double>(markers)) / change.norm());
      break;
    }
  EXPECT_NEAR(markersNoise(stretched) / plain, 1, 0.05);
}

/// One marker of so many, in a corner, by so many sigmas.
Linearization withOutliers(Linearization linear, std::size_t every, double sigmas) {
  std::size_t marker = 0;
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == kChannel<Markers> && linear.rows[i].component == 0 && marker++ % every == 0)
      linear.residual[static_cast<Eigen::Index>(i)] += sigmas;
  return linear;
}

// As a robust fit counts them outliers are as large as its threshold k, whatever they are: of a share e of
// readings, of which n values are left free each, s^2 = (1 - e) / (1 - e k^2 / n). By their squares, weighted
// by k / |r|, it would be 1.7 times as much of 30 sigma, and an effect would seem so much less sure.
TEST(ShownNoise, OfAFewOutliersIsHardlyMore) {
  const Linearization linear = test::LinearRun(15.0).linear();
  const double plain = markersNoise(linear);
  constexpr double kShare = 1.0 / 20, kRows = 8;
  const auto marker = std::find_if(linear.rows.begin(), linear.rows.end(),
                                   [](const RowInfo& row) { return row.channel == kChannel<Markers>; });
  const double k2 = marker->robust_threshold * marker->robust_threshold;
  const ChannelNoise shown = shownOfMarkers(withOutliers(linear, 20, 30));
  const double free = kRows * shown.freedom / static_cast<double>(shown.rows);
  const double expected = std::sqrt((1 - kShare) / (1 - kShare * k2 / free));
  // They also pull on what is estimated, by which others are off.
  EXPECT_NEAR(shown.scale / plain, expected, 0.06);
  EXPECT_NEAR(markersNoise(withOutliers(linear, 20, 300)) / shown.scale, 1, 0.01);
}

// Where no reading is as good as stated none of them is an outlier.
TEST(ShownNoise, OfReadingsThatAreAllWorseIsAllOfIt) {
  Linearization linear = test::LinearRun(15.0).linear();
  const double plain = markersNoise(linear);
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == kChannel<Markers>) linear.residual[static_cast<Eigen::Index>(i)] *= 50;
  EXPECT_NEAR(markersNoise(linear) / plain, 50, 0.1 * 50);
}

}  // namespace
}  // namespace fathom
