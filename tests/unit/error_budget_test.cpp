// The error budget's file, and what its components do to readings.
#include <gtest/gtest.h>

#include <cmath>

#include "core/error.h"
#include "diagnosis/budget_columns.h"
#include "diagnosis/budget_file.h"
#include "support/shipped.h"

namespace fathom {
namespace {

const std::string kComponent =
    "name: mine\noutlier_share: 0.01\nnoise_factor: 3\ncomponents:\n"
    "  response: {by: [pixels.level], smooth: {over: [brightness], length: [60]}, sigma: 0.005, factor: 3, "
    "unit: '1', source: a sheet}\n";

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  return text.replace(text.find(what), what.size(), by);
}

TEST(ErrorBudget, IsRead) {
  const ErrorBudget budget = parseErrorBudget(kComponent, "budget.yaml");
  ASSERT_EQ(budget.components.size(), 1u);
  const VarianceComponent& response = budget.components.front();
  EXPECT_EQ(response.name, "response");
  EXPECT_EQ(response.smooth->over, std::vector<std::string>{"brightness"});
  // 99 % of a normal variable are within 2.576 of its standard deviations.
  EXPECT_NEAR(std::exp(2.576 * response.logSd()), 3.0, 1e-9);
}

TEST(ErrorBudget, TheShippedOneIsRead) {
  const ErrorBudget budget = readErrorBudget(test::kSource / "config/error_budget.yaml");
  EXPECT_EQ(budget.name, "field");
  EXPECT_GE(budget.components.size(), 10u);
}

TEST(ErrorBudget, WrongValuesAreNamed) {
  for (const auto& [what, by] :
       std::vector<std::pair<std::string, std::string>>{{"sigma: 0.005", "sigma: 0"},
                                                        {"factor: 3", "factor: 1"},
                                                        {"length: [60]", "length: [60, 60]"},
                                                        {"length: [60]", "length: [-1]"},
                                                        {"by: [pixels.level]", "by: []"},
                                                        {"by: [pixels.level]", "by: [pixels.shade]"},
                                                        {"by: [pixels.level]", "by: [gamma.exponent]"},
                                                        {"over: [brightness]", "over: [blackness]"},
                                                        {"noise_factor: 3", "noise_factor: 0.5"},
                                                        {"outlier_share: 0.01", "outlier_share: 0.6"},
                                                        {"source: a sheet", "sauce: a sheet"},
                                                        {"smooth: {over", "each: face, smooth: {over"}})
    EXPECT_THROW(parseErrorBudget(replaced(kComponent, what, by), "budget.yaml"), Error) << by;
}

/// Readings of light, at levels that go up evenly; three to an image.
Linearization light(int count) {
  Linearization linear;
  for (int i = 0; i < count; ++i) {
    RowInfo row;
    row.channel = kChannel<Pixels>;
    row.level = (i + 0.5) / count;
    row.per_unit = 100;
    row.image = i / 3;
    row.place = i % 3;
    linear.rows.push_back(row);
  }
  return linear;
}

VarianceComponent component(const std::string& by) {
  VarianceComponent component;
  component.name = "test";
  component.by = {by};
  return component;
}

// Between nodes that are half a length of correlation apart a hat is off by up to 6 % of the variance.
TEST(BudgetColumns, ASmoothFieldHasItsKernel) {
  const Linearization linear = light(40);
  VarianceComponent response = component("pixels.level");
  response.smooth = SmoothField{{"brightness"}, {60}};
  const Eigen::MatrixXd columns = columnsOf(linear, response);
  const Eigen::MatrixXd covariance = columns * columns.transpose();
  for (Eigen::Index i = 0; i < 40; ++i)
    for (Eigen::Index j = 0; j < 40; ++j) {
      const RowInfo &a = linear.rows[static_cast<std::size_t>(i)],
                    &b = linear.rows[static_cast<std::size_t>(j)];
      const double apart = 255 * (a.level - b.level) / 60;
      const double expected = 1e4 * a.level * b.level * std::exp(-0.5 * apart * apart);
      EXPECT_NEAR(covariance(i, j), expected, 0.08 * 1e4 * a.level * b.level) << i << " " << j;
    }
}

TEST(BudgetColumns, EachHasAValueOfItsOwn) {
  const Linearization linear = light(12);
  VarianceComponent gain = component("pixels.level");
  for (const auto& [each, count] :
       std::vector<std::pair<VarianceComponent::Each, int>>{{VarianceComponent::Each::recording, 1},
                                                            {VarianceComponent::Each::image, 4},
                                                            {VarianceComponent::Each::place, 3}}) {
    gain.each = each;
    const Eigen::MatrixXd columns = columnsOf(linear, gain);
    EXPECT_EQ(columns.cols(), count);
    // Every row has one value, its own level's worth.
    for (Eigen::Index i = 0; i < 12; ++i) {
      EXPECT_EQ((columns.row(i).array() != 0).count(), 1);
      EXPECT_NEAR(columns.row(i).sum(), 100 * linear.rows[static_cast<std::size_t>(i)].level, 1e-12);
    }
  }
}

TEST(BudgetColumns, UnknownNamesAreErrors) {
  const Linearization linear = light(3);
  for (const char* by : {"pixel.level", "pixels.lovel", "marker-moved.offset", "marker-moved.offset_m.w"})
    EXPECT_THROW(columnsOf(linear, component(by)), std::invalid_argument) << by;
}

}  // namespace
}  // namespace fathom
