// The proof's scorer: what answers are worth, on answers made up.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "proof/advised.h"
#include "proof/proof_measures.h"
#include "proof/proof_report.h"
#include "proof/real_recordings.h"
#include "proof/score.h"

namespace fathom::proof {
namespace {

using Json = nlohmann::json;

/// Hides a gyro bias that may be taken for the Earth's rotation.
ProofCase hiddenBias() {
  ProofCase c;
  c.name = "gyro-bias-8-0";
  c.kind = ProofCase::Kind::effect;
  c.stratum = 8;
  c.effects = {{"gyro-bias", "gyro-bias", 8, {"earth-rotation"}, 0.1, "earth-rotation"}};
  c.generator["outside"] = Json::array();
  c.generator["effects"] = Json::array(
      {{{"id", "gyro-bias"}, {"parameters", {{"bias_rad_s", {1e-3, 0, -1e-3}}}}, {"active_s", nullptr}}});
  return c;
}

ProofCase nothingHidden() {
  ProofCase c;
  c.name = "null-0";
  c.kind = ProofCase::Kind::null;
  c.generator = {{"effects", Json::array()}, {"outside", Json::array()}};
  return c;
}

Json found(const std::string& id, const Json& parameters = Json::object(),
           const Json& sigma = Json::object()) {
  return {{"id", id},       {"name", id},          {"parameters", parameters},
          {"sigma", sigma}, {"active_s", nullptr}, {"confidence", 0.9}};
}

Json answer(const std::string& verdict, const std::vector<Json>& effects = {},
            const std::vector<std::string>& set = {}) {
  Json candidates = Json::array();
  for (const std::string& id : set) candidates.push_back({{"id", id}, {"name", id}, {"marker_id", nullptr}});
  Json alternatives = Json::array();
  if (!set.empty()) alternatives.push_back({{"candidates", candidates}});
  return {{"diagnosis", {{"verdict", verdict}, {"effects", effects}, {"alternatives", alternatives}}}};
}

std::string outcomeOf(const ProofCase& c, const Json& of) {
  return kOutcomes[static_cast<std::size_t>(score(c, of).outcome)];
}

TEST(ProofScore, NamesAreRightOrWrong) {
  EXPECT_EQ(outcomeOf(hiddenBias(), answer("explained", {found("gyro-bias")})), "right");
  EXPECT_EQ(outcomeOf(hiddenBias(), answer("explained", {found("gyro-scale")})), "wrong");
  EXPECT_EQ(outcomeOf(hiddenBias(), answer("explained", {found("gyro-bias"), found("dvl-scale")})),
            "also others");
  EXPECT_EQ(outcomeOf(hiddenBias(), answer("none")), "none");
  EXPECT_EQ(outcomeOf(hiddenBias(), answer("unexplained")), "unexplained");
  EXPECT_EQ(outcomeOf(nothingHidden(), answer("explained", {found("gyro-bias")})), "wrong");
}

TEST(ProofScore, ASetIsRightWhereItsMembersCannotBeToldApart) {
  const auto setOf = [](const std::string& first, const std::string& other) {
    return answer("explained", {found(first)}, {first, other});
  };
  EXPECT_EQ(outcomeOf(hiddenBias(), setOf("gyro-bias", "earth-rotation")), "right set");
  EXPECT_EQ(outcomeOf(hiddenBias(), setOf("earth-rotation", "gyro-bias")), "right set");
  EXPECT_EQ(outcomeOf(hiddenBias(), setOf("gyro-bias", "gyro-scale")), "needless set");
  EXPECT_EQ(outcomeOf(hiddenBias(), setOf("earth-rotation", "gyro-scale")), "wrong");
  const Scored second = score(hiddenBias(), setOf("earth-rotation", "gyro-bias"));
  EXPECT_TRUE(second.in_set);
  EXPECT_FALSE(second.first_right);
  EXPECT_EQ(second.set_size, 2);
}

TEST(ProofScore, AMarkerIsPartOfTheName) {
  ProofCase c = hiddenBias();
  c.effects[0] = {"marker-moved", "marker-moved 14", 8, {}, 60, "marker-size"};
  c.generator["effects"][0] = {
      {"id", "marker-moved"}, {"parameters", {{"marker_id", 14}}}, {"active_s", nullptr}};
  EXPECT_EQ(outcomeOf(c, answer("explained", {found("marker-moved", {{"marker_id", 14}})})), "right");
  EXPECT_EQ(outcomeOf(c, answer("explained", {found("marker-moved", {{"marker_id", 15}})})), "wrong");
}

TEST(ProofScore, OneOfTwoIsHalf) {
  ProofCase pair = hiddenBias();
  pair.kind = ProofCase::Kind::pair;
  pair.effects.push_back({"dvl-scale", "dvl-scale", 12, {}, 100, "dvl-misalignment"});
  pair.generator["effects"].push_back(
      {{"id", "dvl-scale"}, {"parameters", {{"scale_error", 0.02}}}, {"active_s", nullptr}});
  EXPECT_EQ(outcomeOf(pair, answer("explained", {found("gyro-bias")})), "half");
  EXPECT_EQ(outcomeOf(pair, answer("explained", {found("dvl-scale"), found("gyro-bias")})), "right");
}

TEST(ProofScore, CountsIntervalsThatCover) {
  const Json bias =
      found("gyro-bias", {{"bias_rad_s", {1.1e-3, 0.3e-3, -1e-3}}}, {{"bias_rad_s", {1e-4, 1e-4, 1e-4}}});
  const Scored scored = score(hiddenBias(), answer("explained", {bias}));
  EXPECT_EQ(scored.scalars, 3);
  EXPECT_EQ(scored.covered, 2);  // the second is three sigmas off
}

/// Hides a scale error of the DVL in 80 s, on from 10 to 40 s where nothing else is said.
ProofCase hiddenFor(const Json& active_s, const Json& parameters = {{"scale_error", 0.02}}) {
  ProofCase c = hiddenBias();
  c.kind = ProofCase::Kind::interval;
  c.effects[0].id = c.effects[0].name = "dvl-scale";
  c.generator["dive"] = {{"duration_s", 80}};
  c.generator["effects"][0] = {{"id", "dvl-scale"}, {"parameters", parameters}, {"active_s", active_s}};
  return c;
}
Json foundFor(const Json& active_s, const Json& parameters = Json::object()) {
  Json scale = found("dvl-scale", parameters);
  scale["active_s"] = active_s;
  return answer("explained", {scale});
}

TEST(ProofScore, ComparesOnsetAndEnd) {
  const Scored scored = score(hiddenFor({10.0, 40.0}), foundFor({10.5, 36.0}));
  EXPECT_EQ(scored.onset_off_s, 0.5);
  EXPECT_EQ(scored.end_off_s, 4.0);
}

TEST(ProofScore, SaysHowFarParametersAreOff) {
  const Json scale = found("dvl-scale", {{"scale_error", 0.021}}, {{"scale_error", 0.002}});
  const Scored scored = score(hiddenFor(nullptr), answer("explained", {scale}));
  ASSERT_TRUE(scored.parameters_off);
  EXPECT_NEAR(*scored.parameters_off, 0.05, 1e-12);  // 0.021 for 0.02
  EXPECT_FALSE(score(hiddenFor(nullptr), answer("none")).parameters_off);
}

TEST(ProofScore, TakesWhatWasHeldOutFromTheAnswer) {
  Json with = answer("explained", {found("gyro-bias")});
  with["diagnosis"]["heldout_log_likelihood_gain"] = {{"physics", 30.0},
                                                      {"physics_ci95", {20.0, 40.0}},
                                                      {"black_box", 12.0},
                                                      {"over_black_box_ci95", {5.0, 31.0}},
                                                      {"placebo", 8.0}};
  const Scored scored = score(hiddenBias(), with);
  ASSERT_TRUE(scored.own);
  EXPECT_EQ(scored.own->over_black_box, 5);
  EXPECT_EQ(scored.own->placebo, 8);
  EXPECT_FALSE(score(hiddenBias(), answer("explained", {found("gyro-bias")})).own);
}

// What is always on begins with the recording and ends with it, and an interval that outlasts it too.
TEST(ProofScore, AlwaysIsFromBeginningToEnd) {
  const Scored always = score(hiddenFor({10.0, 80.0}), foundFor(nullptr));
  EXPECT_EQ(always.onset_off_s, 10.0);
  EXPECT_EQ(always.end_off_s, 0.0);
  EXPECT_EQ(score(hiddenFor({10.0, 80.0}), foundFor({10.0, 1e9})).end_off_s, 0.0);
  EXPECT_FALSE(score(hiddenFor(nullptr), foundFor({3.0, 60.0})).onset_off_s);
}

TEST(ProofScore, AStepHasATimeAndNoEnd) {
  const Scored scored = score(hiddenFor(nullptr, {{"time_s", 30.0}}), foundFor(nullptr, {{"time_s", 31.5}}));
  EXPECT_EQ(scored.onset_off_s, 1.5);
  EXPECT_FALSE(scored.end_off_s);
}

TEST(ProofScore, KnowsWhetherWhatTemptsIsInTheSet) {
  const auto rivalIn = [](const std::vector<std::string>& set) {
    return score(hiddenBias(), answer("explained", {found(set[0])}, set)).rival_in_set;
  };
  EXPECT_TRUE(rivalIn({"gyro-bias", "earth-rotation"}));
  EXPECT_TRUE(rivalIn({"earth-rotation", "gyro-scale"}));
  EXPECT_FALSE(rivalIn({"gyro-bias", "gyro-scale"}));
}

/// The set that a gyro bias was not told from, and what would tell.
Json advisedAnswer() {
  Json set = answer("explained", {found("gyro-bias")}, {"gyro-bias", "earth-rotation"});
  set["diagnosis"]["alternatives"][0]["advice"] = {
      {"manoeuvre", "hold station"}, {"minutes", 2}, {"from_s", 12.5}};
  return set;
}

TEST(ProofScore, ASetWithTheTruthThatLastsIsDrivenAgain) {
  const auto adviceFor = [](const ProofCase& c) {
    return adviceIn(score(c, advisedAnswer()), advisedAnswer());
  };
  const std::optional<Advised> advised = adviceFor(hiddenBias());
  ASSERT_TRUE(advised);
  EXPECT_EQ(advised->manoeuvre, "hold station");
  EXPECT_EQ(advised->minutes, 2);
  EXPECT_EQ(advised->from_s, 12.5);
  EXPECT_FALSE(adviceFor(hiddenFor(nullptr)));  // that was wrong
  ProofCase timed = hiddenBias();
  timed.generator["dive"] = {{"duration_s", 80}};
  timed.generator["effects"][0]["active_s"] = {10.0, 40.0};
  EXPECT_FALSE(adviceFor(timed));
  Json without = advisedAnswer();
  without["diagnosis"]["alternatives"][0]["advice"] = nullptr;
  EXPECT_FALSE(adviceIn(score(hiddenBias(), without), without));
}

TEST(ProofScore, IsReadAsItWasWritten) {
  Scored scored =
      score(hiddenBias(), answer("explained", {found("gyro-bias")}, {"gyro-bias", "earth-rotation"}));
  scored.own = OwnStretches{30, 12, 5, 8};
  scored.parameters_off = 0.05;
  scored.gains = Gains{10, 9, 3, 1};
  scored.onset_off_s = 0.5;
  scored.advised = Advised{"hold station", 2, 12.5, Outcome::right, {"gyro-bias"}, ""};
  EXPECT_EQ(toJson(scoredOf(toJson(scored))).dump(), toJson(scored).dump());
}

TEST(ProofReport, SaysOfHowMany) {
  std::vector<Scored> all;
  for (int i = 0; i < 49; ++i) all.push_back(score(nothingHidden(), answer("none")));
  all.push_back(score(nothingHidden(), answer("explained", {found("gyro-bias")})));
  const Table table = measureTable(all);
  EXPECT_EQ(table.rows[0][2], "2.0 % (1 of 50; 0 to 10 %)");  // Wilson's interval: 0.35 to 10.5 %
  EXPECT_EQ(confusionTable(all).rows.size(), 1u);
}

TEST(ProofReport, CountsWhatEffectsWereTakenFor) {
  const Table table = namesTable({score(hiddenBias(), answer("explained", {found("gyro-bias")})),
                                  score(hiddenBias(), answer("explained", {found("gyro-scale")})),
                                  score(hiddenBias(), answer("explained", {found("gyro-scale")})),
                                  score(hiddenBias(), answer("none"))});
  ASSERT_EQ(table.rows.size(), 1u);
  EXPECT_EQ(table.rows[0], (std::vector<std::string>{"gyro-bias", "4", "1", "2 gyro-scale; 1 none"}));
}

// A share of what the truth gains: 0.5, 0.9 and 0.7 more than a black box.
TEST(ProofReport, GainOverABlackBoxHasAnInterval) {
  std::vector<Scored> all;
  for (const double black_box : {50.0, 10.0, 30.0}) {
    all.push_back(score(hiddenBias(), answer("explained", {found("gyro-bias")})));
    all.back().gains = Gains{100, 100, 3, black_box};
  }
  for (const auto& row : measureTable(all).rows)
    if (row[0].find("over a black box") != std::string::npos)
      EXPECT_EQ(row[2], "70.0 % (50.0 to 90.0 %; 3 recordings)");  // all three alike: once in 27 draws
}

/// A decoy that cannot be told from the Earth's rotation, answered so.
Scored answeredDecoy(const Json& answer) {
  ProofCase c = hiddenBias();
  c.kind = ProofCase::Kind::decoy;
  return score(c, answer);
}

TEST(ProofReport, CountsWhatDecoysTempted) {
  const std::vector<Scored> all{
      answeredDecoy(answer("explained", {found("gyro-bias")}, {"gyro-bias", "earth-rotation"})),
      answeredDecoy(answer("explained", {found("gyro-bias")})),
      answeredDecoy(answer("explained", {found("earth-rotation")})), answeredDecoy(answer("unexplained"))};
  const auto reached = [&, table = measureTable(all)](const std::string& measure) {
    for (const auto& row : table.rows)
      if (row[0] == measure) return row[2].substr(row[2].find('('), 7);
    return std::string("no such row");
  };
  EXPECT_EQ(reached("decoys: truth in the stated set"), "(2 of 4");
  EXPECT_EQ(reached("decoys: a set with both where it has to be one"), "(1 of 4");
  EXPECT_EQ(reached("decoys: a confident wrong name"), "(1 of 4");
  EXPECT_EQ(decoyTable(all).rows.size(), 4u);
}

TEST(ProofReport, RealRecordingsAreShownAndNotJudged) {
  const Json heldout{{"metric", "reprojection_rms_px"}, {"before", 4.46},    {"after", 0.24},
                     {"after_ci95", {0.2, 0.3}},        {"black_box", 4.04}, {"noise_floor", 0.11}};
  const Json effect = found("flat-port-refraction", {{"slab_m", 0.243}}, {{"slab_m", 0.007}});
  const Table table = realTable({{{"name", "tank"},
                                  {"what", "boards"},
                                  {"failure", ""},
                                  {"verdict", "unexplained"},
                                  {"effects", {effect}},
                                  {"heldout", heldout}},
                                 {{"name", "dome"}, {"what", "boards"}, {"failure", "no such file"}}});
  ASSERT_EQ(table.rows.size(), 2u);
  EXPECT_EQ(table.rows[0][2], "flat-port-refraction: slab_m 0.243 ± 0.007");
  EXPECT_EQ(table.rows[0][6], "(0.2, 0.3)");
  EXPECT_EQ(table.rows[1][2], "no such file");
}

}  // namespace
}  // namespace fathom::proof
