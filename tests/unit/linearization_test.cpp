#include "estimation/linearization.h"

#include <gtest/gtest.h>

#include "core/linear_algebra.h"
#include "core/random.h"
#include "effects/catalogue.h"
#include "effects/drawn.h"
#include "effects/image_regions.h"
#include "estimation/nuisances.h"
#include "estimation/selected_inverse.h"
#include "support/batch_runs.h"

namespace fathom {
namespace {

/// Sparse rows, each joining three neighbours and now and then the last column.
Eigen::SparseMatrix<double> randomRows(int rows, int columns, Random& random) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < rows; ++i) {
    const int first = static_cast<int>(random.bits() % static_cast<std::uint64_t>(columns - 2));
    for (int c = 0; c < 3; ++c) entries.emplace_back(i, first + c, random.normal());
    if (random.uniform() < 0.3) entries.emplace_back(i, columns - 1, random.normal());
  }
  for (int c = 0; c < columns; ++c) entries.emplace_back(c, c, 1.0);
  Eigen::SparseMatrix<double> J(rows, columns);
  J.setFromTriplets(entries.begin(), entries.end());
  return J;
}

TEST(SelectedInverse, IsTheDenseInverseWhereItIsKept) {
  Random random(1);
  const Eigen::SparseMatrix<double> J = randomRows(120, 40, random);
  const Eigen::SparseMatrix<double> normal = J.transpose() * J;
  const Eigen::MatrixXd dense = inverseOf(Eigen::MatrixXd(normal));
  const SelectedInverse selected(normal.triangularView<Eigen::Lower>());
  int compared = 0;
  for (int c = 0; c < normal.outerSize(); ++c)
    for (Eigen::SparseMatrix<double>::InnerIterator it(normal, c); it; ++it, ++compared)
      EXPECT_NEAR(selected(it.row(), it.col()), dense(it.row(), it.col()), 1e-12);
  EXPECT_GT(compared, 150);
  const std::vector<Eigen::Index> some{5, 39, 6};
  EXPECT_NEAR(selected.block(some)(1, 0), dense(39, 5), 1e-12);
  EXPECT_THROW(SelectedInverse(Eigen::SparseMatrix<double>(3, 3)), std::runtime_error);
}

TEST(Nuisances, AreProjectedOffAsDenseAlgebraSays) {
  Random random(2);
  const Eigen::SparseMatrix<double> J = randomRows(90, 30, random);
  Eigen::MatrixXd C = random.normals(90, 4);
  C.col(3) = J * Eigen::VectorXd::LinSpaced(30, -1, 1);  // what the nuisances can take over wholly
  Eigen::VectorXd r(90);
  for (double& e : r) e = random.normal();
  const Eigen::MatrixXd D(J);
  const Eigen::MatrixXd P =
      Eigen::MatrixXd::Identity(90, 90) - D * inverseOf(D.transpose() * D) * D.transpose();
  const Nuisances nuisances(J);
  const Eigen::MatrixXd C_perp = nuisances.project(C);
  EXPECT_LT((C_perp - P * C).norm(), 1e-11);
  EXPECT_LT(C_perp.col(3).norm(), 1e-10);
  const Eigen::SparseMatrix<double> columns = C.sparseView();
  const Reduced reduced = nuisances.reduce(columns, r);
  EXPECT_LT((reduced.gram - C.transpose() * P * C).norm(), 1e-10);
  EXPECT_LT((reduced.score - C.transpose() * P * r).norm(), 1e-10);
  EXPECT_LT((reduced.norms - C.colwise().norm().transpose()).norm(), 1e-12);
  // Whatever order they are eliminated in.
  const Nuisances sorted(J, {.local = 6, .full = 9});
  EXPECT_LT((sorted.project(C) - P * C).norm(), 1e-11);
  EXPECT_LT((sorted.reduce(columns, r).gram - reduced.gram).norm(), 1e-10);
  EXPECT_LT((sorted.step(r) - nuisances.step(r)).norm(), 1e-10);
  EXPECT_LT((sorted.covariance({2, 23, 29}) - nuisances.covariance({2, 23, 29})).norm(), 1e-10);
  const std::vector<Reduced> each = nuisances.reduceEach(columns, r, {1, 3});
  ASSERT_EQ(each.size(), 2u);
  EXPECT_LT((each[1].gram - reduced.gram.bottomRightCorner(3, 3)).norm(), 1e-12);
  EXPECT_LT((each[1].score - reduced.score.tail(3)).norm(), 1e-12);
  EXPECT_LT((each[1].norms - reduced.norms.tail(3)).norm(), 1e-12);
}

/// A short run with noise, its estimate, and an uncertain panel.
struct LinearRun {
  test::BatchRun run{6.0};
  BatchInput input;
  BatchOptions options;
  BatchEstimate estimate;

  explicit LinearRun(bool pixels = false, std::size_t late = kEffectIndex<CameraLatency>) {
    run.panel.position_sigma_m = 0.05;
    run.panel.angle_sigma_rad = 0.01;
    run.pixels = pixels;
    input = run.input();
    options.calibration.on.set(kEffectIndex<DvlScale>).set(late);
    options.problem.estimate = options.calibration.on;
    estimate = estimateBatch(input.data, input.start, options);
  }
};

Eigen::VectorXd residuals(const BatchProblem& problem, const Eigen::VectorXd& x) {
  const BatchPoint at = problem.pointAt(x, false);
  std::vector<double> all;
  for (const auto& cost : problem.costs()) {
    Eigen::VectorXd r;
    cost->compute(at, r, nullptr);
    all.insert(all.end(), r.begin(), r.end());
  }
  return Eigen::Map<Eigen::VectorXd>(all.data(), std::ssize(all));
}

/// What several unknowns at once change in all readings.
void expectDerivativeOfDifferences(const LinearRun& linear_run) {
  ASSERT_TRUE(linear_run.estimate.succeeded) << linear_run.estimate.failure;
  const auto problem = problemAt(linear_run.input.data, linear_run.estimate, linear_run.options);
  const Linearization linear = linearize(linear_run.input.data, *problem);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(problem->unknowns());
  EXPECT_LT((residuals(*problem, zero) - linear.residual).norm(), 1e-9);  // Jets round otherwise
  // Every unknown in turn would take long: directions that mix all of them find a wrong entry as well.
  Random random(3);
  for (int k = 0; k < 10; ++k) {
    Eigen::VectorXd direction(problem->unknowns());
    for (const UnknownBlock& block : problem->blocks())
      for (int i = 0; i < block.size; ++i) {
        const double typical = block.kind == UnknownBlock::Kind::drift && block.size == 1 ? 1.0 : 1e-4;  // Pa
        direction[block.column + i] = typical * random.normal();
      }
    const Eigen::VectorXd change = 0.5 * (residuals(*problem, direction) - residuals(*problem, -direction));
    const Eigen::VectorXd expected = linear.J * direction;
    EXPECT_LT((change - expected).norm(), 1e-5 * expected.norm()) << k;
  }
}

TEST(Linearization, NuisancesDerivativeIsThatOfDifferences) { expectDerivativeOfDifferences(LinearRun()); }

// A path moves along with the INS's latency.
TEST(Linearization, DerivativeByALatencyThatKnotsFollowIsThatOfDifferences) {
  const LinearRun linear_run(false, kEffectIndex<InsLatency>);
  expectDerivativeOfDifferences(linear_run);
  constexpr double h = 1e-5;
  Eigen::VectorXd ends[2];
  for (const int sign : {0, 1}) {
    BatchEstimate moved = linear_run.estimate;
    const double step = sign == 0 ? -h : h;
    *moved.state.effects.of<InsLatency>() += step;
    moved.state.path.begin_s -= step;
    const auto there = problemAt(linear_run.input.data, moved, linear_run.options);
    ends[sign] = residuals(*there, Eigen::VectorXd::Zero(there->unknowns()));
  }
  const auto problem = problemAt(linear_run.input.data, linear_run.estimate, linear_run.options);
  const Linearization linear = linearize(linear_run.input.data, *problem);
  Eigen::VectorXd expected = (ends[1] - ends[0]) / (2 * h);
  bool has_markers = false;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    if (linear.rows[i].channel == kChannel<Prior>) expected[k] = 0;
    if (linear.rows[i].channel == kChannel<Gyro>) EXPECT_EQ(linear.by_knots[k], 0);
    has_markers = has_markers || (linear.rows[i].channel == kChannel<Markers> && linear.by_knots[k] != 0);
  }
  EXPECT_TRUE(has_markers);
  EXPECT_LT((linear.by_knots - expected).norm(), 1e-4 * expected.norm());
  Eigen::VectorXd x = Eigen::VectorXd::Zero(problem->unknowns());
  x[problem->find(UnknownBlock::Kind::effect, kEffectIndex<InsLatency>)->column] = 0.01;
  EXPECT_NEAR(problem->at(x).path.begin_s, linear_run.estimate.state.path.begin_s - 0.01, 1e-12);
}

// Where in the image a corner is must not tell how far off its reading is: a field over the image that is
// steep would make all of what is left smaller.
TEST(Linearization, ACornersPlaceDoesNotFollowItsReading) {
  LinearRun linear_run;
  const auto rows = [&] {
    const auto problem = problemAt(linear_run.input.data, linear_run.estimate, linear_run.options);
    return linearize(linear_run.input.data, *problem).rows;
  };
  const std::vector<RowInfo> before = rows();
  for (BatchMarker& seen : linear_run.input.data.markers) seen.detection.corners_px[2] += Vector2d(20, -10);
  const std::vector<RowInfo> after = rows();
  ASSERT_EQ(before.size(), after.size());
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].channel != kChannel<Markers>) continue;
    EXPECT_LT((after[i].pixel - before[i].pixel).norm(), 1e-9);
    EXPECT_NEAR(after[i].image_radius, before[i].image_radius, 1e-12);
  }
}

// Light takes poses as they are: what it would read at others is seen by taking others.
TEST(Linearization, WhatIsTakenIsThatOfDifferences) {
  const LinearRun linear_run(true);
  const BatchData& data = linear_run.input.data;
  const auto problem = problemAt(data, linear_run.estimate, linear_run.options);
  const Linearization linear = linearize(data, *problem);
  Random random(7);
  for (int k = 0; k < 4; ++k) {
    Eigen::VectorXd direction = Eigen::VectorXd::Zero(problem->unknowns());
    for (const UnknownBlock& block : problem->blocks())
      if (block.kind == UnknownBlock::Kind::pose || block.kind == UnknownBlock::Kind::panel)
        direction.segment(block.column, block.size) = 1e-4 * random.normals(block.size, 1);
    Eigen::VectorXd ends[2];
    for (const int sign : {0, 1}) {
      BatchEstimate moved = linear_run.estimate;
      moved.state = problem->at(sign == 0 ? Eigen::VectorXd(-direction) : direction);
      const auto there = problemAt(data, moved, linear_run.options);
      ends[sign] = residuals(*there, Eigen::VectorXd::Zero(there->unknowns()));
    }
    Eigen::VectorXd change = 0.5 * (ends[1] - ends[0]);
    for (std::size_t i = 0; i < linear.rows.size(); ++i)
      if (linear.rows[i].channel != kChannel<Pixels>) change[static_cast<Eigen::Index>(i)] = 0;
    const Eigen::VectorXd expected = linear.taken * direction;
    EXPECT_GT(expected.norm(), 1e-3);
    // Footprints are of the pose that was rendered from, so poses move light by what is on its way alone.
    EXPECT_LT((change - expected).norm(), 1e-4 * expected.norm()) << k;
  }
}

// A column of C is the change of all residuals where its effect acts: seen by switching the effect on.
TEST(Linearization, EffectColumnsAreThoseOfDifferences) {
  const LinearRun linear_run(true);
  const BatchData& data = linear_run.input.data;
  const auto problem = problemAt(data, linear_run.estimate, linear_run.options);
  const Linearization linear = linearize(data, *problem);
  const int marker_id = data.markers.front().marker.id;
  std::size_t columns_seen = 0;
  constexpr double kPeak_s = 3;
  for (std::size_t c = 0; c < linear.columns.size(); ++c) {
    const EffectColumn& column = linear.columns[c];
    const bool of_marker = allEffects()[column.effect].has(ParameterKind::marker_id);
    const bool of_region = allEffects()[column.effect].has(ParameterKind::region);  // the first, neutral
    const bool of_sensor = allEffects()[column.effect].has(ParameterKind::sensor);  // the first, neutral
    const bool of_light = allEffects()[column.effect].text.channel == EffectChannel::image;
    const bool comes_and_goes = column.effect == kEffectIndex<TurbidityPlume>;
    const bool is_drawn = isDrawn(column.effect);
    const double h = 1e-3 * column.prior_sigma;
    Eigen::VectorXd ends[2];
    for (const int sign : {0, 1}) {
      BatchEstimate moved = linear_run.estimate;
      EffectParameters<double>& effects = moved.state.effects;
      if (of_marker) effects.values[kEffectOffsets[column.effect]] = marker_id;
      effects.on.set(column.effect);
      if (comes_and_goes) effects.values[kEffectOffsets[column.effect] + 1] = kPeak_s;
      const double step = sign == 0 ? -h : h;
      if (!is_drawn) effects.values[column.scalar] += step;
      for (const ImagePatch& patch : data.patches)
        if (is_drawn) moved.state.draws[{column.scalar, patch.image}] = step;
      const auto there = problemAt(data, moved, linear_run.options);
      ends[sign] = residuals(*there, Eigen::VectorXd::Zero(there->unknowns()));
    }
    Eigen::VectorXd expected = linear.C.col(static_cast<Eigen::Index>(c)),
                    found = ((ends[1] - ends[0]) / (2 * h)).head(linear.residual.size());
    for (std::size_t i = 0; i < linear.rows.size(); ++i) {
      const auto at = static_cast<Eigen::Index>(i);
      // Of one that comes and goes every row is taken for at the peak.
      if (comes_and_goes) expected[at] *= std::exp(-0.5 * std::pow((linear.rows[i].t_s - kPeak_s) / 10, 2));
      if (of_marker && linear.rows[i].markerSeen() != marker_id) expected[at] = 0;
      if (of_region && !kImageRegions[0].contains(linear.rows[i].image_place)) expected[at] = 0;
      if (of_sensor && sensorKindOf(linear.rows[i].channel) != 0) expected[at] = 0;
      if (linear.rows[i].channel == kChannel<Prior>) found[at] = 0;  // its own prior, where estimated
      // Light tells of water and camera, not of where things are.
      if (linear.rows[i].channel == kChannel<Pixels> && !of_light) found[at] = 0;
    }
    // A latency's derivative at a new base is the motion elsewhere: the spline's next derivative times h. A
    // port's tilt changes nothing where it has no thickness: rounding, of some 1e-14 px in each row, over h.
    EXPECT_LT((found - expected).norm(), 1e-4 * expected.norm() + std::max(1e-7, 2e-12 / h)) << column.name;
    if (expected.norm() > 1e-3) ++columns_seen;
  }
  // Without a peak it does not matter when it is, how wide and where; a lamp that is off scatters nothing;
  // through a port without thickness the camera is calibrated alike at any range; in the middle of a dome its
  // radius and thickness do not matter; what covers nothing has no albedo and no brightness; there is no
  // compass, and no surface of water below the camera.
  EXPECT_EQ(columns_seen + 17 + parameterSize<HeadingDisturbance>() + parameterSize<FlatWaterSurface>(),
            linear.columns.size());
}

TEST(Linearization, RowsSayWhatTheyAre) {
  const LinearRun linear_run;
  const BatchData& data = linear_run.input.data;
  const auto problem = problemAt(data, linear_run.estimate, linear_run.options);
  const Linearization linear = linearize(data, *problem);
  std::size_t in_tracks = 0, priors = 0;
  for (const auto& track : linear.tracks) {
    in_tracks += track.size();
    for (std::size_t i = 1; i < track.size(); ++i) {
      const RowInfo &a = linear.rows[track[i - 1]], &b = linear.rows[track[i]];
      EXPECT_LT(a.t_s, b.t_s);
      EXPECT_EQ(a.channel, b.channel);
      EXPECT_EQ(a.marker_id, b.marker_id);
      EXPECT_EQ(a.component, b.component);
    }
  }
  for (const RowInfo& row : linear.rows) {
    if (row.channel == kChannel<Prior>) ++priors;
    if (row.channel != kChannel<Markers>) continue;
    const BatchMarker& seen = data.markers[static_cast<std::size_t>(row.marker)];
    EXPECT_NEAR((seen.detection.corners_px[static_cast<std::size_t>(row.component / 2)] -
                 row.pixel)[row.component % 2],
                row.raw, 1e-9);
    const Pose T_odom_camera = linear_run.run.truth(row.t_s) * seen.T_robot_camera;
    const Pose T_odom_marker = linear_run.run.panel.T_odom_panel * seen.marker.T_panel_marker;
    EXPECT_NEAR(row.range_m, (T_odom_camera.position - T_odom_marker.position).norm(), 0.05);
    const Vector3d sight = (T_odom_camera.position - T_odom_marker.position).normalized();
    EXPECT_NEAR(std::cos(row.incidence_rad), sight.dot(T_odom_marker.rotation.col(2)), 0.02);
    EXPECT_NEAR(row.depth_m, -linear_run.run.truth(row.t_s).position.z(), 0.05);
  }
  EXPECT_EQ(in_tracks + priors, linear.rows.size());
  // At a minimum the weighted residual is at right angles to all nuisances: gradient against its terms.
  Linearization weighted = linear;
  applyRobustWeights(weighted);
  const Eigen::VectorXd gradient = weighted.J.transpose() * weighted.residual;
  const Eigen::VectorXd scale = weighted.J.cwiseAbs().transpose() * weighted.residual.cwiseAbs();
  EXPECT_LT(gradient.cwiseQuotient(scale.cwiseMax(1e-9)).cwiseAbs().maxCoeff(), 0.05);
}

// Light that is just what readings say leaves nothing of them, and what is put back is the first order of
// what it is; a reading weighs what it weighed, so that by a model that is larger by a factor it tells as
// much more.
TEST(Linearization, KnownLightIsPredictedAndPutBack) {
  const LinearRun linear_run(true);
  const BatchData& data = linear_run.input.data;
  const auto problem = problemAt(data, linear_run.estimate, linear_run.options);
  const Linearization nominal = linearize(data, *problem);
  // raw: the reading without the prediction. What is reflected cannot make up for it where it is mostly the
  // veil.
  const auto factorOf = [](const RowInfo& row, double whole) {
    return std::clamp(1 + row.raw / whole, 0.5, 2.0);
  };
  for (const bool is_level : {false, true}) {
    BatchEstimate lit = linear_run.estimate;
    lit.state.light.resize(data.patches.size());
    for (const RowInfo& row : nominal.rows) {
      if (row.patch < 0) continue;
      PatchLight& own = lit.state.light[static_cast<std::size_t>(row.patch)];
      if (is_level)
        own.level[row.component] = std::log(factorOf(row, row.level));
      else
        own.reflected[row.component] = std::log(factorOf(row, row.reflected));
    }
    const auto there = problemAt(data, lit, linear_run.options);
    const Linearization linear = linearize(data, *there);
    const Eigen::VectorXd left = residuals(*there, Eigen::VectorXd::Zero(there->unknowns()));
    const Eigen::MatrixXd J(linear.J), J0(nominal.J);
    std::size_t seen = 0;
    for (std::size_t i = 0; i < linear.rows.size(); ++i) {
      const RowInfo& row = nominal.rows[i];
      const auto k = static_cast<Eigen::Index>(i);
      if (row.patch < 0) {
        EXPECT_EQ(linear.residual[k], nominal.residual[k]);
        continue;
      }
      ++seen;
      const double whole = is_level ? row.level : row.reflected, factor = factorOf(row, whole);
      const double not_made_up = (row.raw - whole * (factor - 1)) * row.per_unit;
      EXPECT_NEAR(left[k], not_made_up, 1e-9 * std::abs(row.level * row.per_unit));
      EXPECT_NEAR(linear.residual[k], not_made_up + whole * factor * std::log(factor) * row.per_unit,
                  1e-9 * std::abs(row.level * row.per_unit));
      EXPECT_NEAR(linear.rows[i].per_unit, row.per_unit * (is_level ? factor : 1), 1e-9 * row.per_unit);
      if (is_level) EXPECT_LT((J.row(k) - factor * J0.row(k)).norm(), 1e-9 * J0.row(k).norm());
    }
    EXPECT_GT(seen, 20u);
  }
}

}  // namespace
}  // namespace fathom
