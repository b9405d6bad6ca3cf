// The audit: of recordings with one fault of their streams, whether it is found; of those without, that
// nothing is said.
#include "audit/audit.h"

#include <gtest/gtest.h>

#include "support/faulty_streams.h"
#include "support/sanitized.h"

namespace fathom {
namespace {

std::vector<Finding> auditOf(const std::vector<Sample>& samples, const Vehicle& vehicle) {
  Streams streams;
  for (const Sample& sample : samples) streams.add(sample);
  return audit(streams, vehicle);
}

std::string textOf(const std::vector<Finding>& findings) {
  std::string text;
  for (const Finding& f : findings) text += toText(f) + "\n";
  return text;
}

class Faulty : public testing::TestWithParam<int> {};

TEST_P(Faulty, IsNamedAndCorrected) {
  const auto seed = static_cast<std::uint64_t>(GetParam());
  const Vehicle vehicle = test::randomVehicle(seed);
  const std::vector<Sample> clean = test::randomDive(vehicle, seed);
  EXPECT_TRUE(auditOf(clean, vehicle).empty()) << textOf(auditOf(clean, vehicle));
  for (const test::StreamFault& fault : test::streamFaults(vehicle)) {
    if (fault.name.empty()) continue;
    std::vector<Sample> samples = clean;
    test::addFault(fault, vehicle, seed, samples);
    const std::vector<Finding> findings = auditOf(samples, vehicle);
    EXPECT_TRUE(!findings.empty() && fault.isNamedBy(findings[0])) << fault.name << ": " << textOf(findings);
    if (findings.empty() || findings[0].correction.empty()) continue;
    // Corrected as it is told, the recording is as it was; a faulty attitude may show once the axes are
    // right.
    bool reorders = false;
    for (const Finding& finding : findings) {
      if (finding.correction.empty()) continue;
      const Correction correction = Correction::named(finding.correction);
      for (Sample& sample : samples) correction.apply(sample, vehicle, clean.front().time);
      reorders = reorders || correction.reorders();
    }
    const std::vector<Finding> after = auditOf(samples, vehicle);
    EXPECT_TRUE(after.empty() || reorders) << fault.name << ", corrected: " << textOf(after);
  }
}

INSTANTIATE_TEST_SUITE_P(Audit, Faulty, testing::Range(1, test::kSanitized ? 2 : 9));

}  // namespace
}  // namespace fathom
