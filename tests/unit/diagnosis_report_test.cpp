// What a diagnosis writes, for a diagnosis made by hand.
#include "reports/diagnosis_report.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

#include "core/files.h"
#include "effects/calibration.h"
#include "effects/catalogue.h"
#include "reports/diagnosis_json.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

template <class Effect>
EffectEstimate estimateOf(std::size_t i, double value, double sigma) {
  return {kEffectIndex<Effect>, kEffectOffsets[kEffectIndex<Effect>] + i, value, sigma};
}

Mismatch dvlAgainstSpeed(double size_sigma, double p) {
  Mismatch m;
  m.channel = kChannel<Dvl>;
  m.direction = "x";
  m.statistic = "mean residual";
  m.against = "speed";
  m.unit = "m/s";
  m.size_sigma = size_sigma;
  m.size_raw = 0.012;
  m.raw_unit = "m/s";
  m.dof = 3;
  m.p_value = p;
  m.log_p = std::log(p);
  m.where = "0.4 to 0.5 m/s";
  m.material = size_sigma > 3;
  for (int i = 0; i < 4; ++i) m.bins.push_back({0.1 * i, 0.1 * (i + 1), "", 30, 0.003 * i, 0.001, 0.5 * i});
  return m;
}

HeldOut heldOutDvl() {
  HeldOut h;
  h.channel = kChannel<Dvl>;
  h.metric = "dvl_rms_m_s";
  h.before = 0.021;
  h.after = 0.0102;
  h.after_ci95 = {0.0099, 0.0105};
  h.black_box = 0.0104;
  h.noise_floor = 0.0101;
  h.blocks = {{0, 30, 0.02, 0.01, 0.011}, {35, 65, 0.022, 0.0104, 0.0098}};
  return h;
}

FoundEffect markerMoved() {
  FoundEffect found;
  found.candidate = {
      .effect = kEffectIndex<MarkerMoved>, .marker_id = 14, .time_s = {}, .peak = {}, .active_s = {}};
  found.estimates = {estimateOf<MarkerMoved>(1, 0.021, 0.0004), estimateOf<MarkerMoved>(2, -0.001, 0.0004),
                     estimateOf<MarkerMoved>(3, 0.0, 0.002), estimateOf<MarkerMoved>(4, 1.5, 0.3)};
  found.sqrt_lambda = 25;
  found.confidence = 0.97;
  found.log_likelihood_gain = 315;
  found.bic_gain = 590;
  found.heldout_log_likelihood_gain = 310;
  found.interactions = {{.against = "time", .statistic = 2, .log_p = -0.7, .relative_change = 0.1}};
  return found;
}

FoundEffect currentForAWhile() {
  FoundEffect found;
  found.candidate = {
      .effect = kEffectIndex<WaterCurrent>, .marker_id = {}, .time_s = {}, .peak = {}, .active_s = {30, 1e9}};
  for (std::size_t i = 0; i < 3; ++i)
    found.estimates.push_back(estimateOf<WaterCurrent>(i, 0.1 * static_cast<double>(i + 1), 0.01));
  found.sqrt_lambda = 9;
  return found;
}

FoundEffect panelMoved() {
  FoundEffect found;
  found.candidate = {
      .effect = kEffectIndex<PanelMoved>, .marker_id = {}, .time_s = 73.25, .peak = {}, .active_s = {}};
  for (std::size_t i = 1; i < 7; ++i) found.estimates.push_back(estimateOf<PanelMoved>(i, 0.05, 0.01));
  return found;
}

/// With the parameters of what was found, as the engine leaves them.
EffectParameters<double> calibrationOf(const std::vector<FoundEffect>& effects) {
  EffectParameters<double> calibration;
  for (const FoundEffect& found : effects) {
    const Candidate& candidate = found.candidate;
    calibration.on.set(candidate.effect);
    calibration.active_s[candidate.effect] = candidate.active_s;
    const std::size_t first = kEffectOffsets[candidate.effect];
    if (candidate.marker_id) calibration.values[first] = *candidate.marker_id;
    if (candidate.time_s) calibration.values[first] = *candidate.time_s;
    for (const EffectEstimate& e : found.estimates) calibration.values[e.scalar] = e.value;
  }
  return calibration;
}

DiagnosisStory storyOf(Verdict verdict, std::vector<FoundEffect> effects = {}) {
  DiagnosisStory story;
  story.run = {.command_line = "fathom diagnose dive.rawlog --out out", .seed = 1};
  story.recording = "dive.rawlog";
  story.folder = "out";
  story.read.files = {{"dive.rawlog", "0123456789abcdef"}};
  story.read.vehicle = "rov.yaml";
  story.read.input.data.first_s = 0.5;
  story.read.input.data.last_s = 180;
  story.read.input.data.of<Dvl>().resize(1);
  Diagnosis& d = story.diagnosis;
  d.verdict = verdict;
  d.why = "Because.";
  d.calibration = d.after.state.effects = calibrationOf(effects);
  d.effects = std::move(effects);
  return story;
}

DiagnosisStory explainedStory() {
  DiagnosisStory story = storyOf(Verdict::explained, {markerMoved()});
  Diagnosis& d = story.diagnosis;
  d.mismatch = {dvlAgainstSpeed(9.1, 1e-12), dvlAgainstSpeed(1.2, 0.6)};
  d.remaining = {dvlAgainstSpeed(1.1, 0.7)};
  d.heldout.channels = {heldOutDvl()};
  d.alternatives = {{.candidates = {d.effects[0].candidate, {kEffectIndex<MarkerSize>, {}, {}, {}, {}}},
                     .log_odds = {0, -1},
                     .alignment = {1, 0.99},
                     .advice = {"turn on the spot", 3, 31, 7, 0.5}}};
  TestedCandidate tested;
  tested.candidate = d.effects[0].candidate;
  tested.statistic = 620;
  tested.dof = 4;
  tested.log_p = -300;
  tested.log_evidence = 290;
  tested.one_step = d.effects[0].estimates;
  d.tested = {tested};
  d.noise.channels[indexOf(kChannel<Dvl>)].rows = 300;
  return story;
}

/// As a stranger reads it.
nlohmann::json written(const DiagnosisStory& story) {
  return nlohmann::json::parse(toJson(story).dump())["diagnosis"];
}

std::set<std::string> keysOf(const nlohmann::json& json) {
  std::set<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.insert(key);
  return keys;
}

void expectKeys(const nlohmann::json& json, const std::set<std::string>& wanted) {
  const std::set<std::string> keys = keysOf(json);
  for (const std::string& key : wanted) EXPECT_TRUE(keys.count(key)) << key << " in " << json.dump();
}

const std::set<std::string> kHeldOutKeys{"metric",     "before",    "after",
                                         "after_ci95", "black_box", "noise_floor"};

TEST(DiagnosisReport, EveryVerdictHasTheContractsKeys) {
  const std::pair<Verdict, const char*> verdicts[] = {{Verdict::none, "none"},
                                                      {Verdict::explained, "explained"},
                                                      {Verdict::unexplained, "unexplained"},
                                                      {Verdict::insufficient, "insufficient"}};
  for (const auto& [verdict, name] : verdicts) {
    const auto json = written(storyOf(verdict));
    expectKeys(json, {"verdict", "mismatch", "effects", "alternatives", "heldout"});
    EXPECT_EQ(json["verdict"], name);
    for (const char* list : {"mismatch", "effects", "alternatives"}) {
      EXPECT_TRUE(json[list].is_array()) << list;
      EXPECT_TRUE(json[list].empty()) << list;
    }
    expectKeys(json["heldout"], kHeldOutKeys);
    EXPECT_TRUE(json["heldout"]["before"].is_null()) << "nothing was held out";
  }
}

TEST(DiagnosisReport, AMismatchThatIsChanceIsOnTheMapOnly) {
  const auto json = written(explainedStory());
  ASSERT_EQ(json["mismatch"].size(), 1u);
  EXPECT_EQ(json["mismatch_map"].size(), 2u);
  const auto& mismatch = json["mismatch"][0];
  EXPECT_EQ(mismatch["channel"], "DVL");
  EXPECT_EQ(mismatch["sensor"], "dvl x");
  EXPECT_EQ(mismatch["statistic"], "mean residual");
  EXPECT_EQ(mismatch["against"], "speed");
  EXPECT_EQ(mismatch["size_sigma"], 9.1);
  EXPECT_EQ(mismatch["p_value"], 1e-12);
  EXPECT_EQ(mismatch["when_s"], nlohmann::json({0.5, 180.0})) << "all of the recording";
  EXPECT_EQ(mismatch["where"], "0.4 to 0.5 m/s");
}

TEST(DiagnosisReport, AnEffectHasItsParametersByName) {
  const auto effect = written(explainedStory())["effects"][0];
  EXPECT_EQ(effect["id"], "marker-moved");
  EXPECT_EQ(keysOf(effect["parameters"]), (std::set<std::string>{"marker_id", "offset_m", "rotation_deg"}));
  EXPECT_TRUE(effect["parameters"]["marker_id"].is_number_integer());
  EXPECT_EQ(effect["parameters"]["marker_id"], 14);
  EXPECT_EQ(effect["parameters"]["offset_m"], nlohmann::json({0.021, -0.001, 0.0}));
  EXPECT_EQ(effect["parameters"]["rotation_deg"], 1.5);
  EXPECT_EQ(keysOf(effect["sigma"]), (std::set<std::string>{"offset_m", "rotation_deg"}));
  EXPECT_EQ(effect["sigma"]["offset_m"], nlohmann::json({0.0004, 0.0004, 0.002}));
  EXPECT_TRUE(effect["active_s"].is_null());
  EXPECT_EQ(effect["sqrt_lambda"], 25);
  EXPECT_EQ(effect["confidence"], 0.97);
  EXPECT_EQ(effect["evidence"]["heldout_log_likelihood_gain"], 310);
  EXPECT_EQ(effect["evidence"]["bic_gain"], 590);
  EXPECT_EQ(effect["interactions"][0]["against"], "time");
}

TEST(DiagnosisReport, AnIntervalEndsWhereTheRecordingDoes) {
  const auto effect = written(storyOf(Verdict::explained, {currentForAWhile()}))["effects"][0];
  EXPECT_EQ(effect["active_s"], nlohmann::json({30.0, 180.0}));
  EXPECT_EQ(effect["parameters"]["current_m_s"].size(), 3u);
}

TEST(DiagnosisReport, AStepHasItsTime) {
  const auto effect = written(storyOf(Verdict::explained, {panelMoved()}))["effects"][0];
  EXPECT_EQ(effect["parameters"]["time_s"], 73.25);
  EXPECT_EQ(effect["parameters"]["offset_m"].size(), 3u);
  EXPECT_FALSE(effect["sigma"].contains("time_s"));
}

TEST(DiagnosisReport, SetsThatCannotBeToldApart) {
  const auto sets = written(explainedStory())["alternatives"];
  ASSERT_EQ(sets.size(), 1u);
  EXPECT_EQ(sets[0]["effects"], nlohmann::json({"marker-moved", "marker-size"}));
  EXPECT_EQ(sets[0]["log_odds"], nlohmann::json({0.0, -1.0}));
  EXPECT_EQ(sets[0]["alignment"], nlohmann::json({1.0, 0.99}));
  EXPECT_EQ(sets[0]["advice"]["manoeuvre"], "turn on the spot");
  EXPECT_EQ(sets[0]["advice"]["minutes"], 3);
  EXPECT_EQ(sets[0]["advice"]["from_s"], 31.0);
  EXPECT_EQ(sets[0]["advice"]["separation"], 7.0);
}

TEST(DiagnosisReport, HeldOutIsTheFirstMetric) {
  const auto json = written(explainedStory());
  const auto& heldout = json["heldout"];
  EXPECT_EQ(keysOf(heldout), kHeldOutKeys);
  EXPECT_EQ(heldout["metric"], "dvl_rms_m_s");
  EXPECT_EQ(heldout["before"], 0.021);
  EXPECT_EQ(heldout["after"], 0.0102);
  EXPECT_EQ(heldout["after_ci95"], nlohmann::json({0.0099, 0.0105}));
  EXPECT_EQ(heldout["black_box"], 0.0104);
  EXPECT_EQ(heldout["noise_floor"], 0.0101);
  EXPECT_EQ(json["heldout_metrics"][0]["blocks"].size(), 2u);
}

TEST(DiagnosisReport, WhatIsNotANumberIsNull) {
  DiagnosisStory story = explainedStory();
  story.diagnosis.heldout.channels[0].black_box = kNothing;
  story.diagnosis.effects[0].estimates[0].sigma = kNothing;
  story.diagnosis.effects[0].sqrt_lambda = std::numeric_limits<double>::infinity();
  story.diagnosis.tested[0].log_p = -std::numeric_limits<double>::infinity();
  const std::string text = toJson(story).dump();
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(text.find("inf"), std::string::npos);
  const auto json = written(story);
  EXPECT_TRUE(json["heldout"]["black_box"].is_null());
  EXPECT_TRUE(json["effects"][0]["sqrt_lambda"].is_null());
  EXPECT_TRUE(json["effects"][0]["sigma"]["offset_m"][0].is_null());
}

TEST(DiagnosisReport, DigitsAsSigmaDeservesThem) {
  EXPECT_EQ(textOf(FoundParameter{"scale_error", "1", {0.0152937}, {0.00041}}), "0.01529 ± 0.00041");
  EXPECT_EQ(textOf(FoundParameter{"offset_m", "m", {0.1, -0.2}, {0.01, 0.02}}),
            "[0.100 ± 0.010, -0.200 ± 0.020] m");
  EXPECT_EQ(textOf(FoundParameter{"marker_id", "1", {14}, {}}), "14");
  EXPECT_EQ(textOf(FoundParameter{"density", "kg/m3", {1234.6}, {250}}), "1235 ± 250 kg/m3");
}

TEST(DiagnosisReport, WritesFilesThatReadBack) {
  DiagnosisStory story = explainedStory();
  story.folder = test::scratchFolder();
  story.diagnosis.effects.push_back(currentForAWhile());
  story.diagnosis.calibration = calibrationOf(story.diagnosis.effects);
  story.rerun = DiagnosisRerun{{{"calibration", "task", "to M [m]"}, {{"as found", "TL5", "0.1 ± 0.1"}}}, {}};
  writeDiagnosis(story);
  const auto back = readCalibration(story.folder / "calibration.yaml");
  EXPECT_EQ(back.values, story.diagnosis.calibration.values);
  EXPECT_EQ(back.on, story.diagnosis.calibration.on);
  EXPECT_EQ(back.active_s, story.diagnosis.calibration.active_s);
  const auto json = nlohmann::json::parse(readTextFile(story.folder / "result.json"));
  EXPECT_EQ(json["diagnosis"]["verdict"], "explained");
  EXPECT_EQ(json["seed"], 1);
  EXPECT_EQ(json["inputs"][0]["fingerprint"], "0123456789abcdef");
  EXPECT_EQ(json["rerun"]["rows"][0][0], "as found");
  EXPECT_TRUE(json["simulate"].get<std::string>().starts_with("fathom simulate --trajectory "));
  const std::string html = readTextFile(story.folder / "report.html");
  for (const char* part :
       {"marker-moved 14", "water-current", "Because.", "0.021", "speed", "0.0102", "0123456789abcdef",
        "What this recording cannot tell apart", "turn on the spot", "as found"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace fathom
