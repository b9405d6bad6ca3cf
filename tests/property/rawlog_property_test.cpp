#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "support/recordings.h"
#include "support/shared_data.h"

namespace fathom::test {
namespace {

/// The largest difference of two samples' numbers; infinite where they differ in anything else.
double difference(const Sample& a, const Sample& b) {
  constexpr double kDifferent = std::numeric_limits<double>::infinity();
  if (a.time != b.time || a.label != b.label || a.reading.index() != b.reading.index()) return kDifferent;
  if (imageFiles(a.reading) != imageFiles(b.reading) || intrinsics(a.reading) != intrinsics(b.reading))
    return kDifferent;
  std::vector<std::optional<double>> x, y;
  fieldValues(a.reading, x);
  fieldValues(b.reading, y);
  const auto mounted_a = mountings(a.reading), mounted_b = mountings(b.reading);
  if (x.size() != y.size() || mounted_a.size() != mounted_b.size()) return kDifferent;
  double largest = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (x[i].has_value() != y[i].has_value()) return kDifferent;
    if (x[i]) largest = std::max(largest, std::abs(*x[i] - *y[i]) / std::max(1.0, std::abs(*x[i])));
  }
  for (std::size_t i = 0; i < mounted_a.size(); ++i) {
    largest = std::max(largest, (mounted_a[i].position - mounted_b[i].position).norm());
    largest = std::max(largest, (mounted_a[i].rotation - mounted_b[i].rotation).norm());
  }
  return largest;
}

TEST(RawlogProperty, AnySamplesSurviveTheFile) {
  const auto file = scratchFolder() / "any.rawlog";
  const bool holds = rc::check([&file](std::uint64_t seed, const std::vector<std::uint8_t>& kinds) {
    Random random(seed);
    std::vector<Sample> samples;
    Time time = kStart;
    for (const std::uint8_t kind : kinds) {
      time = after(time, random.uniform(0.0, 2.0));
      samples.push_back(randomSample(kind % kKinds, time, random));
    }
    writeRecording(file, samples);
    const ReadBack back = readRecording(file);
    RC_ASSERT(!back.loss);
    RC_ASSERT(back.samples.size() == samples.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      // DVL ranges and marker directions are floats in MRPT; an attitude goes through a quaternion, whose
      // sign is free; a panel's covariance is inverted twice, and turned to angles and back.
      const std::string& label = samples[i].label;
      const bool floats =
          label == labels::kDvlBeams || label == labels::kMarkerSights || label == Altimeter::label;
      const double tolerance = floats ? 0x1p-23 : label == labels::kPanel ? 1e-8 : 1e-13;
      RC_ASSERT(difference(samples[i], back.samples[i]) < tolerance);
    }
  });
  EXPECT_TRUE(holds);
}

TEST(RawlogProperty, AnyHeaderTextSurvives) {
  const auto file = scratchFolder() / "header.rawlog";
  const bool holds = rc::check([&file](const std::string& text) {
    // Blanks at the ends are not kept, as in any INI file.
    std::string description = "x" + text + "x";
    writeRecording(file, {}, {"", "rov.yaml", description});
    const RecordingHeader header = RawlogReader(file).header();
    RC_ASSERT(header.description == description);
    RC_ASSERT(header.vehicle == "rov.yaml");
    RC_ASSERT(header.panel_map.empty());
  });
  EXPECT_TRUE(holds);
}

}  // namespace
}  // namespace fathom::test
