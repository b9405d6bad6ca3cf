#include "effects/calibration.h"

#include <gtest/gtest.h>

#include <regex>

#include "core/error.h"
#include "core/files.h"
#include "effects/parameter_words.h"
#include "support/random_effects.h"
#include "support/shared_data.h"

// Calibration files, whichever effects there are.
namespace fathom {
namespace {

using test::randomEffects;

TEST(CalibrationFile, CalibrationFileRoundTripIsExact) {
  Random random(4);
  const auto file = test::scratchFolder() / "calibration.yaml";
  for (int round = 0; round < 50; ++round) {
    auto parameters = randomEffects(random);
    for (std::size_t e = 0; e < kEffectCount; ++e) {
      if (random.uniform() < 0.5) parameters.active_s[e] = {random.normal(), 2 + 100 * random.uniform()};
      if (round == 0 || random.uniform() < 0.5) continue;
      parameters.on.reset(e);
      parameters.active_s[e] = {};
      for (std::size_t i = kEffectOffsets[e]; i < kEffectOffsets[e + 1]; ++i) parameters.values[i] = 0;
    }
    writeTextFile(file, formatCalibration(parameters));
    const auto back = readCalibration(file);
    EXPECT_EQ(back.on, parameters.on);
    for (std::size_t i = 0; i < kEffectOffsets[kEffectCount]; ++i)  // a square's root has lost its last digit
      EXPECT_DOUBLE_EQ(asNamed(parameterOf(i), back.values[i]),
                       asNamed(parameterOf(i), parameters.values[i]));
    EXPECT_EQ(back.active_s, parameters.active_s);
    EXPECT_EQ(formatCalibration(back), readTextFile(file));
  }
}

TEST(CalibrationFile, NothingOnRoundTripsToo) {
  const auto file = test::scratchFolder() / "calibration.yaml";
  writeTextFile(file, formatCalibration({}));
  EXPECT_TRUE(readCalibration(file).on.none());
}

Error errorOf(const std::string& text) {
  const auto file = test::scratchFolder() / "calibration.yaml";
  writeTextFile(file, text);
  try {
    readCalibration(file);
  } catch (const Error& error) {
    EXPECT_EQ(error.file, file.string());
    return error;
  }
  ADD_FAILURE() << "accepted: " << text;
  return {"", "", ""};
}

/// So many zeros, but for the last, as a file has them; of a sensor, one that there is.
std::string valueText(const Parameter& p, const std::string& last = "0") {
  if (const auto words = wordsOf(p.kind); !words.empty()) return std::string(words[0]);
  const std::string neutral = p.at_zero > 0 ? "1" : "0";  // it has no zero
  std::string text;
  for (int i = 1; i < p.size; ++i) text += neutral + ", ";
  const std::string end = last == "0" ? neutral : last;
  return p.size == 1 ? end : "[" + text + end + "]";
}

/// An entry with every parameter zero but, where given, one spoilt.
std::string entry(const EffectInfo& effect, const std::string& spoilt = "", const std::string& value = "") {
  std::string text = "\n  - {id: " + std::string(effect.id);
  for (const Parameter& p : effect.parameters)
    text += ", " + std::string(p.name) + ": " + (p.name == spoilt ? value : valueText(p));
  return text + "}";
}

TEST(CalibrationFile, BadCalibrationIsRefused) {
  for (const EffectInfo& effect : allEffects()) {
    EXPECT_EQ(errorOf("effects:" + entry(effect) + entry(effect)).where, "effects[1].id (line 3)");
    EXPECT_EQ(errorOf("effects:\n  - {id: " + std::string(effect.id) + "}").where, "effects[0] (line 2)");
    EXPECT_EQ(errorOf("effects:\n  - {id: " + std::string(effect.id) + "s}").where, "effects[0].id (line 2)");
    for (const Parameter& p : effect.parameters) {
      const std::string name(p.name), where = "effects[0]." + name + " (line 2)";
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, "[0, 0, 0, 0]")).where, where);
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, p.size == 1 ? "[0, 0, 0]" : "0")).where, where);
      if (p.at_zero > 0) EXPECT_EQ(errorOf("effects:" + entry(effect, name, "0")).where, where);
      if (!wordsOf(p.kind).empty()) {
        EXPECT_EQ(errorOf("effects:" + entry(effect, name, "SONAR")).where, where);
        EXPECT_EQ(errorOf("effects:" + entry(effect, name, "1")).where, where);
        continue;
      }
      const std::string beyond = std::to_string(1.001 * p.limit), within = std::to_string(0.999 * p.limit);
      const auto list = [&](const std::string& last) { return valueText(p, last); };
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, list(beyond))).where, where);
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, list(std::to_string(-1.001 * p.limit)))).where,
                where);
      if (p.positive) {
        EXPECT_EQ(errorOf("effects:" + entry(effect, name, list("-1e-6"))).where, where);
      }
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, list(".nan"))).where, where);
      EXPECT_EQ(errorOf("effects:" + entry(effect, name, list("1x"))).where, where);
      const auto file = test::scratchFolder() / "good.yaml";
      writeTextFile(file, "effects:" + entry(effect, name, list(within)));
      EXPECT_NO_THROW(readCalibration(file)) << effect.id;
    }
  }
  EXPECT_NE(errorOf("effects:\n  - {id: dvl-scales, scale_error: 0}").why.find("dvl-scale,"),
            std::string::npos);
  EXPECT_EQ(errorOf("effects:\n  - {id: dvl-scale, scale_error: 0, colour: 1}").where,
            "effects[0].colour (line 2)");
  EXPECT_EQ(errorOf("effect: []\n").why, "missing key `effects`; is `effect` meant for it?");
  for (const char* interval : {"[2, 1]", "[1, 1]", "[1]", "5", "[0, .inf]"})
    EXPECT_EQ(
        errorOf(std::string("effects:\n  - {id: dvl-scale, scale_error: 0, active_s: ") + interval + "}")
            .where,
        "effects[0].active_s (line 2)")
        << interval;
  for (const char* id : {"1.5", "-1"})
    EXPECT_EQ(errorOf(std::string("effects:\n  - {id: marker-moved, offset_m: [0, 0, 0], rotation_deg: 0, "
                                  "marker_id: ") +
                      id + "}")
                  .where,
              "effects[0].marker_id (line 2)")
        << id;
}

TEST(CalibrationFile, OptionalParametersMayBeLeftOut) {
  const auto file = test::scratchFolder() / "calibration.yaml";
  writeTextFile(file,
                "effects:\n  - {id: flat-port-refraction, distance_m: 0.02, glass_m: 0.01, tilt_deg: 1}\n");
  const auto effects = readCalibration(file);
  EXPECT_EQ(effects.of<FlatPortRefraction>()[0], 0.02);
  EXPECT_EQ(effects.of<FlatPortRefraction>()[4], 0);
}

}  // namespace
}  // namespace fathom
