// The proof's scorer: what answers are worth, on answers made up.
#include <gtest/gtest.h>

#include "proof/proof_report.h"
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

TEST(ProofScore, ComparesTimes) {
  ProofCase c = hiddenBias();
  c.effects[0].id = c.effects[0].name = "water-current";
  c.generator["effects"][0] = {
      {"id", "water-current"}, {"parameters", Json::object()}, {"active_s", {10.0, 40.0}}};
  Json current = found("water-current");
  current["active_s"] = {10.5, 36.0};
  EXPECT_EQ(score(c, answer("explained", {current})).onset_off_s, 4.0);
}

TEST(ProofScore, IsReadAsItWasWritten) {
  Scored scored =
      score(hiddenBias(), answer("explained", {found("gyro-bias")}, {"gyro-bias", "earth-rotation"}));
  scored.gains = Gains{10, 9, 3, 1};
  scored.onset_off_s = 0.5;
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

}  // namespace
}  // namespace fathom::proof
