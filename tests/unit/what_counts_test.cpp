// From where on the diagnosis takes something for more than what readings, panels and light are off by
// anyway.
#include <gtest/gtest.h>

#include "core/random.h"
#include "diagnosis/discovery.h"
#include "sensors/channels.h"
#include "support/batch_runs.h"

namespace fathom {
namespace {

struct Model {
  BatchInput input = test::BatchRun(8.0).input();
  BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  WhitenedModel whitened{linearize(input.data, *problemAt(input.data, estimate, {})), {}, input.data};
};

/// Every reading of one kind moved by so much of its own unit, up or down at random, so that nothing which is
/// estimated follows.
Eigen::VectorXd moved(const Linearization& linear, Channel channel, double size) {
  Random random(1);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(std::ssize(linear.rows));
  for (std::size_t i = 0; i < linear.rows.size(); ++i)
    if (linear.rows[i].channel == channel)
      change[static_cast<Eigen::Index>(i)] =
          (random.uniform() < 0.5 ? -1 : 1) * size * linear.rows[i].per_unit;
  return change;
}

TEST(WhatCounts, CornersThatMoveByMoreThanTheyAreOff) {
  const Model model;
  const auto counts = [&](Channel channel, double size) {
    return isBeyondBias(model.whitened, moved(model.whitened.linear(), channel, size));
  };
  const double off_px = Markers::channel.systematic;
  EXPECT_FALSE(counts(kChannel<Markers>, 0.8 * off_px));
  EXPECT_TRUE(counts(kChannel<Markers>, 1.5 * off_px));  // the path follows a little of it
  EXPECT_TRUE(counts(kChannel<Dvl>, 1e-4));              // of which nothing is known
}

TEST(WhatCounts, LightAndPartsHaveToBeLarger) {
  const auto light = Candidate{.effect = findEffect("gamma")->index};
  const auto other = Candidate{.effect = findEffect("dvl-scale")->index};
  const auto forAPart = [](Candidate effect) {
    effect.active_s = {2, 5};
    return effect;
  };
  EXPECT_LT(discoveryOf(other), discoveryOf(light));
  EXPECT_LT(discoveryOf(other), discoveryOf(forAPart(other)));
  EXPECT_LT(discoveryOf(light), discoveryOf(forAPart(light)));
  EXPECT_EQ(discoveryOf(Refit{.effects = {forAPart(light), other}}), discoveryOf(other));
}

}  // namespace
}  // namespace fathom
