// The batch estimate: seconds for three minutes with an image a second, cost against length, and what one
// more effect costs in the linearization. Prints ratios against the shortest run of the same call.
#include <cstdio>

#include "estimation/linearization.h"
#include "estimation/nuisances.h"
#include "support/batch_runs.h"
#include "support/stopwatch.h"

namespace fathom {
namespace {

using test::seconds;

void run() {
  double shortest_s = 0;
  for (const double duration_s : {90.0, 180.0, 360.0}) {
    const test::BatchRun dive(duration_s);
    BatchInput input;
    BatchEstimate estimate;
    Linearization linear, bare;
    const double input_s = seconds([&] { input = dive.input(); });
    const double estimate_s = seconds([&] { estimate = estimateBatch(input.data, input.start, {}); });
    const auto problem = problemAt(input.data, estimate, {});
    const double bare_s = seconds([&] { bare = linearize(input.data, *problem, false); });
    const double linear_s = seconds([&] { linear = linearize(input.data, *problem); });
    const double project_s =
        seconds([&] { Nuisances(linear.J).reduce(linear.C.sparseView(), linear.residual); });
    if (shortest_s == 0) shortest_s = estimate_s;
    std::printf(
        "%4.0f s, %zu markers, %zu rows, %zu unknowns: filter and data %.2f s, estimate %.2f s (%d steps; "
        "%.2f "
        "of the shortest), linearization %.2f s, of that an effect %.2f %%, projection %.2f s\n",
        duration_s, input.data.markers.size(), estimate.rows, estimate.unknowns, input_s, estimate_s,
        estimate.iterations, estimate_s / shortest_s, linear_s,
        100.0 * (linear_s - bare_s) / linear_s / static_cast<double>(kEffectCount), project_s);
  }
}

}  // namespace
}  // namespace fathom

int main() { fathom::run(); }
