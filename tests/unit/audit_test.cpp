// Corrections by name, and what a user says of findings. What is found of which fault:
// recovery/audit_test.cpp.
#include "audit/audit.h"

#include <gtest/gtest.h>

#include "audit/corrected_samples.h"
#include "core/error.h"
#include "support/streams.h"

namespace fathom {
namespace {

std::string whyNot(const std::string& correction) {
  try {
    Correction::named(correction);
    return "";
  } catch (const Error& e) {
    return e.why;
  }
}

TEST(Correction, NamesThatAreNone) {
  EXPECT_NE(whyNot("accelerometer-in-stone").find("there are accelerometer-in-g,"), std::string::npos);
  for (const char* axes :
       {"dvl-axes", "dvl-axes:", "dvl-axes:x,y", "dvl-axes:x,x,z", "dvl-axes:x,-y,-z,x", "dvl-axes:x,-y,w"})
    EXPECT_NE(whyNot(axes).find("must be axes"), std::string::npos) << axes;
  EXPECT_NE(whyNot("gyro-in-degrees:x"), "");
  for (const char* clock : {"clock-rate", "clock-rate:INS", "clock-rate:INS:0", "clock-rate:INS:1.0x"})
    EXPECT_NE(whyNot(clock).find("must be clock-rate"), std::string::npos) << clock;
  EXPECT_EQ(whyNot("accelerometer-in-g.port"), "");
}

TEST(Correction, ConcernsOneInstrumentOnly) {
  const DvlSample entry{{}, Vector3d(100, 200, 300)};
  Sample first{test::kStart, "DVL", entry}, second{test::kStart, "DVL.2", entry};
  const Correction correction = Correction::named("dvl-axes.2:y,-x,z");
  correction.apply(first, {}, test::kStart);
  correction.apply(second, {}, test::kStart);
  EXPECT_EQ(*std::get<DvlSample>(first.reading).velocity_dvl, Vector3d(100, 200, 300));
  EXPECT_EQ(*std::get<DvlSample>(second.reading).velocity_dvl, Vector3d(200, -100, 300));
}

TEST(Correction, TurnsADvlByAnyAngle) {
  Sample sample{test::kStart, "DVL", DvlSample{{}, Vector3d(1, 0, 3)}};
  Correction::named("dvl-turned:30").apply(sample, {}, test::kStart);
  EXPECT_LT((*std::get<DvlSample>(sample.reading).velocity_dvl - Vector3d(std::sqrt(0.75), 0.5, 3)).norm(),
            1e-12);
  for (const char* turned : {"dvl-turned", "dvl-turned:", "dvl-turned:x", "dvl-turned:nan"})
    EXPECT_NE(whyNot(turned).find("must be dvl-turned"), std::string::npos) << turned;
}

/// 10 m of the sheet's water, by each way of writing it.
TEST(Correction, PressuresAreOneAfterwards) {
  Vehicle vehicle;
  const DepthSheet& sheet = vehicle.depth.emplace();
  const double gauge = 10 * sheet.water_density_kg_m3 * vehicle.gravity_m_s2,
               absolute = sheet.atmospheric_pressure_pa + gauge;
  for (const auto& [name, written] :
       std::map<std::string, double>{{"pressure-in-kilopascal", absolute / 1000},
                                     {"pressure-in-millibar", absolute / 100},
                                     {"pressure-in-bar", absolute / 1e5},
                                     {"pressure-gauge", gauge},
                                     {"pressure-is-depth", 10}}) {
    Sample sample{test::kStart, "DEPTH", DepthSample{{}, written, {}}};
    Correction::named(name).apply(sample, vehicle, test::kStart);
    EXPECT_NEAR(std::get<DepthSample>(sample.reading).pressure_pa, absolute, 1e-6) << name;
  }
}

TEST(CorrectedSource, OffsetClocksComeInOrder) {
  std::vector<Sample> samples;
  for (int i = 0; i < 100; ++i) {
    samples.push_back({after(test::kStart, 0.1 * i), "INS", InsSample{}});
    samples.push_back({after(test::kStart, 0.1 * i + 0.05), "DVL", DvlSample{}});
  }
  for (const double offset_s : {-1.5, 1.5}) {
    CorrectedSource source(std::make_unique<test::ListSource>(samples),
                           {Correction::named(print("clock-offset:DVL:%g", offset_s))}, Vehicle{});
    std::size_t count = 0;
    double last_s = -10;
    while (const auto sample = source.next()) {
      const double t_s = secondsBetween(test::kStart, sample->time);
      EXPECT_GE(t_s, last_s);
      last_s = t_s;
      if (sample->label == "DVL" && count == 0) EXPECT_NEAR(t_s, 0.05 + offset_s, 1e-6);
      if (sample->label == "DVL") ++count;
    }
    EXPECT_EQ(count, 100U);
  }
}

/// A clock that is slow by a hundredth, beside one that is right: in the order of the corrected stamps.
TEST(CorrectedSource, StretchedClocksComeInOrder) {
  std::vector<Sample> samples;
  for (int i = 0; i < 200; ++i) {
    samples.push_back({after(test::kStart, 0.1 * i), "DEPTH", DepthSample{}});
    samples.push_back({after(test::kStart, 0.1 * i), "DVL", DvlSample{}});
  }
  for (const double factor : {0.99, 1.01}) {
    const auto source = corrected(std::make_unique<test::ListSource>(samples),
                                  {{}, {"clock-rate:DVL:" + std::to_string(factor)}}, Vehicle{});
    Time before{};
    int count = 0, dvl = 0;
    while (const auto sample = source->next()) {
      EXPECT_GE(sample->time, before);
      before = sample->time;
      ++count;
      if (sample->label == "DVL")
        EXPECT_NEAR(secondsBetween(test::kStart, sample->time), 0.1 * factor * dvl++, 1e-6);
    }
    EXPECT_EQ(count, 400);
  }
}

TEST(RequirePlausible, SureFaultsAreErrorsUnlessAccepted) {
  Finding sure{"gyro-in-degrees", "INS", Finding::Certainty::sure, "it turns", "rad/s", "gyro-in-degrees"};
  Finding likely{"stamps-of-arrival:INS", "INS", Finding::Certainty::likely, "in bundles", "", ""};
  EXPECT_THROW(requirePlausible({likely, sure}, {}, "a.rawlog"), Error);
  const Plausibility accepted = requirePlausible({likely, sure}, {{"gyro-in-degrees"}, {}}, "a.rawlog");
  EXPECT_EQ(accepted.remarks.size(), 2u);
  EXPECT_EQ(accepted.accepted, std::vector<std::string>{"gyro-in-degrees"});
  EXPECT_TRUE(requirePlausible({likely}, {}, "a.rawlog").accepted.empty());
  EXPECT_THROW(requirePlausible({likely}, {{"gyro-in-degrees"}, {}}, "a.rawlog"), Error);
}

}  // namespace
}  // namespace fathom
