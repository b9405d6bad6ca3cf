#include "estimation/batch_state.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "effects/catalogue.h"
#include "sensors/channel_model.h"

namespace fathom {

std::vector<std::size_t> continuousScalars(std::size_t effect) {
  std::vector<std::size_t> list;
  for (std::size_t s = kEffectOffsets[effect]; s < kEffectOffsets[effect + 1]; ++s)
    if (isEstimated(parameterOf(s).kind)) list.push_back(s);
  return list;
}

double gridBegin_s(const BatchData& data) {
  return std::floor(data.first_s / data.knot_s + 1e-6) * data.knot_s;
}

std::optional<std::size_t> knotEffect(const EffectParameters<double>& effects) {
  constexpr std::size_t kEffect = kEffectIndex<InsLatency>;
  const bool lasts = effects.active_s[kEffect] == Interval{} && !effects.only[kEffect];
  return lasts ? std::optional(kEffect) : std::nullopt;
}

double knotLatency_s(const EffectParameters<double>& effects) {
  const auto effect = knotEffect(effects);
  return effect && effects.on[*effect] ? *effects.of<InsLatency>() : 0;
}

void moveKnots(const EffectParameters<double>& before, BatchState& state) {
  state.path.begin_s -= knotLatency_s(state.effects) - knotLatency_s(before);
}

namespace {

/// At zero, one for each instrument that has been read and drifts.
std::vector<DriftTrack> driftsOf(const BatchData& data, std::size_t knots) {
  std::vector<DriftTrack> drifts;
  for (const auto& readings : data.readings) {
    std::set<Instance> instances;
    for (const BatchReading& r : readings) instances.insert(r.seen.instance);
    for (const Instance& instance : instances) {
      const Channel channel = readings.front().channel;
      const ChannelModel& model = modelOf(channel);
      if (!model.drift_effect) continue;
      const Drift drift = model.drift(data.vehicle, instance);
      if (drift.sigma == 0) continue;
      const Observation::Value zero = Observation::Value::Zero(textOf(channel).component_count);
      drifts.push_back({channel, instance, {drift.isConstant() ? 1 : knots, zero}});
    }
  }
  return drifts;
}

}  // namespace

std::optional<std::size_t> BatchState::driftOf(Channel channel, const Instance& instance) const {
  for (std::size_t i = 0; i < drifts.size(); ++i)
    if (drifts[i].channel == channel && drifts[i].instance == instance) return i;
  return {};
}

BatchState startState(const BatchData& data, const std::vector<double>& times_s,
                      const std::vector<Pose>& T_odom_robot, const EffectParameters<double>& effects,
                      double drift_interval_s) {
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
  const double begin_s = gridBegin_s(data);
  state.path = PosePath::splineNear(times_s, T_odom_robot, begin_s, data.last_s, data.knot_s);
  if (const std::vector<BatchReading>& ranges = data.of<Altimeter>(); !ranges.empty()) {
    double sum_m = 0;  // as if all looked straight down: the estimate is linear in it
    for (const BatchReading& r : ranges)
      sum_m += motionOf(state.path, state.path.nodeAt(r.t_s())).T_odom_robot.position.z() - r.seen.value[0];
    state.sea_floor_z_m = sum_m / static_cast<double>(ranges.size());
  }
  state.drift_interval_s = drift_interval_s;
  const double intervals = std::ceil((state.path.end_s() - begin_s) / drift_interval_s);
  state.drifts = driftsOf(data, static_cast<std::size_t>(std::max(1.0, intervals)) + 1);
  return state;
}

}  // namespace fathom
