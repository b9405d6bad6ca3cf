#pragma once

#include "diagnosis/whitened_model.h"
#include "support/batch_runs.h"

namespace fathom::test {

/// A short run's linear model at its nominal estimate, with the residuals that its noise left.
struct LinearRun {
  explicit LinearRun(double duration_s, std::uint64_t seed = 1) : run(duration_s) {
    run.seed = seed;
    input = run.input();
    estimate = estimateBatch(input.data, input.start, {});
  }
  /// Not weighted.
  Linearization linear() const { return linearize(input.data, *problemAt(input.data, estimate, {})); }
  WhitenedModel model() const { return {linear(), {}}; }

  BatchRun run;
  BatchInput input;
  BatchEstimate estimate;
};

}  // namespace fathom::test
