#include "estimation/batch_priors.h"

#include "core/gauss_markov.h"
#include "effects/catalogue.h"
#include "estimation/wide_prior.h"

namespace fathom {
namespace {

/// One standard deviation of each of ImageFlaw. Of light: what rounding leaves in means that it shifts alike.
const Flaws kFlawSigma{0.1, 0.3, 0.02 / 255, 0.02 / 255, 0.02 / 255};

PriorRows posePrior(const Pose& nominal, const Pose& reference, double position_sigma_m,
                    double angle_sigma_rad) {
  Vector6d precision;
  precision << Vector3d::Constant(1.0 / position_sigma_m), Vector3d::Constant(1.0 / angle_sigma_rad);
  const Vector6d error = poseDifference(nominal, reference);
  Matrix6d slope = Matrix6d::Identity();
  slope.bottomRightCorner<3, 3>() = inverseRightJacobianSO3<double>(error.tail<3>());
  return {precision.cwiseProduct(error), precision.asDiagonal() * slope};
}

/// About zero.
PriorRows scalarPrior(double value, double precision) {
  return {Eigen::VectorXd::Constant(1, precision * value), Eigen::MatrixXd::Constant(1, 1, precision)};
}

PriorRows waterPrior(const Vector9d& nominal, const Vector9d& reference) {
  const Vector9d precision = wideWaterSigma().cwiseInverse();
  return {precision.cwiseProduct(reference - nominal), precision.asDiagonal().toDenseMatrix()};
}

/// What was found of its spread, or what one would expect.
PriorRows drawPrior(const Draw& draw, const BatchState& reference,
                    const std::bitset<kEffectCount>& estimate) {
  const double known = reference.effects.values[draw.scalar];
  const bool is_known = known > 0 && !estimate[effectOf(draw.scalar)];
  const double precision = 1 / (is_known ? known : parameterOf(draw.scalar).prior_sigma);
  return scalarPrior(reference.drawn(draw), precision);
}

PriorRows effectPrior(const UnknownBlock& block, const EffectParameters<double>& reference) {
  Eigen::VectorXd precision(block.size), value(block.size);
  int i = 0;
  for (const std::size_t s : continuousScalars(block.index)) {
    precision[i] = 1.0 / parameterOf(s).prior_sigma;
    value[i++] = reference.values[s];
  }
  return {precision.cwiseProduct(value), precision.asDiagonal().toDenseMatrix(), hasWidePrior(block.index)};
}

}  // namespace

std::optional<PriorRows> priorOf(const UnknownBlock& block, const BatchData& data,
                                 const BatchUnknowns& unknowns, const std::bitset<kEffectCount>& estimate) {
  const BatchState& reference = unknowns.reference();
  switch (block.kind) {
    case UnknownBlock::Kind::pose:
    case UnknownBlock::Kind::drift:
      break;
    case UnknownBlock::Kind::sea_floor: {
      constexpr double kAnywhere_m = 1000.0;  // only so that it is not singular
      return scalarPrior(reference.sea_floor_z_m, 1.0 / kAnywhere_m);
    }
    case UnknownBlock::Kind::panel: {
      const PanelMap& map = data.panels[block.index];
      return posePrior(map.T_odom_panel, reference.T_odom_panel[block.index], map.position_sigma_m,
                       map.angle_sigma_rad);
    }
    case UnknownBlock::Kind::right_camera: {
      const CameraSheet camera = data.vehicle.camera.value_or(CameraSheet{});
      return posePrior(data.tie_points[0].T_left_right, reference.T_left_right, camera.right_position_sigma_m,
                       camera.right_angle_sigma_rad);
    }
    case UnknownBlock::Kind::water:
      return waterPrior(waterParameters(data.water), reference.water);
    case UnknownBlock::Kind::flaws:
      return PriorRows{reference.flaws.cwiseQuotient(kFlawSigma),
                       kFlawSigma.cwiseInverse().asDiagonal().toDenseMatrix()};
    case UnknownBlock::Kind::effect:
      return effectPrior(block, reference.effects);
    case UnknownBlock::Kind::draw:
      return drawPrior(unknowns.draws()[block.index], reference, estimate);
  }
  return std::nullopt;
}

PriorRows driftPrior(const Drift& drift, const DriftTrack& track, double interval_s, std::size_t k) {
  const GaussMarkovStep step =
      k == 0 ? GaussMarkovStep() : GaussMarkovStep(interval_s, drift.time_constant_s);
  const double precision = 1.0 / (drift.sigma * step.innovation());
  const Eigen::Index size = track.knots[k].size();
  Eigen::MatrixXd slope(size, k == 0 ? size : 2 * size);
  slope.leftCols(size) = precision * Eigen::MatrixXd::Identity(size, size);
  Eigen::VectorXd value = precision * track.knots[k];
  if (k > 0) {
    slope.rightCols(size) = -step.decay * precision * Eigen::MatrixXd::Identity(size, size);
    value -= step.decay * precision * track.knots[k - 1];
  }
  return {value, slope};
}

}  // namespace fathom
