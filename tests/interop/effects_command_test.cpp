// `fathom effects` as its user meets it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "effects/catalogue.h"
#include "support/run_program.h"

namespace fathom {
namespace {

TEST(EffectsCommand, ListsTheWholeCatalogue) {
  const auto table = test::runFathom("effects");
  EXPECT_EQ(table.status, 0) << table.err;
  for (const EffectInfo& effect : allEffects())
    EXPECT_NE(table.out.find(std::string(effect.id) + " "), std::string::npos) << effect.id;
}

TEST(EffectsCommand, ExplainsOneEffect) {
  const auto text = test::runFathom("effects water-current");
  EXPECT_EQ(text.status, 0) << text.err;
  for (const char* part : {"current_m_s", "3 x m/s", "velocity_read", "dvl-scale", "0.2"})
    EXPECT_NE(text.out.find(part), std::string::npos) << part;
}

TEST(EffectsCommand, JsonSaysTheSame) {
  const auto list = nlohmann::json::parse(test::runFathom("effects --json").out);
  ASSERT_EQ(list.size(), allEffects().size());
  EXPECT_EQ(list[0]["id"], allEffects()[0].id);
  const auto one = nlohmann::json::parse(test::runFathom("effects marker-moved --json").out);
  EXPECT_EQ(one["channel"], "marker geometry");
  EXPECT_EQ(one["parameters"][0]["kind"], "marker id");
  EXPECT_TRUE(one["parameters"][0]["prior_sigma"].is_null());
  EXPECT_EQ(one["parameters"][1]["prior_sigma"], 0.02);
}

TEST(EffectsCommand, AnUnknownIdIsOneLineWithTheKnownOnes) {
  test::expectBadInput(test::runFathom("effects dvl-scales"), "dvl-scale,");
}

}  // namespace
}  // namespace fathom
