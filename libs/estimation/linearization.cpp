#include "estimation/linearization.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <tuple>

#include "core/parallel.h"
#include "core/stable_sort.h"
#include "core/text.h"
#include "effects/catalogue.h"
#include "estimation/wide_prior.h"

namespace fathom {
namespace {

/// By what the sigmas of an effect's prior are to be multiplied where it is estimated to be larger than that.
double priorWidthOf(const BatchProblem& problem, const EffectInfo& effect) {
  if (!problem.estimates(effect.index) || !hasWidePrior(effect.index)) return 1;
  double square = 0, dimensions = 0;
  for (const std::size_t scalar : continuousScalars(effect.index)) {
    square += std::pow(problem.reference().effects.values[scalar] / parameterOf(scalar).prior_sigma, 2);
    ++dimensions;
  }
  return 1 / std::sqrt(widePriorWeight(square, dimensions));
}

std::vector<EffectColumn> effectColumnsOf(const BatchProblem& problem) {
  std::vector<EffectColumn> columns;
  for (const EffectInfo& effect : allEffects()) {
    const double width = priorWidthOf(problem, effect);
    std::size_t scalar = effect.first_scalar;
    for (const Parameter& p : effect.parameters)
      for (int i = 0; i < p.size; ++i, ++scalar) {
        if (!isDifferentiated(p.kind)) continue;
        const std::string axis = p.size > 1 ? print("[%d]", i) : "";
        columns.push_back({effect.index, scalar, std::string(effect.id) + "." + std::string(p.name) + axis,
                           width * p.prior_sigma, problem.estimates(effect.index),
                           problem.reference().effects.on[effect.index]});
      }
  }
  return columns;
}

/// Of a patch, or a marker's edges.
template <class Seen>
void setPlace(RowInfo& info, const Seen& seen, const Motion& motion, const BatchState& state) {
  info.place = seen.place;
  info.panel = static_cast<std::ptrdiff_t>(seen.panel);
  info.image = static_cast<std::ptrdiff_t>(seen.image);
  info.eye = static_cast<std::ptrdiff_t>(seen.eye);
  info.pixel = seen.pixel;
  info.point_panel = seen.point_panel.template head<2>();
  const Pose T_camera_panel =
      (motion.T_odom_robot * seen.T_robot_camera).inverse() * state.T_odom_panel[seen.panel];
  const Vector3d point_camera = T_camera_panel * seen.point_panel;
  info.image_radius = point_camera.head<2>().norm() / point_camera.z();
  info.range_m = point_camera.norm();
  info.incidence_rad =
      std::acos(std::clamp(-T_camera_panel.rotation.col(2).dot(point_camera) / info.range_m, -1.0, 1.0));
}

/// Right and up, as its places have it.
Vector2d spreadOnPanel(const ImagePatch& patch) {
  Vector2d squares = Vector2d::Zero();
  for (const Vector3d& point : patch.around_panel)
    squares += (point.head<2>() - patch.at_panel_m).cwiseAbs2() / 4;
  return squares.cwiseSqrt();
}

/// What all rows of a reading have in common.
RowInfo commonInfo(const BatchData& data, const BatchProblem& problem, const RowSource& source) {
  RowInfo info;
  info.channel = source.channel;
  info.instance = source.instance;
  info.t_s = source.t_s;
  info.marker = source.marker;
  info.tie_point = source.tie_point;
  info.patch = source.patch;
  const BatchMarker* seen =
      source.marker < 0 ? nullptr : &data.markers[static_cast<std::size_t>(source.marker)];
  const ImagePatch* patch =
      source.patch < 0 ? nullptr : &data.patches[static_cast<std::size_t>(source.patch)];
  const MarkerBlur* blur = source.blur < 0 ? nullptr : &data.blurs[static_cast<std::size_t>(source.blur)];
  if (source.specks >= 0)
    info.image = static_cast<std::ptrdiff_t>(data.specks[static_cast<std::size_t>(source.specks)].image);
  if (source.texture >= 0)
    info.image = static_cast<std::ptrdiff_t>(data.textures[static_cast<std::size_t>(source.texture)].image);
  if (data.vehicle.camera) info.focal_px = data.vehicle.camera->model.fx_px;
  const bool is_of_image = seen != nullptr || patch != nullptr || blur != nullptr;
  if (!is_of_image && !problem.reference().path.isSpline()) return info;
  const Motion motion = problem.motionAt(source.t_s, seen != nullptr    ? seen->image
                                                     : patch != nullptr ? patch->image
                                                     : blur != nullptr  ? blur->image
                                                                        : 0);
  info.speed_m_s = motion.velocity_odom.norm();
  info.turn_rate_rad_s = motion.rate_robot.norm();
  info.depth_m = -motion.T_odom_robot.position.z();
  const Matrix3d R_robot_odom = motion.T_odom_robot.rotation.transpose();
  info.velocity_robot = R_robot_odom * motion.velocity_odom;
  info.force_robot = R_robot_odom * (motion.acceleration_odom - data.vehicle.gravityOdom());
  if (patch != nullptr) {
    setPlace(info, *patch, motion, problem.reference());
    info.image_radius = patch->image_radius;
    info.image_place = patch->image_place;
    // Of all of it: its middle pixel may be some centimetres from there.
    info.point_panel = patch->at_panel_m;
    info.panel_spread = spreadOnPanel(*patch);
    info.pixel_spread = patch->pixel_spread;
    if (patch->surface == ImagePatch::Surface::water) {
      info.range_m = info.incidence_rad = RowInfo::kNone;
      info.point_panel.setConstant(RowInfo::kNone);
    }
  }
  if (blur != nullptr) setPlace(info, *blur, motion, problem.reference());
  if (seen == nullptr) return info;
  info.marker_id = seen->marker.id;
  info.panel = static_cast<std::ptrdiff_t>(seen->panel);
  info.image = static_cast<std::ptrdiff_t>(seen->image);
  info.eye = static_cast<std::ptrdiff_t>(seen->eye);
  const Pose T_camera_marker = (motion.T_odom_robot * seen->T_robot_camera * seen->T_left_right).inverse() *
                               problem.reference().T_odom_panel[seen->panel] * seen->marker.T_panel_marker;
  info.range_m = T_camera_marker.position.norm();
  info.incidence_rad = std::acos(
      std::clamp(-T_camera_marker.rotation.col(2).dot(T_camera_marker.position) / info.range_m, -1.0, 1.0));
  return info;
}

void setPixel(RowInfo& info, const Vector2d& pixel, const CameraModel& camera) {
  info.pixel = pixel;
  info.focal_px = camera.fx_px;
  info.image_radius =
      std::hypot((pixel.x() - camera.cx_px) / camera.fx_px, (pixel.y() - camera.cy_px) / camera.fy_px);
}

/// Where it is predicted: what depends on the place in the image must not depend on a reading's own error,
/// which a steep field would make less of. raw: reading - prediction, of all corners.
void setCorner(RowInfo& info, const BatchMarker& seen, const Eigen::VectorXd& raw) {
  const auto corner = static_cast<std::size_t>(info.component / 2);
  setPixel(info, seen.detection.corners_px[corner] - raw.segment<2>(2 * (info.component / 2)), seen.camera);
  info.point_panel = seen.marker.corners_panel()[corner].head<2>();
}

void setTiePoint(RowInfo& info, const BatchTiePoint& seen, const Pose& T_left_right) {
  info.tie_point_id = seen.point.id;
  info.image = static_cast<std::ptrdiff_t>(seen.image);
  setPixel(info, seen.point.pixels[0], seen.cameras[0]);
  // Straight lines: near enough to sort by.
  const Vector3d left = seen.cameras[0].rayAt(seen.point.pixels[0]),
                 right = T_left_right.rotation * seen.cameras[1].rayAt(seen.point.pixels[1]);
  const double cosine = left.dot(right);
  const Vector3d toward = left - cosine * right;
  info.range_m = T_left_right.position.dot(toward) / (1 - cosine * cosine);
}

/// Of a patch, with its reading and that one's derivative by the water. Daylight's share is linear in
/// daylight.
void setLight(RowInfo& info, const ImagePatch& seen, double reading, const Eigen::VectorXd& by_water,
              const Vector9d& water) {
  const Eigen::Index daylight = 6 + info.component;
  info.level = reading - info.raw;
  info.reflected = std::abs(by_water[daylight] * water[daylight] / info.per_unit);
  info.surface = seen.surface;
  info.printed_on = seen.marker_id;
  info.seen_share = seen.seen_share;
}

/// Of a row of a patch: see BatchState::light.
PatchLight lightOf(const BatchState& reference, std::ptrdiff_t patch) {
  return reference.light.empty() ? PatchLight() : reference.light[static_cast<std::size_t>(patch)];
}

/// Takes for residual what the prediction has in its light.
void putBackLight(RowInfo& info, double& residual, const BatchState& reference) {
  const PatchLight light = lightOf(reference, info.patch);
  const int c = info.component;
  const double found = info.reflected * light.reflected[c] + info.level * light.level[c] + light.moved[c];
  info.raw += found;
  residual += found * info.per_unit;
}

/// Of the k-th row of a reading of an image. raw: of all its rows; J: its derivative, by the water from
/// water_column on.
void setSeen(RowInfo& info, Eigen::Index k, const BatchData& data, const BatchState& reference,
             const Eigen::VectorXd& raw, const Eigen::MatrixXd& J, Eigen::Index water_column) {
  if (info.patch >= 0) {
    const ImagePatch& seen = data.patches[static_cast<std::size_t>(info.patch)];
    info.component = seen.colours()[static_cast<std::size_t>(k)];
    const double factor = lightOf(reference, info.patch).ofReading()[info.component];
    setLight(info, seen, seen.radiance[info.component] / factor, J.row(k).segment(water_column, 9),
             reference.water);
  }
  if (info.marker >= 0) setCorner(info, data.markers[static_cast<std::size_t>(info.marker)], raw);
  if (info.tie_point >= 0)
    setTiePoint(info, data.tie_points[static_cast<std::size_t>(info.tie_point)], reference.T_left_right);
}

/// Of each row in the reading's unit: of what has been whitened.
Eigen::VectorXd rawSigmas(const BatchCost& cost, Eigen::Index rows) {
  const Eigen::MatrixXd units = cost.raw(Eigen::MatrixXd::Identity(rows, rows));
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(rows);
  for (Eigen::Index k = 0; k < rows; ++k) sigma += units.col(k).cwiseAbs2();
  return sigma.cwiseSqrt();
}

/// Tracks in the order of channel, instance, marker and component; rows by time.
void findTracks(Linearization& linear) {
  using Key = std::tuple<Channel, Instance, std::ptrdiff_t, int, std::ptrdiff_t, int, int, int>;
  std::map<Key, std::vector<std::size_t>> tracks;
  for (std::size_t i = 0; i < linear.rows.size(); ++i) {
    const RowInfo& row = linear.rows[i];
    if (row.channel == kChannel<Prior>) continue;
    tracks[{row.channel, row.instance, row.panel, row.marker_id, row.eye, row.tie_point_id, row.place,
            row.component}]
        .push_back(i);
  }
  for (auto& [key, rows] : tracks) {
    stableSort(rows, [&](std::size_t a, std::size_t b) { return linear.rows[a].t_s < linear.rows[b].t_s; });
    for (const std::size_t i : rows) linear.rows[i].track = static_cast<int>(linear.tracks.size());
    linear.tracks.push_back(std::move(rows));
  }
}

}  // namespace

Linearization linearize(const BatchData& data, const BatchProblem& problem, bool effect_columns) {
  Linearization linear;
  linear.blocks = problem.blocks();
  linear.draws = problem.draws();
  if (effect_columns) linear.columns = effectColumnsOf(problem);
  const auto& costs = problem.costs();
  std::vector<Eigen::Index> first(costs.size() + 1, 0);
  for (std::size_t i = 0; i < costs.size(); ++i) first[i + 1] = first[i] + costs[i]->num_residuals();
  linear.residual.resize(first.back());
  linear.rows.resize(static_cast<std::size_t>(first.back()));
  linear.C.resize(first.back(), std::ssize(linear.columns));
  linear.by_knots.setZero(first.back());

  // Each cost writes to places of its own, so that nothing depends on the number of threads.
  std::vector<std::vector<Eigen::Triplet<double>>> entries(costs.size()), taken(costs.size());
  const BatchPoint zero = problem.pointAt(Eigen::VectorXd::Zero(problem.unknowns()), true);
  parallelFor(costs.size(), [&](std::size_t i) {
    const BatchCost& cost = *costs[i];
    Eigen::VectorXd r;
    Eigen::MatrixXd J;
    cost.compute(zero, r, &J);
    linear.residual.segment(first[i], r.size()) = r;
    Eigen::Index column = 0, water_column = 0;
    for (const std::size_t b : cost.blocks) {
      if (linear.blocks[b].kind == UnknownBlock::Kind::water) water_column = column;
      for (int c = 0; c < linear.blocks[b].size; ++c, ++column)
        for (Eigen::Index k = 0; k < r.size(); ++k)
          entries[i].emplace_back(static_cast<int>(first[i] + k), linear.blocks[b].column + c, J(k, column));
    }
    const BatchCost::ByTaken by_taken = cost.byTaken(zero.motions);
    column = 0;
    for (const std::size_t b : by_taken.blocks)
      for (int c = 0; c < linear.blocks[b].size; ++c, ++column)
        for (Eigen::Index k = 0; k < r.size(); ++k)
          taken[i].emplace_back(static_cast<int>(first[i] + k), linear.blocks[b].column + c,
                                by_taken.derivative(k, column));
    if (effect_columns) {
      Eigen::MatrixXd all(r.size(), static_cast<Eigen::Index>(kEffectScalars));
      cost.effectColumns(zero.motions, all);
      for (std::size_t c = 0; c < linear.columns.size(); ++c)
        linear.C.block(first[i], static_cast<Eigen::Index>(c), r.size(), 1) =
            all.col(static_cast<Eigen::Index>(linear.columns[c].scalar));
      linear.by_knots.segment(first[i], r.size()) = cost.knotColumn(zero.motions);
    }
    RowInfo info = commonInfo(data, problem, cost.source);
    info.reading = i;
    info.robust_weight = cost.is_wide_prior ? widePriorWeight(r.squaredNorm(), static_cast<double>(r.size()))
                                            : huberWeight(r.norm(), cost.robust_threshold);
    info.robust_threshold = cost.robust_threshold;
    const Eigen::VectorXd raw = cost.raw(r);
    const Eigen::VectorXd sigma = rawSigmas(cost, r.size());
    for (Eigen::Index k = 0; k < r.size(); ++k) {
      info.component = static_cast<int>(k);
      info.raw = raw[k];
      info.per_unit = 1 / sigma[k];
      setSeen(info, k, data, problem.reference(), raw, J, water_column);
      if (info.patch >= 0) putBackLight(info, linear.residual[first[i] + k], problem.reference());
      linear.rows[static_cast<std::size_t>(first[i] + k)] = info;
    }
  });
  const auto matrixOf = [&](const std::vector<std::vector<Eigen::Triplet<double>>>& lists) {
    std::vector<Eigen::Triplet<double>> all;
    for (const auto& list : lists) all.insert(all.end(), list.begin(), list.end());
    Eigen::SparseMatrix<double> matrix(first.back(), problem.unknowns());
    matrix.setFromTriplets(all.begin(), all.end());
    return matrix;
  };
  linear.J = matrixOf(entries);
  linear.taken = matrixOf(taken);
  findTracks(linear);
  return linear;
}

Eigen::Index columnOf(const Linearization& linear, std::size_t effect, std::size_t scalar) {
  const auto column = std::find_if(linear.columns.begin(), linear.columns.end(), [&](const EffectColumn& c) {
    return c.scalar == kEffectOffsets[effect] + scalar;
  });
  if (column == linear.columns.end()) throw std::out_of_range("no continuous scalar of an effect");
  return column - linear.columns.begin();
}

Interval readingsSpan(const Linearization& linear) {
  Interval span{Interval::kForever_s, -Interval::kForever_s};
  for (const RowInfo& row : linear.rows)
    if (row.channel != kChannel<Prior>) {
      span.from_s = std::min(span.from_s, row.t_s);
      span.to_s = std::max(span.to_s, row.t_s);
    }
  return span;
}

void multiplyRows(Linearization& linear, const Eigen::VectorXd& factor) {
  linear.residual.array() *= factor.array();
  linear.C.array().colwise() *= factor.array();
  if (linear.by_knots.size() > 0) linear.by_knots.array() *= factor.array();
  linear.J = (factor.asDiagonal() * linear.J).eval();
  if (linear.taken.nonZeros() > 0) linear.taken = (factor.asDiagonal() * linear.taken).eval();
}

void applyRobustWeights(Linearization& linear) {
  Eigen::VectorXd root(linear.residual.size());
  for (Eigen::Index i = 0; i < root.size(); ++i)
    root[i] = std::sqrt(linear.rows[static_cast<std::size_t>(i)].robust_weight);
  multiplyRows(linear, root);
}

bool applyOtherRobustWeights(Linearization& linear, const std::vector<Channel>& channels,
                             const Eigen::VectorXd& left) {
  constexpr double kDiffers = 0.05;
  bool differs = false;
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(linear.residual.size());
  std::vector<double> weights;
  for (const RowInfo& row : linear.rows) weights.push_back(row.robust_weight);
  for (std::size_t first = 0, behind = 0; first < linear.rows.size(); first = behind) {
    while (behind < linear.rows.size() && linear.rows[behind].reading == linear.rows[first].reading) ++behind;
    if (std::find(channels.begin(), channels.end(), linear.rows[first].channel) == channels.end()) continue;
    const double before = linear.rows[first].robust_weight;
    const auto begin = static_cast<Eigen::Index>(first), count = static_cast<Eigen::Index>(behind - first);
    const double norm = left.segment(begin, count).norm() / std::sqrt(before);
    const double weight = huberWeight(norm, linear.rows[first].robust_threshold);
    differs = differs || std::abs(weight - before) > kDiffers * before;
    factor.segment(begin, count).setConstant(std::sqrt(weight / before));
    for (std::size_t i = first; i < behind; ++i) weights[i] = weight;
  }
  if (!differs) return false;
  for (std::size_t i = 0; i < weights.size(); ++i) linear.rows[i].robust_weight = weights[i];
  multiplyRows(linear, factor);
  return true;
}

}  // namespace fathom
