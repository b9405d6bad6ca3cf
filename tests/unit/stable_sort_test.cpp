#include "core/stable_sort.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "core/random.h"

namespace fathom {
namespace {

TEST(StableSort, SortsAsTheStandardLibraryDoes) {
  Random random(1);
  for (std::size_t count = 0; count < 100; ++count) {
    std::vector<std::pair<int, std::string>> values(count);
    for (auto& [key, text] : values) {
      key = static_cast<int>(random.bits() % 10);
      text = std::to_string(random.bits());
    }
    auto expected = values;
    const auto byKey = [](const auto& a, const auto& b) { return a.first < b.first; };
    std::stable_sort(expected.begin(), expected.end(), byKey);
    stableSort(values, byKey);
    EXPECT_EQ(values, expected);
  }
}

TEST(StableSort, MovesWhatCannotBeCopied) {
  std::vector<std::unique_ptr<int>> values;
  for (const int value : {3, 1, 2}) values.push_back(std::make_unique<int>(value));
  stableSort(values, [](const auto& a, const auto& b) { return *a < *b; });
  EXPECT_EQ(*values[0], 1);
  EXPECT_EQ(*values[1], 2);
  EXPECT_EQ(*values[2], 3);
}

}  // namespace
}  // namespace fathom
