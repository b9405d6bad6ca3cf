// The diagnosis: seconds for three, ten and thirty minutes with an image a second, beside the length, the
// most memory so far, and what one more effect costs: its columns of the linearization and their projection,
// of the whole.
//
//     build/release/tests/diagnosis_bench
#include <sys/resource.h>

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

double mostMemory_mb() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<double>(used.ru_maxrss) / 1024;
}

void measure(const char* what, const std::function<test::DiagnosisRun(const test::BatchRun&)>& make) {
  double first_by_length = 0;
  for (const double duration_s : {180.0, 600.0, 1800.0}) {
    const BatchInput input = make(test::richRun(1, duration_s)).input();
    Diagnosis diagnosis;
    const double took_s = seconds([&] { diagnosis = diagnose(input); });
    const double by_length = took_s / duration_s, memory_mb = mostMemory_mb();
    if (first_by_length == 0) first_by_length = by_length;
    std::printf(
        "%s, %4.0f s, %zu markers: %s in %.1f s (%.2f of the first, each by its length), %.0f MB, of that an "
        "effect %.2f %%\n",
        what, duration_s, input.data.markers.size(), nameOf(diagnosis.verdict).c_str(), took_s,
        by_length / first_by_length, memory_mb, 100.0 * secondsOfAnEffect(input) / took_s);
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
