// The error budget's file, and what its components do to readings.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/random.h"
#include "diagnosis/budget_columns.h"
#include "diagnosis/budget_file.h"
#include "diagnosis/budget_learning.h"
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

// Only what a camera does to its images changes with what it does.
TEST(ErrorBudget, AProcessedCameraHasItsOwn) {
  const std::string text =
      replaced(kComponent, "factor: 3, unit", "factor: 3, processed: {sigma: 0.03, factor: 10}, unit") +
      "  colours: {by: [pixels.level], each: image and colour, sigma: 0.01, factor: 5, only: processed, "
      "unit: '1', source: a guess}\n";
  const ErrorBudget budget = parseErrorBudget(text, "budget.yaml");
  const ErrorBudget plain = budget.of(CameraPipeline::linear);
  ASSERT_EQ(plain.components.size(), 1u);
  EXPECT_EQ(plain.components[0].sigma, 0.005);
  const ErrorBudget processed = budget.of(CameraPipeline::processed);
  ASSERT_EQ(processed.components.size(), 2u);
  EXPECT_EQ(processed.components[0].sigma, 0.03);
  EXPECT_EQ(processed.components[0].factor, 10);
  EXPECT_EQ(processed.components[1].sigma, 0.01);
  EXPECT_EQ(parseErrorBudget(formatErrorBudget(budget, "a comment"), "budget.yaml"), budget);
  EXPECT_THROW(parseErrorBudget(replaced(text, "only: processed", "only: linear"), "budget.yaml"), Error);
}

// What is looked for is looked for against the declared budget, but for what nobody states.
TEST(ErrorBudget, WhatNobodyStatesIsAsShown) {
  const std::string text =
      kComponent +
      "  colours: {by: [pixels.level], each: image and colour, sigma: 0.01, factor: 5, only: processed, "
      "unit: '1', source: a guess}\n";
  NoiseModel noise;
  noise.budget = parseErrorBudget(text, "budget.yaml").of(CameraPipeline::processed);
  noise.scales = {{0.008, 0.1}, {0.03, 0.1}};
  const NoiseModel declared = noise.declared();
  EXPECT_EQ(declared.sigmaOf(0), 0.005);
  EXPECT_EQ(declared.sigmaOf(1), 0.03);
  ErrorBudget other = noise.budget;
  other.components[0].sigma = 0.0005;
  std::swap(other.components[0], other.components[1]);
  EXPECT_EQ(noise.with(other).sigmaOf(0), 0.03);
  EXPECT_EQ(noise.with(other).sigmaOf(1), 0.0005);
  noise.budget = parseErrorBudget(kComponent, "budget.yaml").of(CameraPipeline::linear);
  noise.scales.resize(noise.budget.components.size());
  EXPECT_TRUE(noise.declared().scales.empty());
}

// A colour of an image has a gain of its own.
TEST(ErrorBudget, ColoursOfAnImageAreApart) {
  Linearization linear;
  for (const std::ptrdiff_t image : {0, 0, 0, 1})
    for (const int colour : {0, 1, 2}) {
      RowInfo row;
      row.channel = kChannel<Pixels>;
      row.component = colour;
      row.image = image;
      row.level = row.per_unit = 1;
      linear.rows.push_back(row);
    }
  VarianceComponent component;
  component.by = {"pixels.level"};
  component.each = VarianceComponent::Each::image_colour;
  component.sigma = 1;
  const OwnedColumns own = columnsOf(linear, component);
  ASSERT_EQ(own.columns.cols(), 6);
  for (Eigen::Index c = 0; c < 6; ++c)
    EXPECT_EQ(Eigen::VectorXd(own.columns.col(c)).sum(),
              own.owners[static_cast<std::size_t>(c)].second == 0 ? 3 : 1);
}

TEST(ErrorBudget, TheShippedOneIsRead) {
  const ErrorBudget budget = readErrorBudget(test::kSource / "config/error_budget.yaml");
  EXPECT_EQ(budget.name, "field");
  EXPECT_GE(budget.components.size(), 10u);
}

TEST(ErrorBudget, IsReadAsItWasWritten) {
  ErrorBudget budget = readErrorBudget(test::kSource / "config/error_budget.yaml");
  budget.components.front().source = "a sheet: \"5 %\" # of it";
  const ErrorBudget again = parseErrorBudget(formatErrorBudget(budget, "a comment"), "budget.yaml");
  EXPECT_EQ(again.name, budget.name);
  EXPECT_EQ(again.outlier_share, budget.outlier_share);
  EXPECT_EQ(again.noise_factor, budget.noise_factor);
  ASSERT_EQ(again.components.size(), budget.components.size());
  for (std::size_t k = 0; k < budget.components.size(); ++k) {
    const VarianceComponent &is = again.components[k], &was = budget.components[k];
    EXPECT_EQ(is.name, was.name);
    EXPECT_EQ(is.by, was.by) << was.name;
    EXPECT_EQ(is.each, was.each) << was.name;
    EXPECT_EQ(is.smooth.has_value(), was.smooth.has_value()) << was.name;
    if (was.smooth) {
      EXPECT_EQ(is.smooth->over, was.smooth->over);
      EXPECT_EQ(is.smooth->length, was.smooth->length);
    }
    EXPECT_NEAR(is.sigma, was.sigma, 0.005 * was.sigma) << was.name;  // written with three digits
    EXPECT_NEAR(is.factor, was.factor, 0.005 * was.factor) << was.name;
    EXPECT_EQ(is.unit, was.unit) << was.name;
    EXPECT_EQ(is.source, was.source);
  }
}

/// As a recording would have it whose own readings say ln sigma = `told` ± `sd`, held by the component's
/// prior.
EstimatedScale heldBy(const VarianceComponent& component, double told, double sd) {
  const double prior = 1 / std::pow(component.logSd(), 2), own = 1 / (sd * sd);
  const double mean = (prior * std::log(component.sigma) + own * told) / (prior + own);
  return {std::exp(mean), 1 / std::sqrt(prior + own), 0};
}

// Another budget may have other components, in another order.
TEST(ErrorBudget, WhoIsApartStaysSoUnderAnother) {
  NoiseModel noise;
  noise.budget.components.resize(3);
  noise.budget.components[0].name = "print";
  noise.budget.components[1].name = "flatness";
  noise.budget.components[2].name = "growth";
  noise.scales.resize(3);
  noise.apart.resize(3);
  noise.apart[0][{7, 0}] = 0.5;
  noise.apart[2][{9, 0}] = 0.25;
  ErrorBudget other;
  other.components.resize(2);
  other.components[0].name = "jitter";
  other.components[1].name = "print";
  const NoiseModel under_other = noise.with(other);
  EXPECT_TRUE(under_other.scales.empty());
  ASSERT_EQ(under_other.apart.size(), 2U);
  EXPECT_TRUE(under_other.apart[0].empty());
  EXPECT_EQ(under_other.sigmaApart(1, {7, 0}), 0.5);
}

TEST(LearntBudget, StaysAsDeclaredWhereNothingIsTold) {
  const ErrorBudget before = parseErrorBudget(kComponent, "budget.yaml");
  const VarianceComponent& was = before.components.front();
  const ErrorBudget after = learntBudget(before, {{heldBy(was, 0, 1e6)}, {heldBy(was, 0, 1e6)}});
  EXPECT_NEAR(after.components.front().sigma, was.sigma, 1e-6 * was.sigma);
  EXPECT_NEAR(after.components.front().factor, was.factor, 1e-6);
}

/// Vehicles drawn as the model has it: what is learnt says how the next recording of each will be, with the
/// standard deviation that it states.
TEST(LearntBudget, SaysWhatTheNextRecordingWillBe) {
  const ErrorBudget before = parseErrorBudget(kComponent, "budget.yaml");
  const VarianceComponent& was = before.components.front();
  const double sd = was.logSd(), half = std::sqrt(0.5) * sd, told_sd = 0.5 * sd;
  Random random(7);
  double sum = 0, square = 0, stated = 0;
  constexpr int kVehicles = 2000;
  for (int vehicle = 0; vehicle < kVehicles; ++vehicle) {
    const double own = std::log(was.sigma) + half * random.normal();
    std::vector<std::vector<EstimatedScale>> recordings;
    for (int i = 0; i < 3; ++i)
      recordings.push_back({heldBy(was, own + half * random.normal() + told_sd * random.normal(), told_sd)});
    const VarianceComponent learnt = learntBudget(before, recordings).components.front();
    const double off = (own + half * random.normal() - std::log(learnt.sigma)) / learnt.logSd();
    sum += off;
    square += off * off;
    stated += learnt.logSd() / kVehicles;
  }
  // Four standard errors of a mean, and of a variance, of so many.
  EXPECT_NEAR(sum / kVehicles, 0, 4 / std::sqrt(kVehicles));
  EXPECT_NEAR(square / kVehicles, 1, 4 * std::sqrt(2.0 / kVehicles));
  EXPECT_LT(stated, 0.9 * sd);
}

TEST(LearntBudget, RefusesScalesOfAnother) {
  const ErrorBudget before = parseErrorBudget(kComponent, "budget.yaml");
  EXPECT_THROW(learntBudget(before, {{}}), std::invalid_argument);
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
                                                        {"unit: '1'", "unit: '%'"},
                                                        {"smooth: {over", "each: face, smooth: {over"}})
    EXPECT_THROW(parseErrorBudget(replaced(kComponent, what, by), "budget.yaml"), Error) << by;
}

TEST(ErrorBudget, UnitsAreThoseOfWhatActs) {
  EXPECT_EQ(unitOf("panel-shape.stretch_x"), "1");
  EXPECT_EQ(unitOf("marker-moved.offset_m.x"), "m");
  EXPECT_EQ(unitOf("pixels.reflected"), "1");
  EXPECT_EQ(unitOf("markers.x"), "px");
  EXPECT_EQ(unitOf("dvl"), "m/s") << "reports have it in mm/s";
  EXPECT_THROW(unitOf("panel-shape.stretch"), std::invalid_argument);
  EXPECT_THROW(unitOf("panels"), std::invalid_argument);
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
  component.sigma = 1;
  return component;
}

// Between nodes that are half a length of correlation apart a hat is off by up to 6 % of the variance.
TEST(BudgetColumns, ASmoothFieldHasItsKernel) {
  const Linearization linear = light(40);
  VarianceComponent response = component("pixels.level");
  response.smooth = SmoothField{{"brightness"}, {60}};
  const Eigen::MatrixXd columns = columnsOf(linear, response).columns;
  const Eigen::MatrixXd covariance = columns * columns.transpose();
  for (Eigen::Index i = 0; i < 40; ++i)
    for (Eigen::Index j = 0; j < 40; ++j) {
      const RowInfo &a = linear.rows[static_cast<std::size_t>(i)],
                    &b = linear.rows[static_cast<std::size_t>(j)];
      const double apart = 255 * (a.level - b.level) / 60;
      const double expected = 1e4 * a.level * b.level * std::exp(-0.5 * apart * apart);
      EXPECT_NEAR(covariance(i, j), expected, 2e-3 * 1e4 * a.level * b.level) << i << " " << j;
    }
}

// A patch reads the mean of a field over all of it. Compared with a sum over eleven places that scatter as
// much.
TEST(BudgetColumns, APatchHasTheMeanOfAField) {
  constexpr int kPlaces = 11;
  constexpr double kSpread_px = 60, kStep_px = kSpread_px / 3.1622776601683795;  // uniform: (n^2 - 1) / 12
  Linearization linear = light(2 + 2 * kPlaces);
  const auto count = static_cast<std::size_t>(kPlaces);
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    RowInfo& row = linear.rows[i];
    row.level = 1;
    row.focal_px = 500;
    const std::size_t patch = i < 2 ? i : (i - 2) / count;
    const double off = i < 2 ? 0 : kStep_px * (static_cast<double>((i - 2) % count) - (kPlaces - 1) / 2.0);
    row.pixel = {200 + 150.0 * static_cast<double>(patch) + off, 100};
    if (i < 2) row.pixel_spread = {kSpread_px, 0};
  }
  VarianceComponent flat_field = component("pixels.level");
  flat_field.smooth = SmoothField{{"image x"}, {0.36}};
  const Eigen::MatrixXd columns = columnsOf(linear, flat_field).columns;
  for (Eigen::Index patch = 0; patch < 2; ++patch) {
    const Eigen::RowVectorXd mean = columns.middleRows(2 + patch * kPlaces, kPlaces).colwise().mean(),
                             middle = columns.row(2 + patch * kPlaces + kPlaces / 2);
    const double off = (columns.row(patch) - mean).norm();
    EXPECT_LT(off, 0.1 * (middle - mean).norm()) << patch;
    EXPECT_LT(off, 0.5) << patch;  // of 100
  }
}

/// Of a kernel of unit length between all within `a` of a middle and all within `b` of it: by sums.
double meanKernel(double a, double b) {
  constexpr int kPlaces = 200;
  double sum = 0;
  for (int i = 0; i < kPlaces; ++i)
    for (int j = 0; j < kPlaces; ++j) {
      const double apart = a * (2 * (i + 0.5) / kPlaces - 1) - b * (2 * (j + 0.5) / kPlaces - 1);
      sum += std::exp(-0.5 * apart * apart);
    }
  return sum / (kPlaces * kPlaces);
}

// How evenly a place is printed changes within a few centimetres: from afar less of it is seen, which has
// another mean about the same middle. Nodes are at most 0.55 of a length apart, which leaves out 1e-3 of a
// field's variance.
TEST(BudgetColumns, APlaceOfUnevenPrintHasAnotherMeanWhereLessIsSeen) {
  constexpr double kLength_m = 0.05;
  const std::array<double, 3> halves_m{0.06, 0.1, 0.15};
  Linearization linear = light(3);
  for (std::size_t i = 0; i < 3; ++i) {
    RowInfo& row = linear.rows[i];
    row.reflected = 1;
    row.place = 0;
    row.point_panel = {0.3 + 1e-4 * static_cast<double>(i), 0};
    row.panel_spread = {halves_m[i] / std::sqrt(3.0), 0};
  }
  VarianceComponent evenness = component("pixels.reflected");
  evenness.each = VarianceComponent::Each::spot;
  evenness.smooth = SmoothField{{"panel x"}, {kLength_m}};
  const Eigen::MatrixXd columns = columnsOf(linear, evenness).columns;
  const Eigen::MatrixXd covariance = columns * columns.transpose();
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j) {
      const double expected = 1e4 * meanKernel(halves_m[static_cast<std::size_t>(i)] / kLength_m,
                                               halves_m[static_cast<std::size_t>(j)] / kLength_m);
      EXPECT_NEAR(covariance(i, j), expected, 0.01 * expected) << i << " " << j;
    }
}

// White and black are of one print.
TEST(BudgetColumns, PatchesOfAMarkerShareItsValue) {
  Linearization linear = light(6);
  for (std::size_t i = 0; i < 6; ++i) {
    linear.rows[i].reflected = 0.5;
    linear.rows[i].printed_on = static_cast<int>(i) / 2;
  }
  VarianceComponent print = component("pixels.reflected");
  print.each = VarianceComponent::Each::marker;
  const OwnedColumns own = columnsOf(linear, print);
  ASSERT_EQ(own.columns.cols(), 3);
  const Eigen::MatrixXd covariance = Eigen::MatrixXd(own.columns) * Eigen::MatrixXd(own.columns).transpose();
  for (Eigen::Index i = 0; i < 6; ++i)
    for (Eigen::Index j = 0; j < 6; ++j)
      EXPECT_NEAR(covariance(i, j), i / 2 == j / 2 ? 50 * 50 : 0, 1e-9) << i << " " << j;
  EXPECT_EQ(own.owners[1].first, 1);
}

// What all places share is a mean over all of a place, about the middle of what is seen of it: a field that
// were the same for all parts would leave its slope over them to a gradient of light, as one that is there.
TEST(BudgetColumns, AFieldThatPlacesShareIsAsWideAsEach) {
  Linearization linear = light(6);
  for (std::size_t i = 0; i < 6; ++i) {
    RowInfo& row = linear.rows[i];
    row.reflected = 1;
    row.patch = static_cast<std::ptrdiff_t>(i);
    row.place = static_cast<int>(i / 2);
    row.seen_share = i % 2 == 0 ? 1 : 0.4;
    row.point_panel = {0.3 * static_cast<double>(i / 2) + (i % 2 == 0 ? 0 : 0.08), 0.1};
    row.panel_spread = {i % 2 == 0 ? 0.03 : 0.005, 0.005};
  }
  VarianceComponent illumination = component("pixels.reflected");
  illumination.smooth = SmoothField{{"panel x"}, {0.5}};
  const Eigen::MatrixXd columns = columnsOf(linear, illumination).columns;
  // Two values of a field of unit variance 0.08 m apart differ by sqrt(2 (1 - exp(-0.08^2 / (2 0.5^2))));
  // means over places of 0.1 m by 0.6 % less.
  const double step = 100 * std::sqrt(2 * (1 - std::exp(-0.5 * std::pow(0.08 / 0.5, 2))));
  for (Eigen::Index place = 0; place < 3; ++place)
    EXPECT_NEAR((columns.row(2 * place) - columns.row(2 * place + 1)).norm(), step, 0.05 * step) << place;
  for (RowInfo& row : linear.rows) row.point_panel.x() = 0.3 * (row.place + 1);
  const Eigen::MatrixXd in_place = columnsOf(linear, illumination).columns;
  for (Eigen::Index place = 0; place < 3; ++place)
    EXPECT_EQ(in_place.row(2 * place), in_place.row(2 * place + 1)) << place;
}

// What nobody could see, be it as large as the budget has it, has no column.
TEST(BudgetColumns, WhatReadingsCannotTellHasNoColumn) {
  Linearization linear = light(40);
  VarianceComponent response = component("pixels.level");
  response.smooth = SmoothField{{"brightness"}, {60}};
  const Eigen::Index all = columnsOf(linear, response).columns.cols();
  response.sigma = 1e-3;
  const Eigen::MatrixXd told = columnsOf(linear, response).columns;
  EXPECT_LT(told.cols(), all);
  EXPECT_GT(told.cols(), 0);
  // What is dropped is less than a third of the readings' noise in any direction, at the largest
  // (kLeastTold).
  response.sigma = 1;
  const Eigen::MatrixXd whole = columnsOf(linear, response).columns;
  const Eigen::MatrixXd dropped = whole * whole.transpose() - told * told.transpose();
  EXPECT_LT(std::pow(1e-3 * response.factor, 2) * eigenOf(dropped).values.maxCoeff(), 0.3);
  response.sigma = 1e-9;
  EXPECT_EQ(columnsOf(linear, response).columns.cols(), 0);
}

// Open water is at no place of the panel.
TEST(BudgetColumns, AFieldLeavesOutWhatHasNoPlaceInIt) {
  Linearization linear = light(6);
  for (RowInfo& row : linear.rows) row.reflected = 1;
  VarianceComponent illumination = component("pixels.reflected");
  illumination.smooth = SmoothField{{"panel x", "panel y"}, {0.5, 0.5}};
  for (std::size_t i = 0; i < 3; ++i) linear.rows[i].point_panel = {0.1 * static_cast<double>(i), 0.2};
  const Eigen::MatrixXd columns = columnsOf(linear, illumination).columns;
  EXPECT_TRUE(columns.allFinite());
  for (Eigen::Index i = 0; i < 6; ++i) EXPECT_NEAR(columns.row(i).norm(), i < 3 ? 100 : 0, 1) << i;
}

TEST(BudgetColumns, EachHasAValueOfItsOwn) {
  const Linearization linear = light(12);
  VarianceComponent gain = component("pixels.level");
  for (const auto& [each, count] :
       std::vector<std::pair<VarianceComponent::Each, int>>{{VarianceComponent::Each::recording, 1},
                                                            {VarianceComponent::Each::image, 4},
                                                            {VarianceComponent::Each::place, 3}}) {
    gain.each = each;
    const Eigen::MatrixXd columns = columnsOf(linear, gain).columns;
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
