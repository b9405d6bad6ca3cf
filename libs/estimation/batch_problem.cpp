#include "estimation/batch_problem.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "core/chi_square.h"
#include "effects/drawn.h"
#include "estimation/reading_cost.h"

namespace fathom {
namespace {

using Kind = UnknownBlock::Kind;
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();
/// One standard deviation of each of ImageFlaw. Of light: what rounding leaves in means that it shifts alike.
const Flaws kFlawSigma{0.1, 0.3, 0.02 / 255, 0.02 / 255, 0.02 / 255};

/// W with W C W^T = 1. The symmetric one, so that each row stays as near to its own coordinate as can be.
Eigen::MatrixXd whitener(const Eigen::MatrixXd& covariance) {
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance).operatorInverseSqrt();
}

Eigen::MatrixXd whitener(const Eigen::VectorXd& sigma) {
  return sigma.cwiseInverse().asDiagonal().toDenseMatrix();
}

Eigen::MatrixXd whitener(int size, double sigma) { return Eigen::MatrixXd::Identity(size, size) / sigma; }

/// Marker ids and times are this row's own: what acts here.
void setDiscrete(ForwardPoint& point, int marker_id, double t_s) {
  for (std::size_t s = 0; s < kEffectScalars; ++s) {
    if (parameterOf(s).kind == ParameterKind::marker_id) point.effects[s] = marker_id;
    if (parameterOf(s).kind == ParameterKind::time) point.effects[s] = -Interval::kForever_s;
    if (parameterOf(s).kind == ParameterKind::peak_time) point.effects[s] = t_s;
  }
}

}  // namespace

std::vector<std::size_t> continuousScalars(std::size_t effect) {
  std::vector<std::size_t> list;
  for (std::size_t s = kEffectOffsets[effect]; s < kEffectOffsets[effect + 1]; ++s)
    if (isEstimated(parameterOf(s).kind)) list.push_back(s);
  return list;
}

void BatchCost::finishSetup(const std::vector<UnknownBlock>& unknowns, int rows) {
  set_num_residuals(rows);
  for (const std::size_t b : blocks) {
    sizes_.push_back(unknowns[b].size);
    mutable_parameter_block_sizes()->push_back(unknowns[b].size);
  }
}

double huberWeight(double norm, double threshold) {
  return threshold > 0.0 && norm > threshold ? threshold / norm : 1.0;
}

void BatchCost::prepare(const BatchPoint& at, bool with_derivative) {
  compute(at, residual_, with_derivative ? &derivative_ : nullptr);
}

bool BatchCost::Evaluate(double const* const*, double* residuals, double** jacobians) const {
  Eigen::Map<Eigen::VectorXd>(residuals, residual_.size()) = residual_;
  if (jacobians == nullptr) return residual_.allFinite();
  Eigen::Index column = 0;
  for (std::size_t b = 0; b < sizes_.size(); ++b) {
    if (jacobians[b] != nullptr)
      for (Eigen::Index i = 0; i < residual_.size(); ++i)
        for (int c = 0; c < sizes_[b]; ++c) jacobians[b][i * sizes_[b] + c] = derivative_(i, column + c);
    column += sizes_[b];
  }
  return residual_.allFinite();
}

BatchProblem::BatchProblem(const BatchData& data, const ProblemOptions& options, const BatchState& reference)
    : data_(data), options_(options), reference_(reference) {
  layOut();
  addReadings();
  addMarkers();
  addTiePoints();
  addPatches();
  addBlurs();
  addSpecks();
  addPriors();
}

/// Unknowns in the order in which a sparse factorization without fill eliminates them: poses by time, a bias
/// behind the last pose that shares a reading with it, then what is constant.
void BatchProblem::layOut() {
  struct Placed {
    double at_s;
    UnknownBlock block;
  };
  std::vector<Placed> placed;
  const double knot_s = reference_.path.knot_s;
  for (std::size_t i = 0; i < reference_.path.poses.size(); ++i)
    placed.push_back({knot_s * (static_cast<double>(i) - 1.0), {Kind::pose, i, 6, 0}});
  for (std::size_t i = 0; i < reference_.bias.size(); ++i)
    placed.push_back(
        {reference_.bias_interval_s * (static_cast<double>(i) + 1.0) + 3.5 * knot_s, {Kind::bias, i, 6, 0}});
  std::stable_sort(placed.begin(), placed.end(),
                   [](const Placed& a, const Placed& b) { return a.at_s < b.at_s; });
  for (const Placed& p : placed) blocks_.push_back(p.block);
  if (!data_.pressure.empty() && reference_.path.isSpline())
    blocks_.push_back({Kind::pressure_offset, 0, 1, 0});
  for (std::size_t i = 0; i < data_.panels.size(); ++i)
    if (data_.panels[i].position_sigma_m > 0 && data_.panels[i].angle_sigma_rad > 0)
      blocks_.push_back({Kind::panel, i, 6, 0});
  if (!data_.tie_points.empty()) blocks_.push_back({Kind::right_camera, 0, 6, 0});
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (isDrawn(e) && (options_.estimate[e] || reference_.effects.on[e])) addDraws(e);
  for (std::size_t i = 0; i < draws_.size(); ++i) blocks_.push_back({Kind::draw, i, 1, 0});
  if (!data_.patches.empty()) blocks_.push_back({Kind::water, 0, 9, 0});
  if (!data_.patches.empty() || !data_.blurs.empty() || !data_.specks.empty())
    blocks_.push_back({Kind::flaws, 0, kFlaws, 0});
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (const auto size = std::ssize(continuousScalars(e)); options_.estimate[e] && size > 0)
      blocks_.push_back({Kind::effect, e, static_cast<int>(size), 0});
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    blocks_[b].column = unknowns_;
    unknowns_ += blocks_[b].size;
    block_of_[{blocks_[b].kind, blocks_[b].index}] = b;
  }
  for (std::size_t i = 0; i < reference_.images.size(); ++i) {
    image_pose_.resize(std::max(image_pose_.size(), reference_.images[i] + 1), kNone);
    image_pose_[reference_.images[i]] = i;
  }
}

void BatchProblem::addDraws(std::size_t effect) {
  std::set<std::size_t> images;
  for (const ImagePatch& patch : data_.patches)
    if (reference_.effects.active_s[effect].contains(patch.t_s)) images.insert(patch.image);
  for (std::size_t s = kEffectOffsets[effect]; s < kEffectOffsets[effect + 1]; ++s)
    for (const std::size_t image : images)
      if (parameterOf(s).kind == ParameterKind::spread) draws_.push_back({s, image});
}

const UnknownBlock* BatchProblem::find(Kind kind, std::size_t index) const {
  const auto found = block_of_.find({kind, index});
  return found == block_of_.end() ? nullptr : &blocks_[found->second];
}

PosePath BatchProblem::pathAt(const Eigen::VectorXd& x) const {
  PosePath path = reference_.path;
  for (const UnknownBlock& block : blocks_)
    if (block.kind == Kind::pose)
      path.poses[block.index] = retracted(path.poses[block.index], x.segment<6>(block.column));
  return path;
}

BatchPoint BatchProblem::pointAt(const Eigen::VectorXd& x, bool with_derivatives) const {
  return {x, motions_.at(pathAt(x), with_derivatives)};
}

BatchState BatchProblem::at(const Eigen::VectorXd& x) const {
  BatchState state = reference_;
  state.path = pathAt(x);
  for (const UnknownBlock& block : blocks_) {
    const auto e = x.segment(block.column, block.size);
    if (block.kind == Kind::panel)
      state.T_odom_panel[block.index] = retracted(state.T_odom_panel[block.index], e);
    if (block.kind == Kind::right_camera) state.T_left_right = retracted(state.T_left_right, e);
    if (block.kind == Kind::water) state.water += e;
    if (block.kind == Kind::flaws) state.flaws += e;
    if (block.kind == Kind::bias) state.bias[block.index] += e;
    if (block.kind == Kind::pressure_offset) state.pressure_offset_pa += e[0];
    if (block.kind == Kind::draw) {
      state.draws[draws_[block.index]] += e[0];
      state.effects.on.set(effectOf(draws_[block.index].scalar));
    }
    if (block.kind == Kind::effect) {
      state.effects.on.set(block.index);
      int i = 0;
      for (const std::size_t s : continuousScalars(block.index)) state.effects.values[s] += e[i++];
    }
  }
  return state;
}

std::vector<BatchCost*> BatchProblem::touchedBy(const std::bitset<kEffectCount>& effects) const {
  std::vector<BatchCost*> all, touched;
  std::vector<std::vector<BatchCost*>> sharing(blocks_.size());
  std::vector<std::size_t> reached;
  std::set<BatchCost*> seen;
  const auto touch = [&](BatchCost* cost) {
    if (seen.insert(cost).second) reached.insert(reached.end(), cost->blocks.begin(), cost->blocks.end());
  };
  for (const auto& cost : costs_) {
    all.push_back(cost.get());
    for (const std::size_t b : cost->blocks) sharing[b].push_back(cost.get());
    for (std::size_t e = 0; e < kEffectCount; ++e)
      if (effects[e] && cost->dependsOn(e)) touch(cost.get());
  }
  std::vector<bool> done(blocks_.size());
  while (!reached.empty()) {
    const std::size_t block = reached.back();
    reached.pop_back();
    if (done[block]) continue;
    done[block] = true;
    if (blocks_[block].kind == Kind::pose) return all;
    for (BatchCost* cost : sharing[block]) touch(cost);
  }
  std::copy_if(all.begin(), all.end(), std::back_inserter(touched),
               [&](BatchCost* cost) { return seen.contains(cost); });
  return touched;
}

MotionNode BatchProblem::nodeOf(double t_s, std::size_t image) const {
  if (reference_.path.isSpline()) return reference_.path.nodeAt(t_s);
  return {static_cast<int>(image_pose_[image]), 1, 0.0};
}

Motion BatchProblem::motionAt(double t_s, std::size_t image) const {
  return motionOf(reference_.path, nodeOf(t_s, image));
}

std::bitset<kEffectCount> BatchProblem::actingOn(const ReadingModel& model, const RowSource& source) const {
  std::bitset<kEffectCount> acting;
  for (std::size_t e = 0; e < kEffectCount; ++e) {
    const bool on = reference_.effects.on[e] || options_.estimate[e];
    if (!on || !reference_.effects.active_s[e].contains(source.t_s) || !model.dependsOn(e)) continue;
    bool acts = true;
    for (std::size_t s = kEffectOffsets[e]; s < kEffectOffsets[e + 1]; ++s) {
      const double value = reference_.effects.values[s];
      if (parameterOf(s).kind == ParameterKind::marker_id)
        acts = acts && source.marker >= 0 &&
               static_cast<int>(std::lround(value)) ==
                   data_.markers[static_cast<std::size_t>(source.marker)].marker.id;
      if (parameterOf(s).kind == ParameterKind::time) acts = acts && source.t_s >= value;
    }
    acting[e] = acts;
  }
  return acting;
}

double BatchProblem::thresholdOf(BatchChannel channel, Eigen::Index rows) {
  const bool robust = channel == BatchChannel::dvl || channel == BatchChannel::usbl ||
                      channel == BatchChannel::markers || channel == BatchChannel::tie_points ||
                      channel == BatchChannel::pixels || channel == BatchChannel::edges ||
                      channel == BatchChannel::specks;
  if (!robust || options_.robust_probability >= 1.0) return 0.0;
  const auto [known, is_new] = robust_thresholds_.try_emplace(rows);
  if (is_new)
    known->second = std::sqrt(chiSquareQuantile(static_cast<double>(rows), options_.robust_probability));
  return known->second;
}

void BatchProblem::add(std::unique_ptr<ReadingModel> model, RowSource source, std::vector<double> node_s,
                       Eigen::VectorXd reading, const Eigen::MatrixXd& whitening) {
  auto cost = std::make_unique<ReadingCost>(motions_, blocks_);
  const BatchMarker* marker =
      source.marker < 0 ? nullptr : &data_.markers[static_cast<std::size_t>(source.marker)];
  const ImagePatch* patch =
      source.patch < 0 ? nullptr : &data_.patches[static_cast<std::size_t>(source.patch)];
  const MarkerBlur* blur = source.blur < 0 ? nullptr : &data_.blurs[static_cast<std::size_t>(source.blur)];
  ForwardPoint& point = cost->at_reference;

  // What acts on it.
  setDiscrete(point, marker == nullptr ? -1 : marker->marker.id, source.t_s);
  cost->acting = actingOn(*model, source);
  for (const EffectInfo& effect : allEffects())
    cost->told[effect.index] =
        model->dependsOn(effect.index) && (patch == nullptr || effect.text.channel == EffectChannel::image);
  point.on = cost->acting;
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (cost->acting[e])
      for (const std::size_t s : continuousScalars(e)) point.effects[s] = reference_.effects.values[s];
  const auto [panel, image] = marker != nullptr  ? std::array{marker->panel, marker->image}
                              : patch != nullptr ? std::array{patch->panel, patch->image}
                              : blur != nullptr  ? std::array{blur->panel, blur->image}
                                                 : std::array{kNone, kNone};
  if (panel != kNone) point.T_odom_panel = reference_.T_odom_panel[panel];
  point.water = reference_.water;
  point.flaws = reference_.flaws;
  point.T_left_right = reference_.T_left_right;

  // When it was valid, and which poses that makes.
  point.validity_s = model->validity_s(point);
  if (node_s.size() == 2 && node_s[0] == node_s[1]) node_s.pop_back();
  std::vector<MotionNode> nodes;
  for (const double t_s : node_s) nodes.push_back(nodeOf(t_s + point.validity_s, image));
  if (nodes.empty()) nodes.push_back({0, 0, 0.0});  // whatever the robot's pose
  for (const MotionNode& node : nodes) cost->motions.push_back(motions_.add(node));
  if (patch != nullptr || blur != nullptr) point.motion = motionAt(source.t_s + point.validity_s, image);
  const auto [first, last] = std::minmax_element(
      nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  cost->first_pose = first->first;
  cost->pose_count = last->first + last->count - first->first;
  for (int k = 0; k < cost->pose_count; ++k)
    cost->blocks.push_back(block_of_.at({Kind::pose, static_cast<std::size_t>(cost->first_pose + k)}));

  // What else it tells of.
  const auto link = [&](Kind kind, std::size_t index, const std::vector<std::size_t>& to, int coordinate,
                        double factor) {
    cost->blocks.push_back(block_of_.at({kind, index}));
    for (const std::size_t s : to) cost->links.push_back({s, cost->blocks.size() - 1, coordinate++, factor});
  };
  const auto other = [&](Kind kind, std::size_t index, int column) {
    cost->others.push_back({cost->blocks.size(), column});
    cost->blocks.push_back(block_of_.at({kind, index}));
  };
  if (marker != nullptr && block_of_.contains({Kind::panel, panel})) other(Kind::panel, panel, kPanelColumn);
  if (source.tie_point >= 0) other(Kind::right_camera, 0, kRightColumn);
  if (patch != nullptr) other(Kind::water, 0, kWaterColumn);
  if (patch != nullptr || blur != nullptr || source.specks >= 0) other(Kind::flaws, 0, kFlawColumn);
  const bool is_gyro = source.channel == BatchChannel::gyro,
             is_force = source.channel == BatchChannel::accelerometer;
  if ((is_gyro || is_force) && !reference_.bias.empty()) {
    const std::size_t effect = is_gyro ? kEffectIndex<GyroBias> : kEffectIndex<AccelerometerBias>;
    const int first_axis = is_gyro ? 0 : 3;
    point.on.set(effect);
    const double at = std::clamp((source.t_s - reference_.path.begin_s) / reference_.bias_interval_s, 0.0,
                                 static_cast<double>(reference_.bias.size()) - 1.0);
    const auto k = std::min(static_cast<std::size_t>(at), reference_.bias.size() - 2);
    const double share = at - static_cast<double>(k);
    const auto axes = continuousScalars(effect);
    link(Kind::bias, k, axes, first_axis, 1.0 - share);
    link(Kind::bias, k + 1, axes, first_axis, share);
    for (std::size_t i = 0; i < 3; ++i)
      point.effects[axes[i]] += (1.0 - share) * reference_.bias[k][first_axis + static_cast<int>(i)] +
                                share * reference_.bias[k + 1][first_axis + static_cast<int>(i)];
  }
  if (source.channel == BatchChannel::depth) {
    const auto scalar = continuousScalars(kEffectIndex<PressureOffset>);
    point.on.set(kEffectIndex<PressureOffset>);
    point.effects[scalar[0]] += reference_.pressure_offset_pa;
    link(Kind::pressure_offset, 0, scalar, 0, 1.0);
  }
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (cost->acting[e] && cost->told[e] && block_of_.contains({Kind::effect, e}))
      link(Kind::effect, e, continuousScalars(e), 0, 1.0);
  for (std::size_t i = 0; patch != nullptr && i < draws_.size(); ++i) {
    const auto& [scalar, of_image] = draws_[i];
    if (of_image != image || !cost->acting[effectOf(scalar)]) continue;
    point.effects[scalar] = reference_.drawn(draws_[i]);
    link(Kind::draw, i, {scalar}, 0, 1.0);
  }

  cost->model = std::move(model);
  cost->source = source;
  cost->whitening = whitening / options_.noise_scale[static_cast<std::size_t>(source.channel)];
  cost->robust_threshold = thresholdOf(source.channel, reading.size());
  cost->reading = std::move(reading);
  cost->finish();
  costs_.push_back(std::move(cost));
}

void BatchProblem::addReadings() {
  if (!reference_.path.isSpline()) return;
  const Vehicle& vehicle = data_.vehicle;
  const auto addBins = [&](const std::vector<InsBin>& bins, BatchChannel channel, double sigma,
                           const auto& make) {
    for (const InsBin& bin : bins)
      add(make(bin), {channel, bin.t_s()}, {bin.node_s[0], bin.node_s[1]}, bin.mean,
          whitener(3, sigma / std::sqrt(bin.samples)));
  };
  if (vehicle.ins) {
    addBins(data_.gyro, BatchChannel::gyro, vehicle.ins->gyro_sigma_rad_s, gyroModel);
    addBins(data_.force, BatchChannel::accelerometer, vehicle.ins->accelerometer_sigma_m_s2,
            [&](const InsBin& bin) { return forceModel(bin, vehicle); });
    addBins(data_.attitude, BatchChannel::attitude, vehicle.ins->attitude_sigma_rad.value_or(1.0),
            attitudeModel);
  }
  for (const BatchDvl& dvl : data_.dvl) {
    const DvlSheet& sheet = *vehicle.dvl;
    const Eigen::VectorXd sigma =
        Vector3d(sheet.velocity_sigma_xy_m_s, sheet.velocity_sigma_xy_m_s, sheet.velocity_sigma_z_m_s);
    add(dvlModel(dvl), {BatchChannel::dvl, dvl.t_s}, {dvl.t_s}, dvl.velocity_dvl, whitener(sigma));
  }
  for (const BatchPressure& p : data_.pressure)
    add(pressureModel(p, vehicle), {BatchChannel::depth, p.t_s}, {p.t_s},
        Eigen::VectorXd::Constant(1, p.pressure_pa), whitener(1, vehicle.depth->pressure_sigma_pa));
  for (const BatchUsbl& usbl : data_.usbl)
    add(usblModel(usbl, vehicle), {BatchChannel::usbl, usbl.t_s}, {usbl.t_s}, usbl.position_odom,
        whitener(Eigen::MatrixXd(usbl.covariance_m2)));
}

void BatchProblem::addMarkers() {
  for (std::size_t i = 0; i < data_.markers.size(); ++i) {
    BatchMarker seen = data_.markers[i];
    if (!hasPose(seen.image)) continue;
    const Pose T_odom_camera =
        motionAt(seen.t_s, seen.image).T_odom_robot * seen.T_robot_camera * seen.T_left_right;
    const Vector3d centre_odom = reference_.T_odom_panel[seen.panel] * seen.marker.T_panel_marker.position;
    const double z_m = (T_odom_camera.inverse() * centre_odom).z();
    if (z_m < seen.marker.size_m) {
      ++behind_camera_;
      continue;
    }
    seen.light = {data_.vehicle.camera ? data_.vehicle.camera->response_gamma : 1.0,
                  darkOverBright(data_.panels[seen.panel], environmentOf(reference_.water), z_m)};
    Vector8d corners;
    for (std::size_t k = 0; k < 4; ++k)
      corners.segment<2>(static_cast<Eigen::Index>(2 * k)) = seen.detection.corners_px[k];
    add(markerModel(seen), {BatchChannel::markers, seen.t_s, static_cast<std::ptrdiff_t>(i)}, {seen.t_s},
        corners, whitener(Eigen::MatrixXd(seen.detection.covariance_px2)));
  }
}

void BatchProblem::addTiePoints() {
  for (std::size_t i = 0; i < data_.tie_points.size(); ++i) {
    const BatchTiePoint& seen = data_.tie_points[i];
    add(tiePointModel(seen), {BatchChannel::tie_points, seen.t_s, -1, static_cast<std::ptrdiff_t>(i)}, {},
        Eigen::VectorXd::Zero(1), whitener(1, 1.0));
  }
}

bool BatchProblem::hasPose(std::size_t image) const {
  return reference_.path.isSpline() || (image < image_pose_.size() && image_pose_[image] != kNone);
}

/// Light tells of water and camera, not of where things are: by what dies away on the way it would measure
/// ranges to a tenth of a millimetre, and every flaw of its own model would move path and calibration. So
/// poses are taken as they are at the reference.
void BatchProblem::addPatches() {
  for (std::size_t i = 0; i < data_.patches.size(); ++i) {
    const ImagePatch& seen = data_.patches[i];
    if (!hasPose(seen.image)) continue;
    const std::vector<int> colours = seen.colours();
    const Eigen::VectorXd reading = seen.radiance(colours);
    const double scale = options_.noise_scale[static_cast<std::size_t>(BatchChannel::pixels)];
    const Eigen::ArrayXd scatter = options_.light_scatter / scale * reading.array();
    const Eigen::VectorXd sigma = (seen.sigma(colours).array().square() + scatter.square()).sqrt();
    add(patchModel(seen, data_.vehicle),
        {BatchChannel::pixels, seen.t_s, -1, -1, static_cast<std::ptrdiff_t>(i)}, {}, reading,
        whitener(sigma));
  }
}

/// Poses as they are, for the same reason.
void BatchProblem::addBlurs() {
  for (std::size_t i = 0; i < data_.blurs.size(); ++i) {
    const MarkerBlur& seen = data_.blurs[i];
    if (!hasPose(seen.image)) continue;
    RowSource source{BatchChannel::edges, seen.t_s};
    source.blur = static_cast<std::ptrdiff_t>(i);
    add(blurModel(seen), source, {}, seen.variance_px2, whitener(Eigen::MatrixXd(seen.covariance_px4)));
  }
}

void BatchProblem::addSpecks() {
  for (std::size_t i = 0; i < data_.specks.size(); ++i) {
    const ImageSpecks& seen = data_.specks[i];
    RowSource source{BatchChannel::specks, seen.t_s};
    source.specks = static_cast<std::ptrdiff_t>(i);
    add(specksModel(seen), source, {}, seen.counted.matrix(), whitener(Eigen::VectorXd(seen.sigma)));
  }
}

void BatchProblem::addLinear(const UnknownBlock& block, const Eigen::VectorXd& value,
                             const Eigen::MatrixXd& slope) {
  costs_.push_back(std::make_unique<LinearCost>(blocks_, std::vector{block_of_.at({block.kind, block.index})},
                                                value, slope));
}

void BatchProblem::addPosePrior(const UnknownBlock& block, const Pose& nominal, const Pose& reference,
                                double position_sigma_m, double angle_sigma_rad) {
  Vector6d precision;
  precision << Vector3d::Constant(1.0 / position_sigma_m), Vector3d::Constant(1.0 / angle_sigma_rad);
  const Vector6d error = poseDifference(nominal, reference);
  Matrix6d slope = Matrix6d::Identity();
  slope.bottomRightCorner<3, 3>() = inverseRightJacobianSO3<double>(error.tail<3>());
  addLinear(block, precision.cwiseProduct(error), precision.asDiagonal() * slope);
}

void BatchProblem::addPriors() {
  const PosePath& path = reference_.path;
  if (path.isSpline()) {
    Vector6d sigma;
    sigma << Vector3d::Constant(options_.acceleration_sigma_m_s2),
        Vector3d::Constant(options_.angular_acceleration_sigma_rad_s2);
    const auto segments = path.poses.size() - 3;
    for (std::size_t i = 0; i <= segments; ++i) {
      const double t_s = path.begin_s + path.knot_s * static_cast<double>(i);
      add(accelerationModel(t_s), {BatchChannel::prior, t_s}, {t_s}, Vector6d::Zero(),
          whitener(Eigen::VectorXd(sigma)));
    }
    if (const auto& prior = options_.path_prior) {
      // Position and heading; roll and pitch are gravity's.
      Vector6d reading, precision;
      reading << prior->T_odom_robot.position, Vector3d::Zero();
      precision << Vector3d::Constant(1.0 / prior->position_sigma_m), 0.0, 0.0,
          1.0 / prior->heading_sigma_rad;
      add(poseModel(prior->T_odom_robot, path.begin_s), {BatchChannel::prior, path.begin_s}, {path.begin_s},
          reading, precision.asDiagonal().toDenseMatrix());
    }
  }
  // First-order Gauss-Markov: stationary at first, then b' = phi b + noise.
  for (std::size_t k = 0; k < reference_.bias.size(); ++k) {
    const InsSheet& ins = *data_.vehicle.ins;
    Vector6d precision;
    precision << Vector3d::Constant(1.0 / ins.gyro_bias_sigma_rad_s),
        Vector3d::Constant(1.0 / ins.accelerometer_bias_sigma_m_s2);
    const double phi = k == 0 ? 0.0 : std::exp(-reference_.bias_interval_s / ins.bias_time_constant_s);
    precision /= std::sqrt(1.0 - phi * phi);
    Eigen::MatrixXd slope(6, k == 0 ? 6 : 12);
    slope.leftCols<6>() = precision.asDiagonal();
    Vector6d value = precision.cwiseProduct(reference_.bias[k]);
    std::vector<std::size_t> of{block_of_.at({Kind::bias, k})};
    if (k > 0) {
      slope.rightCols<6>() = (-phi * precision).asDiagonal();
      value -= phi * precision.cwiseProduct(reference_.bias[k - 1]);
      of.push_back(block_of_.at({Kind::bias, k - 1}));
    }
    costs_.push_back(std::make_unique<LinearCost>(blocks_, of, value, slope));
    costs_.back()->source.t_s = reference_.path.begin_s + reference_.bias_interval_s * static_cast<double>(k);
  }
  for (const UnknownBlock& block : blocks_) {
    if (block.kind == Kind::pressure_offset) {
      const double precision = 1.0 / data_.vehicle.depth->pressure_offset_sigma_pa;
      addLinear(block, Eigen::VectorXd::Constant(1, precision * reference_.pressure_offset_pa),
                Eigen::MatrixXd::Constant(1, 1, precision));
    }
    if (block.kind == Kind::panel) {
      const PanelMap& map = data_.panels[block.index];
      addPosePrior(block, map.T_odom_panel, reference_.T_odom_panel[block.index], map.position_sigma_m,
                   map.angle_sigma_rad);
    }
    if (block.kind == Kind::right_camera) {
      const CameraSheet camera = data_.vehicle.camera.value_or(CameraSheet{});
      addPosePrior(block, data_.tie_points[0].T_left_right, reference_.T_left_right,
                   camera.right_position_sigma_m, camera.right_angle_sigma_rad);
    }
    if (block.kind == Kind::water) {
      // So wide that only what the patches tell nothing of feels it.
      constexpr double kAttenuation_per_m = 2.0, kVeil = 0.5, kAmbient = 1.0;
      Vector9d sigma;
      sigma << Vector3d::Constant(kAttenuation_per_m), Vector3d::Constant(kVeil),
          Vector3d::Constant(kAmbient);
      const Vector9d precision = sigma.cwiseInverse();
      addLinear(block, precision.cwiseProduct(reference_.water - waterParameters(data_.water)),
                precision.asDiagonal().toDenseMatrix());
    }
    if (block.kind == Kind::draw) {
      // What was found of its spread, or what one would expect.
      const Draw& draw = draws_[block.index];
      const double known = reference_.effects.values[draw.scalar];
      const bool is_known = known > 0 && !options_.estimate[effectOf(draw.scalar)];
      const double precision = 1 / (is_known ? known : parameterOf(draw.scalar).prior_sigma);
      addLinear(block, Eigen::VectorXd::Constant(1, precision * reference_.drawn(draw)),
                Eigen::MatrixXd::Constant(1, 1, precision));
    }
    if (block.kind == Kind::flaws)
      addLinear(block, reference_.flaws.cwiseQuotient(kFlawSigma),
                kFlawSigma.cwiseInverse().asDiagonal().toDenseMatrix());
    if (block.kind == Kind::effect) {
      Eigen::VectorXd precision(block.size), value(block.size);
      int i = 0;
      for (const std::size_t s : continuousScalars(block.index)) {
        precision[i] = 1.0 / parameterOf(s).prior_sigma;
        value[i++] = reference_.effects.values[s];
      }
      addLinear(block, precision.cwiseProduct(value), precision.asDiagonal().toDenseMatrix());
    }
  }
}

BatchState startState(const BatchData& data, const std::vector<double>& times_s,
                      const std::vector<Pose>& T_odom_robot, const EffectParameters<double>& effects,
                      double bias_interval_s) {
  BatchState state;
  state.effects = effects;
  for (const PanelMap& panel : data.panels) state.T_odom_panel.push_back(panel.T_odom_panel);
  if (!data.tie_points.empty()) state.T_left_right = data.tie_points[0].T_left_right;
  if (!data.patches.empty()) state.water = waterParameters(data.water);
  if (!data.hasMotion()) {
    for (const BatchMarker& seen : data.markers) {
      if (!state.images.empty() && state.images.back() == seen.image) continue;
      const auto found = std::find(times_s.begin(), times_s.end(), seen.t_s);
      if (found == times_s.end()) continue;
      state.images.push_back(seen.image);
      state.path.poses.push_back(T_odom_robot[static_cast<std::size_t>(found - times_s.begin())]);
    }
    return state;
  }
  const double begin_s = std::floor(data.first_s / data.knot_s + 1e-6) * data.knot_s;
  state.path = PosePath::splineNear(times_s, T_odom_robot, begin_s, data.last_s, data.knot_s);
  if (data.vehicle.ins && !(data.gyro.empty() && data.force.empty())) {
    state.bias_interval_s = bias_interval_s;
    const double length_s = state.path.end_s() - begin_s;
    const auto intervals = std::max(1.0, std::ceil(length_s / bias_interval_s));
    state.bias.assign(static_cast<std::size_t>(intervals) + 1, Vector6d::Zero());
  }
  return state;
}

}  // namespace fathom
