#include "support/diagnosis_runs.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "diagnosis/budget_file.h"
#include "diagnosis/noise.h"
#include "effects/drawn.h"
#include "effects/image_regions.h"
#include "estimation/sparse.h"

namespace fathom::test {

Pose richPose(double t) {
  const Vector3d position(3.4 + 1.1 * std::sin(0.21 * t), 0.9 * std::sin(0.37 * t + 1.0),
                          -4.0 + 0.5 * std::sin(0.47 * t));
  const double range_m = 5.9 - position.x();
  const double yaw = std::atan2(-0.8 * position.y(), range_m) + 0.2 * std::sin(0.43 * t);
  const double pitch = std::atan2(0.7 * (position.z() + 4.0), range_m) + 0.12 * std::sin(0.59 * t);
  return {rotationFromYawPitchRoll(yaw, pitch, 0.25 * std::sin(0.53 * t + 0.4)), position};
}

Trajectory pathOf(double duration_s, const std::function<Pose(double)>& poseAt) {
  const auto times_s = timesBetween(0, duration_s + 10.0, 0.1);
  std::vector<Pose> poses(times_s.size());
  std::transform(times_s.begin(), times_s.end(), poses.begin(), poseAt);
  return {times_s, poses};
}

BatchRun richRun(std::uint64_t seed, double duration_s) {
  BatchRun run(duration_s, pathOf(duration_s, richPose));
  run.seed = seed;
  return run;
}

const BatchRun& lightDive() {
  static const BatchRun dive = [] {
    BatchRun run = richRun(1, 24.0);
    run.pixels = true;
    return run;
  }();
  return dive;
}

Excitation::Excitation(BatchRun run) {
  run.noise = false;
  run.effects = {};
  input_ = run.input();
  estimate_ = estimateBatch(input_.data, input_.start, {});
  const auto problem = problemAt(input_.data, estimate_, {});
  linear_ = linearize(input_.data, *problem);
  const HeldColumns budget = budgetColumns(linear_, {.budget = fieldBudget().of(CameraPipeline::linear)});
  nuisances_.emplace(withHeldColumns(linear_.J, budget.columns, budget.sigma),
                     Nuisances::AtEnd{.full = budget.sigma.size()});
  nominal_ = residualsWith({}, 0);
}

Eigen::MatrixXd Excitation::project(const Eigen::MatrixXd& C) const {
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(nuisances_->J().rows(), C.cols());
  held.topRows(C.rows()) = C;
  return nuisances_->project(held);
}

Eigen::VectorXd Excitation::signal(const EffectParameters<double>& effects, std::uint64_t seed) const {
  return project(residualsWith(effects, seed) - nominal_);
}

double Excitation::alignment(const Eigen::VectorXd& signal, const Candidate& rival) const {
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(project(columns(rival)));
  const Eigen::VectorXd along = (qr.householderQ().transpose() * signal).head(qr.rank());
  return along.norm() / signal.norm();
}

double Excitation::separability(const Eigen::VectorXd& signal, const Candidate& rival) const {
  return signal.squaredNorm() * (1.0 - alignment(signal, rival));
}

bool Excitation::canShow(const EffectInfo& effect) const { return fathom::canShow(linear_, effect.index); }

double Excitation::kept(const Candidate& candidate) const {
  const Eigen::MatrixXd C = columns(candidate);
  return project(C).norm() / C.norm();
}

std::vector<Candidate> Excitation::candidates() const {
  std::vector<int> ids;
  for (const Marker& marker : input_.data.panels[0].markers) ids.push_back(marker.id);
  std::vector<Candidate> all;
  for (const EffectInfo& effect : allEffects())
    if (canShow(effect))
      for (const Candidate& candidate : candidatesOf(effect, ids, {0, input_.data.last_s}))
        all.push_back(candidate);
  return all;
}

Eigen::VectorXd Excitation::residualsWith(const EffectParameters<double>& effects, std::uint64_t seed) const {
  BatchEstimate moved = estimate_;
  moved.state.effects = effects;
  for (const ImagePatch& patch : input_.data.patches) {
    const EffectParameters<double> drawn = drawnFor(effects, seed, patch.t_s);
    for (std::size_t s = 0; s < drawn.values.size(); ++s)
      if (effects.on[effectOf(s)] && parameterOf(s).kind == ParameterKind::spread)
        moved.state.draws[{s, patch.image}] = drawn.values[s];
  }
  const auto problem = problemAt(input_.data, moved, {});
  const BatchPoint zero = problem->pointAt(Eigen::VectorXd::Zero(problem->unknowns()), false);
  // Priors, which come last, are as they were, but for those of what is drawn.
  Eigen::VectorXd all = Eigen::VectorXd::Zero(linear_.residual.size()), residual;
  Eigen::Index row = 0;
  for (const auto& cost : problem->costs()) {
    if (cost->source.channel == kChannel<Prior>) break;
    cost->compute(zero, residual, nullptr);
    all.segment(row, residual.size()) = residual;
    row += residual.size();
  }
  return all;
}

Eigen::MatrixXd Excitation::columns(const Candidate& candidate) const {
  if (isDrawn(candidate.effect)) return columnsOf(linear_, std::vector{candidate});
  std::vector<Eigen::Index> of;
  for (std::size_t c = 0; c < linear_.columns.size(); ++c)
    if (linear_.columns[c].effect == candidate.effect) of.push_back(static_cast<Eigen::Index>(c));
  Eigen::MatrixXd C = linear_.C(Eigen::all, of);
  for (std::size_t i = 0; i < linear_.rows.size(); ++i) {
    const RowInfo& row = linear_.rows[i];
    const bool acts =
        candidate.active_s.contains(row.t_s) &&
        (!candidate.marker_id || *candidate.marker_id == row.markerSeen()) &&
        (!candidate.region ||
         kImageRegions.at(static_cast<std::size_t>(*candidate.region)).contains(row.image_place)) &&
        (!candidate.sensor || *candidate.sensor == sensorKindOf(row.channel)) &&
        (!candidate.time_s || row.t_s >= *candidate.time_s);
    const auto at = static_cast<Eigen::Index>(i);
    if (!acts) C.row(at).setZero();
    if (const auto& peak = candidate.peak)
      C.row(at) *= std::exp(-0.5 * std::pow((row.t_s - peak->time_s) / peak->width_s, 2));
  }
  return C;
}

namespace {

/// The Earth turns as fast as it does: sqrt(lambda) is as asked because the gyro is as good as that takes.
DiagnosisRun earthRotationOfSize(const BatchRun& nominal, double sqrt_lambda, std::uint64_t seed) {
  constexpr double kEarthRate_rad_s = 7.292e-5;
  Random random = Random::stream(seed, 1000 + kEffectIndex<EarthRotation>);
  DiagnosisRun hidden{"earth-rotation", nominal, {}, Candidate{.effect = kEffectIndex<EarthRotation>}, 0,
                      nullptr};
  hidden.run.seed = random.bits();
  const double latitude = std::asin(random.uniform(-1, 1)), north = random.uniform(0, 2 * std::numbers::pi);
  const Vector3d axis(std::cos(latitude) * std::cos(north), std::cos(latitude) * std::sin(north),
                      std::sin(latitude));
  EffectParameters<double> effects;
  effects.on.set(kEffectIndex<EarthRotation>);
  for (int i = 0; i < 3; ++i) effects.of<EarthRotation>()[i] = kEarthRate_rad_s * axis[i];
  for (int i = 0; i < 6 && std::abs(hidden.sqrt_lambda - sqrt_lambda) > 0.01 * sqrt_lambda; ++i) {
    const double factor = i == 0 ? 1 : hidden.sqrt_lambda / sqrt_lambda;
    hidden.run.vehicle.ins->gyro_sigma_rad_s *= factor;
    hidden.run.vehicle.ins->gyro_bias_sigma_rad_s *= factor;
    hidden.excitation = std::make_shared<const Excitation>(hidden.run);
    hidden.sqrt_lambda = hidden.excitation->sqrtLambda(effects);
  }
  hidden.run.effects = effects;
  return hidden;
}

}  // namespace

DiagnosisRun effectOfSize(const BatchRun& nominal, const Excitation& excitation, const EffectInfo& effect,
                          double sqrt_lambda, std::uint64_t seed) {
  if (effect.index == kEffectIndex<EarthRotation>) return earthRotationOfSize(nominal, sqrt_lambda, seed);
  Random random = Random::stream(seed, 1000 + effect.index);
  DiagnosisRun hidden{std::string(effect.id), nominal, {}, {}, 0, nullptr};
  hidden.run.seed = random.bits();
  std::vector<int> ids;
  for (const Marker& marker : nominal.panel.markers) ids.push_back(marker.id);
  Hidden one = randomEffect(effect, ids, nominal.duration_s, random);
  if (effect.index == kEffectIndex<WaterCurrent> && seed % 2 == 0)
    one = activeDuring(one, randomInterval(nominal.duration_s, random));
  hidden.truth = one.candidate;
  const EffectParameters<double>& direction = one.effects;
  const auto sqrtLambda = [&](const EffectParameters<double>& effects) {
    return excitation.sqrtLambda(effects, hidden.run.seed);
  };
  double factor = sqrt_lambda / sqrtLambda(scaled(direction, 1e-3)) * 1e-3;
  for (int i = 0; i < 8; ++i) {
    while (!isWithinLimits(scaled(direction, factor))) factor *= 0.9;
    hidden.sqrt_lambda = sqrtLambda(scaled(direction, factor));
    factor *=
        std::pow(std::clamp(sqrt_lambda / hidden.sqrt_lambda, 0.2, 5.0), 0.7);  // signals of order 1 to 2
  }
  while (!isWithinLimits(scaled(direction, factor))) factor *= 0.9;
  hidden.run.effects = scaled(direction, factor);
  hidden.sqrt_lambda = sqrtLambda(hidden.run.effects);
  return hidden;
}

DiagnosisRun plainNull(const BatchRun& nominal, std::uint64_t seed) {
  DiagnosisRun run{"nothing", nominal, {}, {}, 0, nullptr};
  run.run.seed = Random::stream(seed, 2000).bits();
  return run;
}

PanelMap rippled(PanelMap panel, double largest_m, Random& random) {
  const double angle = random.uniform(0, std::numbers::pi), phase = random.uniform(0, 2 * std::numbers::pi);
  const Vector2d wave = 2 * std::numbers::pi / 1.6 * Vector2d(std::cos(angle), std::sin(angle));
  const auto count = std::ssize(panel.markers);
  const Vector2d curvature = panel.half_extent_m.cwiseAbs2().cwiseInverse();
  Eigen::MatrixXd shape(count, 6);
  Eigen::VectorXd height(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector3d& position = panel.markers[static_cast<std::size_t>(i)].T_panel_marker.position;
    shape.row(i) << position.x(), position.y(), 1, position.x() * position.y(), std::abs(position.x()),
        curvature.dot(position.head<2>().cwiseAbs2());
    height[i] = std::sin(wave.dot(position.head<2>()) + phase);
  }
  const Eigen::VectorXd fitted = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(shape).solve(height);
  height -= shape * fitted;
  // A wave that is nearly one of these shapes is not made steep by what is left of it.
  const double scale_m = std::min(3 * largest_m, largest_m / height.cwiseAbs().maxCoeff());
  for (Eigen::Index i = 0; i < count; ++i) {
    Pose& T = panel.markers[static_cast<std::size_t>(i)].T_panel_marker;
    const Vector2d at = T.position.head<2>();
    const Vector2d fitted_slope = fitted.head<2>() + fitted[3] * Vector2d(at.y(), at.x()) +
                                  Vector2d(at.x() < 0 ? -fitted[4] : fitted[4], 0) +
                                  2 * fitted[5] * curvature.cwiseProduct(at);
    const Vector2d slope = scale_m * (std::cos(wave.dot(at) + phase) * wave - fitted_slope);
    T.position.z() += scale_m * height[i];
    T.rotation = expSO3<double>(Vector3d(slope.y(), -slope.x(), 0)) * T.rotation;
  }
  return panel;
}

void correlateDvl(const BatchRun& run, std::vector<Sample>& samples, double correlation, Random& random) {
  BatchRun quiet = run;
  quiet.noise = false;
  const std::vector<Sample> exact = quiet.samples();
  const DvlSheet& sheet = *run.vehicle.dvl;
  const Vector3d sigma(sheet.velocity_sigma_xy_m_s, sheet.velocity_sigma_xy_m_s, sheet.velocity_sigma_z_m_s);
  Vector3d error = random.normal3();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    auto* dvl = std::get_if<DvlSample>(&samples[i].reading);
    if (dvl == nullptr || !dvl->velocity_dvl) continue;
    dvl->velocity_dvl = *std::get<DvlSample>(exact[i].reading).velocity_dvl + sigma.cwiseProduct(error);
    error = correlation * error + std::sqrt(1 - correlation * correlation) * random.normal3();
  }
}

DiagnosisRun richNull(const BatchRun& nominal, std::uint64_t seed) {
  DiagnosisRun run{"nothing, richer", nominal, {}, {}, 0, nullptr};
  Random random = Random::stream(seed, 3000);
  run.run.seed = random.bits();
  run.run.true_panel = rippled(nominal.panel, 0.001, random);
  run.run.corner_tail_dof = 4;
  run.change = [seed](const BatchRun& r, std::vector<Sample>& samples) {
    Random noise = Random::stream(seed, 3001);
    correlateDvl(r, samples, 0.6, noise);
  };
  run.change_light = [seed](std::vector<ImagePatch>& patches) {
    constexpr double kShare = 0.001;
    Random noise = Random::stream(seed, 3002);
    for (ImagePatch& patch : patches) patch.radiance += kShare * noise.normal3().cwiseProduct(patch.radiance);
  };
  return run;
}

}  // namespace fathom::test
