#include "diagnosis/shown_noise.h"

#include <gtest/gtest.h>

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

double markersNoise(Linearization linear) {
  takeRobustWeights(linear);
  NoiseModel stated;
  return shownNoise(linear, stated, 1).of(kChannel<Markers>).scale;
}

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

}  // namespace
}  // namespace fathom
