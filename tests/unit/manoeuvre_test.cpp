// What an operator is advised to do.
#include "diagnosis/manoeuvre.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

TEST(Manoeuvre, GoesOnAfterAMinuteAsItBegan) {
  for (const Manoeuvre& manoeuvre : manoeuvres()) {
    const Pose first = manoeuvre.T_station_robot(7), third = manoeuvre.T_station_robot(127);
    EXPECT_LT((first.position - third.position).norm(), 1e-9) << manoeuvre.text;
    EXPECT_LT((first.rotation - third.rotation).norm(), 1e-9) << manoeuvre.text;
    // Where one ends the next begins, without a jump.
    const Pose end = manoeuvre.in_first_minute(Manoeuvre::kDuration_s), begin = manoeuvre.in_first_minute(0);
    EXPECT_LT((end.position - begin.position).norm(), 1e-9) << manoeuvre.text;
    EXPECT_LT((end.rotation - begin.rotation).norm(), 1e-9) << manoeuvre.text;
  }
}

TEST(Advice, SaysHowLong) {
  EXPECT_EQ(textOf({.manoeuvre = "hold station"}), "hold station");
  EXPECT_EQ(textOf({.manoeuvre = "hold station", .minutes = 3}), "hold station, 3 minutes long");
  EXPECT_EQ(textOf({.minutes = 3}), "");
}

}  // namespace
}  // namespace fathom
