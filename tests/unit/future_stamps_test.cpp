// One bad stamp must not take the filter with it; a pause of all sensors is none.
#include "localization/future_stamps.h"

#include <gtest/gtest.h>

namespace fathom {
namespace {

struct Stamped {
  std::vector<double> taken;
  std::size_t named = 0;
  FutureStamps future{[this](const Sample&, double t_s) { taken.push_back(t_s); },
                      [this](double, const char* kind, const std::string&) {
                        EXPECT_STREQ(kind, "from-the-future");
                        ++named;
                      }};

  Stamped& add(const std::vector<double>& times_s) {
    for (const double t_s : times_s) future.add({Time{}, labels::kDvl, DvlSample{}}, t_s);
    return *this;
  }
  std::vector<double> all() {
    future.finish();
    return taken;
  }
};

std::vector<double> tenth(double first, double last) {
  std::vector<double> times_s;
  for (double t = first; t < last; t += 0.1) times_s.push_back(t);
  return times_s;
}

std::size_t below(const std::vector<double>& times_s, double limit) {
  return static_cast<std::size_t>(
      std::count_if(times_s.begin(), times_s.end(), [limit](double t) { return t < limit; }));
}

TEST(FutureStamps, OneWaitsWhileOthersGoOn) {
  Stamped stamped;
  stamped.add(tenth(0, 3)).add({1e6}).add(tenth(3, 9));
  const auto taken = stamped.all();
  EXPECT_EQ(taken.size(), tenth(0, 3).size() + tenth(3, 9).size());
  EXPECT_LT(taken.back(), 9.0);
  EXPECT_EQ(stamped.named, 1u);
}

TEST(FutureStamps, ComesWhenItsTimeHasCome) {
  Stamped stamped;
  stamped.add(tenth(0, 3)).add({20.05}).add(tenth(3, 30));
  const auto taken = stamped.all();
  EXPECT_EQ(std::count(taken.begin(), taken.end(), 20.05), 1);
  const auto at = std::find(taken.begin(), taken.end(), 20.05);
  EXPECT_GT(*std::prev(at), 15.0);  // not earlier than it is no longer far ahead
  EXPECT_EQ(stamped.named, 1u);
}

TEST(FutureStamps, APauseOfAllSensorsIsNone) {
  Stamped stamped;
  stamped.add(tenth(0, 3)).add(tenth(100, 103));
  const auto taken = stamped.all();
  EXPECT_EQ(taken.size(), tenth(0, 3).size() + tenth(100, 103).size());
  EXPECT_TRUE(std::is_sorted(taken.begin(), taken.end()));
  EXPECT_EQ(stamped.named, 0u);
}

TEST(FutureStamps, APauseBeforeTheLastFewIsNone) {
  Stamped stamped;
  stamped.add(tenth(0, 3)).add({100.0, 100.1, 100.2});
  EXPECT_EQ(below(stamped.all(), 1e9), tenth(0, 3).size() + 3);
  EXPECT_EQ(stamped.named, 0u);
}

TEST(FutureStamps, TheFirstOneOfAllMayBeWrong) {
  Stamped stamped;
  stamped.add({1e9}).add(tenth(0, 3));
  const auto taken = stamped.all();
  EXPECT_EQ(taken.size(), tenth(0, 3).size());
  EXPECT_EQ(stamped.named, 1u);
}

TEST(FutureStamps, RareReadingsAreNotAhead) {
  Stamped stamped;
  for (int i = 0; i < 20; ++i) stamped.add({20.0 * i});
  EXPECT_EQ(stamped.all().size(), 20u);
}

TEST(FutureStamps, OnlySoManyWait) {
  Stamped stamped;
  stamped.add({0.0, 0.1});
  for (std::size_t i = 0; i < 3 * FutureStamps::kMost; ++i)  // each far from all others
    stamped.add({1e6 + 1e4 * static_cast<double>(i)});
  stamped.add(tenth(0.2, 2.0));
  EXPECT_EQ(below(stamped.all(), 1e5), 2 + tenth(0.2, 2.0).size());
  EXPECT_EQ(stamped.named, 3 * FutureStamps::kMost);
}

}  // namespace
}  // namespace fathom
