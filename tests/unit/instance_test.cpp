#include "core/instance.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

TEST(Instance, StandsBehindTheDot) {
  EXPECT_TRUE(Instance::of("DVL", "DVL")->isFirst());
  const auto second = Instance::of("DVL.2", "DVL");
  ASSERT_TRUE(second.has_value());
  EXPECT_EQ(second->name(), "2");
  EXPECT_EQ(second->label("INS"), "INS.2");
  EXPECT_EQ(Instance().label("INS"), "INS");
  EXPECT_FALSE(Instance::of("DVL_BEAMS", "DVL").has_value());
  EXPECT_FALSE(Instance::of("DVL.2", "DVL_BEAMS").has_value());
}

TEST(Instance, HasANameOfFewPlainLetters) {
  EXPECT_EQ(baseOf("CAMERA.port-side_2"), "CAMERA");
  EXPECT_EQ(Instance::named("fifteen_letters")->name(), "fifteen_letters");
  for (const char* no_name : {"", "first", "sixteen__letters", "two words", "a.b", "\xc3\xa9"}) {
    EXPECT_FALSE(Instance::named(no_name).has_value()) << no_name;
    // Then the dot is part of a label that the convention does not know.
    const std::string label = std::string("DVL.") + no_name;
    EXPECT_EQ(baseOf(label), label);
    EXPECT_FALSE(Instance::of(label, "DVL").has_value()) << label;
  }
}

TEST(Instance, HasANumberOfItsOwn) {
  EXPECT_EQ(Instance().number(), 0U);
  EXPECT_NE(Instance::named("2")->number(), Instance::named("3")->number());
  EXPECT_LT(Instance(), *Instance::named("2"));
}

}  // namespace
}  // namespace fathom
