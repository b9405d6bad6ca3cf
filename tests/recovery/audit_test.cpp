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

// One stamp that is far ahead says nothing of the other sensors' clocks, and is no reason to refuse a
// recording.
TEST(Audit, AStampFarAheadIsOneStamp) {
  const Vehicle vehicle = test::randomVehicle(3);
  std::vector<Sample> samples = test::randomDive(vehicle, 3);
  const auto ins = std::find_if(samples.begin() + 500, samples.end(),
                                [](const Sample& sample) { return sample.label == labels::kIns; });
  ASSERT_NE(ins, samples.end());
  ins->time = after(ins->time, 86'400.0);
  const std::vector<Finding> findings = auditOf(samples, vehicle);
  ASSERT_EQ(findings.size(), 1u) << textOf(findings);
  EXPECT_EQ(findings.front().name, "stamps-ahead:INS");
  EXPECT_EQ(findings.front().certainty, Finding::Certainty::likely);
}

INSTANTIATE_TEST_SUITE_P(Audit, Faulty, testing::Range(1, test::kSanitized ? 2 : 9));

}  // namespace
}  // namespace fathom
