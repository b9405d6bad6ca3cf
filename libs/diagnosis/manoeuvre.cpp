#include "diagnosis/manoeuvre.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "core/text.h"
#include "diagnosis/constants.h"
#include "diagnosis/manoeuvre_readings.h"
#include "diagnosis/screening.h"
#include "effects/catalogue.h"
#include "effects/drawn.h"

namespace fathom {
namespace {

constexpr double kDuration_s = Manoeuvre::kDuration_s;

double wave(double t_s, double period_s) { return std::sin(2 * std::numbers::pi * t_s / period_s); }
/// Begins and ends at rest, without a jerk.
double eased(double t_s) {
  const double x = std::clamp(std::min(t_s, kDuration_s - t_s) / kEase_s, 0.0, 1.0);
  return x * x * x * (10 - 15 * x + 6 * x * x);
}

Pose shifted(double x_m, double y_m, double z_m) { return {Matrix3d::Identity(), {x_m, y_m, z_m}}; }
Pose turned(double yaw_rad, double pitch_rad, double roll_rad) {
  return {rotationFromYawPitchRoll(yaw_rad, pitch_rad, roll_rad), Vector3d::Zero()};
}

/// When most markers were seen, else the recording's beginning.
double bestView_s(const BatchData& data) {
  std::map<double, int> seen;
  for (const BatchMarker& marker : data.markers) ++seen[marker.t_s];
  const auto most = std::max_element(seen.begin(), seen.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most == seen.end() ? data.first_s : most->first;
}

/// What of an effect's share of the readings another cannot imitate, by the columns of both. Of what is drawn
/// for each image, on average over draws.
double separation(const Reduced& reduced, const SizedEffect& effect, const Eigen::VectorXi& own,
                  const Eigen::VectorXi& other) {
  const Eigen::MatrixXd A = reduced.gram(own, own), B = reduced.gram(own, other);
  const Information information(reduced.gram(other, other), reduced.norms(other));
  const Eigen::MatrixXd left = A - B * information.inverse * B.transpose();
  const Eigen::VectorXd& value = effect.value;
  const double lambda =
      isDrawn(effect.candidate.effect) ? value.squaredNorm() * left.trace() : value.dot(left * value);
  return std::sqrt(std::max(0.0, lambda));
}

/// The smaller of both ways round.
double separation(const WhitenedModel& model, const SizedEffect& a, const SizedEffect& b) {
  const Reduced reduced = model.reduce(std::vector<Candidate>{a.candidate, b.candidate});
  const auto all = static_cast<int>(reduced.gram.rows()),
             first = static_cast<int>(columnsOf(model.linear(), a.candidate.effect).size());
  const Eigen::VectorXi of_a = Eigen::VectorXi::LinSpaced(first, 0, first - 1),
                        of_b = Eigen::VectorXi::LinSpaced(all - first, first, all - 1);
  return std::min(separation(reduced, a, of_a, of_b), separation(reduced, b, of_b, of_a));
}

/// On for good, or at its peak midway: a manoeuvre is made where and when the effect acts.
SizedEffect lasting(SizedEffect effect) {
  effect.candidate.active_s = {};
  if (effect.candidate.peak) effect.candidate.peak = Peak{0.5 * kDuration_s, 0.1 * kDuration_s};
  if (effect.candidate.time_s) effect.candidate.time_s = 0;
  return effect;
}

/// What is known to be there besides, when and where the manoeuvre begins: on for good. What passes has
/// passed.
EffectParameters<double> lastingEffects(const EffectParameters<double>& known, double t_s) {
  EffectParameters<double> lasting = known.at<double>(t_s);
  for (std::size_t s = 0; s < lasting.values.size(); ++s) {
    const std::size_t effect = effectOf(s);
    if (!lasting.on[effect]) continue;
    const ParameterKind kind = parameterOf(s).kind;
    if (kind == ParameterKind::peak_time) lasting.on.reset(effect);
    if (kind != ParameterKind::time) continue;
    if (t_s < lasting.values[s]) lasting.on.reset(effect);
    lasting.values[s] = 0;
  }
  return lasting;
}

WhitenedModel modelOf(const BatchData& data, const std::vector<double>& times_s,
                      const std::vector<Pose>& poses, const BatchState& recorded,
                      const EffectParameters<double>& effects, const NoiseModel& noise) {
  ProblemOptions options;
  noise.applyTo(options);
  options.robust_probability = 1;
  options.path_prior = PathPrior{poses.front(), 0.001, 0.001};
  BatchState state = startState(data, times_s, poses, effects, 10.0);
  if (recorded.T_odom_panel.size() == state.T_odom_panel.size()) state.T_odom_panel = recorded.T_odom_panel;
  state.water = recorded.water;
  state.flaws = recorded.flaws;
  return WhitenedModel(linearize(data, BatchProblem(data, options, state)), noise);
}

}  // namespace

const std::vector<Manoeuvre>& manoeuvres() {
  static const std::vector<Manoeuvre> all{
      {"hold station", [](double) { return Pose{}; }},
      {"turn on the spot, 30 degrees to either side",
       [](double t) { return turned(radians(30) * eased(t) * wave(t, 20), 0, 0); }},
      {"turn on the spot, once around",
       [](double t) { return turned(radians(360) * t / kDuration_s, 0, 0); }},
      {"run a metre ahead and back, four times",
       [](double t) { return shifted(eased(t) * wave(t, 15), 0, 0); }},
      {"sidle a metre to either side, four times",
       [](double t) { return shifted(0, eased(t) * wave(t, 15), 0); }},
      {"dive up and down by a metre, four times",
       [](double t) { return shifted(0, 0, eased(t) * wave(t, 15)); }},
      {"pitch and roll by eight degrees",
       [](double t) {
         return turned(0, radians(8) * eased(t) * wave(t, 10), radians(8) * eased(t) * wave(t, 7));
       }},
      {"start and stop sharply, ahead and to the sides",
       [](double t) { return shifted(0.25 * eased(t) * wave(t, 3), 0.25 * eased(t) * wave(t, 4), 0); }},
      {"swim a circle of three metres with the heading kept",
       [](double t) {
         const double angle = 2 * std::numbers::pi * t / 30;
         return shifted(1.5 * eased(t) * (std::cos(angle) - 1), 1.5 * eased(t) * std::sin(angle), 0);
       }},
      {"look at the panel from half and from twice the range, and from both sides", [](double t) {
         const double side_m = 0.8 * eased(t) * wave(t, 20);
         return shifted(0.8 * eased(t) * wave(t, 30), side_m, 0) * turned(-std::atan2(side_m, 3.0), 0, 0);
       }}};
  return all;
}

Pose stationAt(const Pose& T_odom_robot) {
  const Vector3d forward = T_odom_robot.rotation.col(0);
  return {rotationFromYawPitchRoll(std::atan2(forward.y(), forward.x()), 0, 0), T_odom_robot.position};
}

Pose Manoeuvre::T_station_robot(double t_s) const { return in_first_minute(std::fmod(t_s, kDuration_s)); }

std::string textOf(const Advice& advice) {
  return advice.minutes == 1 || advice.manoeuvre.empty()
             ? advice.manoeuvre
             : print("%s, %d minutes long", advice.manoeuvre.c_str(), advice.minutes);
}

SizedEffect sized(const Refit& fit, const Candidate& effect) {
  std::vector<double> values;
  for (const EffectEstimate& estimate : fit.estimates)
    if (estimate.effect == effect.effect) values.push_back(sizeOf(estimate.scalar, estimate.value));
  return {effect, Eigen::Map<Eigen::VectorXd>(values.data(), std::ssize(values))};
}

Advice adviseManoeuvre(const BatchData& data, const WhitenedModel& without, const BatchState& recorded,
                       const EffectParameters<double>& known, const SizedEffect& first,
                       const SizedEffect& second, const NoiseModel& noise) {
  Advice advice;
  advice.separation_now = separation(without, first, second);
  if (!data.hasMotion()) return advice;  // nothing that could be driven
  advice.from_s = bestView_s(data);
  const EffectParameters<double> effects = lastingEffects(known, advice.from_s);
  const PosePath& path = recorded.path;
  const Pose station = stationAt(motionOf(path, path.nodeAt(advice.from_s)).T_odom_robot);
  for (const Manoeuvre& manoeuvre : manoeuvres()) {
    std::vector<double> times_s;
    std::vector<Pose> poses;
    for (double t_s = 0; t_s <= kDuration_s + 1e-9; t_s += data.knot_s) {
      times_s.push_back(t_s);
      poses.push_back(station * manoeuvre.in_first_minute(t_s));
    }
    const BatchData readings = readingsAlong(data, times_s, poses, effects);
    const double reached = separation(modelOf(readings, times_s, poses, recorded, effects, noise),
                                      lasting(first), lasting(second));
    if (reached <= advice.separation) continue;
    advice.separation = reached;
    advice.manoeuvre = manoeuvre.text;
  }
  // What the readings tell grows with time, its root is the separation.
  const double minutes = std::ceil(std::pow(kToldApart / std::max(1e-6, advice.separation), 2));
  if (minutes > Advice::kMostMinutes)
    advice.manoeuvre.clear();
  else
    advice.minutes = std::max(1, static_cast<int>(minutes));
  return advice;
}

}  // namespace fathom
