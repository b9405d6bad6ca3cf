#include "estimation/batch_problem.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "core/linear_algebra.h"
#include "estimation/batch_priors.h"
#include "estimation/reading_cost.h"
#include "sensors/channel_model.h"

namespace fathom {
namespace {

/// W with W C W^T = 1. The symmetric one, so that each row stays as near to its own coordinate as can be.
Eigen::MatrixXd whitener(const Eigen::MatrixXd& covariance) {
  if (!covariance.isDiagonal(0)) return symmetricWhitener(covariance);
  return covariance.diagonal().cwiseSqrt().cwiseInverse().asDiagonal().toDenseMatrix();
}

Eigen::MatrixXd whitener(const Eigen::VectorXd& sigma) {
  return sigma.cwiseInverse().asDiagonal().toDenseMatrix();
}

Eigen::MatrixXd whitener(int size, double sigma) { return Eigen::MatrixXd::Identity(size, size) / sigma; }

}  // namespace

BatchProblem::BatchProblem(const BatchData& data, const ProblemOptions& options, const BatchState& reference)
    : data_(data),
      options_(options),
      unknowns_(data, options.estimate, reference),
      maker_(data_, options_, unknowns_, motions_) {
  addReadings();
  addMarkers();
  addTiePoints();
  addPatches();
  addBlurs();
  addSpecks();
  addTextures();
  addMotionPriors();
  addDriftPriors();
  addPriorsOfConstants();
}

BatchPoint BatchProblem::pointAt(const Eigen::VectorXd& x, bool with_derivatives) const {
  return {x, motions_.at(unknowns_.pathAt(x), with_derivatives)};
}

std::vector<BatchCost*> BatchProblem::touchedBy(const std::bitset<kEffectCount>& effects) const {
  std::vector<BatchCost*> all, touched;
  std::vector<std::vector<BatchCost*>> sharing(unknowns_.blocks().size());
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
  std::vector<bool> done(unknowns_.blocks().size());
  while (!reached.empty()) {
    const std::size_t block = reached.back();
    reached.pop_back();
    if (done[block]) continue;
    done[block] = true;
    if (unknowns_.blocks()[block].kind == UnknownBlock::Kind::pose) return all;
    for (BatchCost* cost : sharing[block]) touch(cost);
  }
  std::copy_if(all.begin(), all.end(), std::back_inserter(touched),
               [&](BatchCost* cost) { return seen.contains(cost); });
  return touched;
}

void BatchProblem::add(std::unique_ptr<ReadingModel> model, const RowSource& source,
                       std::vector<double> node_s, Eigen::VectorXd reading,
                       const Eigen::MatrixXd& whitening) {
  costs_.push_back(maker_.make(std::move(model), source, std::move(node_s), std::move(reading), whitening));
}

void BatchProblem::addReadings() {
  if (!unknowns_.reference().path.isSpline()) return;
  for (const std::vector<BatchReading>& of_channel : data_.readings)
    for (const BatchReading& r : of_channel) {
      RowSource source{r.channel, r.t_s()};
      source.instance = r.seen.instance;
      add(channelModel(r, data_.vehicle), source, {r.node_s[0], r.node_s[1]}, r.seen.value,
          whitener(Eigen::MatrixXd(r.seen.covariance)));
    }
}

void BatchProblem::addMarkers() {
  for (std::size_t i = 0; i < data_.markers.size(); ++i) {
    BatchMarker seen = data_.markers[i];
    if (!unknowns_.hasPose(seen.image)) continue;
    const Pose T_odom_camera =
        motionAt(seen.t_s, seen.image).T_odom_robot * seen.T_robot_camera * seen.T_left_right;
    const Vector3d centre_odom =
        unknowns_.reference().T_odom_panel[seen.panel] * seen.marker.T_panel_marker.position;
    const double z_m = (T_odom_camera.inverse() * centre_odom).z();
    if (z_m < seen.marker.size_m) {
      ++behind_camera_;
      continue;
    }
    seen.light = edgeLight(data_.panels[seen.panel], environmentOf(unknowns_.reference().water), z_m,
                           data_.vehicle.camera ? data_.vehicle.camera->response_gamma : 1.0);
    Vector8d corners;
    for (std::size_t k = 0; k < 4; ++k)
      corners.segment<2>(static_cast<Eigen::Index>(2 * k)) = seen.detection.corners_px[k];
    RowSource source{kChannel<Markers>, seen.t_s, static_cast<std::ptrdiff_t>(i)};
    source.instance = seen.instance;
    add(markerModel(seen), source, {seen.t_s}, corners,
        whitener(Eigen::MatrixXd(seen.detection.covariance_px2)));
  }
}

void BatchProblem::addTiePoints() {
  for (std::size_t i = 0; i < data_.tie_points.size(); ++i) {
    const BatchTiePoint& seen = data_.tie_points[i];
    add(tiePointModel(seen), {kChannel<EpipolarResidual>, seen.t_s, -1, static_cast<std::ptrdiff_t>(i)}, {},
        Eigen::VectorXd::Zero(1), whitener(1, 1.0));
  }
}

/// Light tells of water and camera, not of where things are: by what dies away on the way it would measure
/// ranges to a tenth of a millimetre, and every flaw of its own model would move path and calibration. So
/// poses are taken as they are at the reference.
void BatchProblem::addPatches() {
  for (std::size_t i = 0; i < data_.patches.size(); ++i) {
    ImagePatch seen = data_.patches[i];
    if (!unknowns_.hasPose(seen.image)) continue;
    const std::vector<int> colours = seen.colours();
    if (const std::vector<PatchLight>& light = unknowns_.reference().light; !light.empty()) {
      seen.albedo.array() *= light[i].ofAlbedo();
      seen.radiance.array() /= light[i].ofReading();
      seen.sigma.array() /= light[i].ofReading();
    }
    const Eigen::VectorXd reading = seen.radiance(colours);
    const double scale = options_.noise_scale[indexOf(kChannel<Pixels>)];
    const Eigen::ArrayXd scatter = options_.light_scatter / scale * reading.array();
    const Eigen::VectorXd sigma = (seen.sigma(colours).array().square() + scatter.square()).sqrt();
    add(patchModel(seen, data_.vehicle), {kChannel<Pixels>, seen.t_s, -1, -1, static_cast<std::ptrdiff_t>(i)},
        {}, reading, whitener(sigma));
  }
}

/// Poses as they are, for the same reason.
void BatchProblem::addBlurs() {
  for (std::size_t i = 0; i < data_.blurs.size(); ++i) {
    const MarkerBlur& seen = data_.blurs[i];
    if (!unknowns_.hasPose(seen.image)) continue;
    RowSource source{kChannel<Edges>, seen.t_s};
    source.blur = static_cast<std::ptrdiff_t>(i);
    add(blurModel(seen), source, {}, seen.variance_px2, whitener(Eigen::MatrixXd(seen.covariance_px4)));
  }
}

void BatchProblem::addSpecks() {
  for (std::size_t i = 0; i < data_.specks.size(); ++i) {
    const ImageSpecks& seen = data_.specks[i];
    RowSource source{kChannel<Specks>, seen.t_s};
    source.specks = static_cast<std::ptrdiff_t>(i);
    add(specksModel(seen), source, {}, seen.counted.matrix(), whitener(Eigen::VectorXd(seen.sigma)));
  }
}

void BatchProblem::addTextures() {
  for (std::size_t i = 0; i < data_.textures.size(); ++i) {
    const ImageTexture& seen = data_.textures[i];
    RowSource source{kChannel<Texture>, seen.t_s};
    source.texture = static_cast<std::ptrdiff_t>(i);
    add(textureModel(seen), source, {}, seen.log_ratio, whitener(Eigen::VectorXd(seen.sigma)));
  }
}

void BatchProblem::addMotionPriors() {
  const PosePath& path = unknowns_.reference().path;
  if (!path.isSpline()) return;
  Vector6d sigma;
  sigma << Vector3d::Constant(options_.acceleration_sigma_m_s2),
      Vector3d::Constant(options_.angular_acceleration_sigma_rad_s2);
  const auto segments = path.poses.size() - 3;
  for (std::size_t i = 0; i <= segments; ++i) {
    const double t_s = path.begin_s + path.knot_s * static_cast<double>(i);
    add(accelerationModel(t_s), {kChannel<Prior>, t_s}, {t_s}, Vector6d::Zero(),
        whitener(Eigen::VectorXd(sigma)));
  }
  if (const auto& prior = options_.path_prior) {
    // Position and heading; roll and pitch are gravity's.
    Vector6d reading, precision;
    reading << prior->T_odom_robot.position, Vector3d::Zero();
    precision << Vector3d::Constant(1.0 / prior->position_sigma_m), 0.0, 0.0, 1.0 / prior->heading_sigma_rad;
    add(poseModel(prior->T_odom_robot, path.begin_s), {kChannel<Prior>, path.begin_s}, {path.begin_s},
        reading, precision.asDiagonal().toDenseMatrix());
  }
}

void BatchProblem::addDriftPriors() {
  const BatchState& reference = unknowns_.reference();
  for (std::size_t i = 0; i < reference.drifts.size(); ++i) {
    const DriftTrack& track = reference.drifts[i];
    const Drift drift = modelOf(track.channel).drift(data_.vehicle, track.instance);
    for (std::size_t k = 0; k < track.knots.size(); ++k) {
      const PriorRows prior = driftPrior(drift, track, reference.drift_interval_s, k);
      std::vector<std::size_t> of{unknowns_.placeOf(UnknownBlock::Kind::drift, i, k)};
      if (k > 0) of.push_back(unknowns_.placeOf(UnknownBlock::Kind::drift, i, k - 1));
      costs_.push_back(std::make_unique<LinearCost>(unknowns_.blocks(), of, prior.value, prior.slope));
      costs_.back()->source.t_s =
          reference.path.begin_s + reference.drift_interval_s * static_cast<double>(k);
    }
  }
}

void BatchProblem::addPriorsOfConstants() {
  for (std::size_t b = 0; b < unknowns_.blocks().size(); ++b)
    if (const auto prior = priorOf(unknowns_.blocks()[b], data_, unknowns_, options_.estimate)) {
      costs_.push_back(
          std::make_unique<LinearCost>(unknowns_.blocks(), std::vector{b}, prior->value, prior->slope));
      costs_.back()->is_wide_prior = prior->is_wide;
    }
}

}  // namespace fathom
