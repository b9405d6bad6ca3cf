// The diagnosis: seconds for three minutes with an image a second, cost against length, and what one more
// effect costs: its columns of the linearization and their projection, of the whole.
//
//     build/release/tests/diagnosis_bench
#include <cstdio>

#include "diagnosis/diagnosis.h"
#include "support/diagnosis_runs.h"
#include "support/stopwatch.h"

namespace fathom {
namespace {

using test::seconds;

/// Of linearization and projection, a registered effect's part.
double secondsOfAnEffect(const BatchInput& input) {
  const BatchEstimate estimate = estimateBatch(input.data, input.start, {});
  const auto problem = problemAt(input.data, estimate, {});
  Linearization bare, all;
  const double bare_s = seconds([&] { bare = linearize(input.data, *problem, false); });
  const double all_s = seconds([&] { all = linearize(input.data, *problem); });
  const double factor_s = seconds([&] { Nuisances{bare.J}; });
  const double project_s = seconds([&] { Nuisances(all.J).reduce(all.C.sparseView(), all.residual); });
  return (all_s - bare_s + project_s - factor_s) / static_cast<double>(kEffectCount);
}

void measure(const char* what, const std::function<test::DiagnosisRun(const test::BatchRun&)>& make) {
  double shortest_s = 0;
  for (const double duration_s : {90.0, 180.0, 360.0}) {
    const BatchInput input = make(test::richRun(1, duration_s)).input();
    Diagnosis diagnosis;
    const double took_s = seconds([&] { diagnosis = diagnose(input); });
    if (shortest_s == 0) shortest_s = took_s;
    std::printf(
        "%s, %3.0f s, %zu markers: %s in %.1f s%s (%.2f of the shortest), of that an effect %.2f %%\n", what,
        duration_s, input.data.markers.size(), nameOf(diagnosis.verdict).c_str(), took_s,
        duration_s == 180.0 ? " (asked: 30)" : "", took_s / shortest_s,
        100.0 * secondsOfAnEffect(input) / took_s);
  }
}

void run() {
  measure("nothing hidden", [](const test::BatchRun& dive) { return test::plainNull(dive, 1); });
  measure("an effect", [](const test::BatchRun& dive) {
    return test::effectOfSize(dive, test::Excitation(dive), *findEffect("dvl-lever-arm"), 16.0, 1);
  });
}

}  // namespace
}  // namespace fathom

int main() { fathom::run(); }
