#include "estimation/reading_cost_maker.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/chi_square.h"
#include "effects/image_regions.h"
#include "estimation/reading_cost.h"
#include "sensors/channel_model.h"

namespace fathom {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// Marker ids, sensors and times are this row's own: what acts here.
void setDiscrete(ForwardPoint& point, int marker_id, const ImagePatch* patch, const RowSource& source) {
  const int cell = patch == nullptr ? 0 : imageCellAt(patch->image_place.x(), patch->image_place.y());
  for (std::size_t s = 0; s < kEffectScalars; ++s) {
    if (parameterOf(s).kind == ParameterKind::marker_id) point.effects[s] = marker_id;
    if (parameterOf(s).kind == ParameterKind::region) point.effects[s] = cell;
    if (parameterOf(s).kind == ParameterKind::sensor) point.effects[s] = sensorKindOf(source.channel);
    if (parameterOf(s).kind == ParameterKind::time) point.effects[s] = -Interval::kForever_s;
    if (parameterOf(s).kind == ParameterKind::peak_time) point.effects[s] = source.t_s;
  }
}

}  // namespace

/// What of an image a reading is of, if it is.
struct ReadingCostMaker::Subject {
  const BatchMarker* marker = nullptr;
  const ImagePatch* patch = nullptr;
  const MarkerBlur* blur = nullptr;
  std::size_t panel = kNone, image = kNone;

  /// Of the marker that a corner or a patch is of; -1: of none.
  int markerId() const {
    if (marker != nullptr) return marker->marker.id;
    return patch != nullptr ? patch->marker_id : -1;
  }
  /// Of a patch.
  bool isIn(const ImageRegion& region) const {
    return patch != nullptr && region.shareOf(patch->image_place, patch->image_spread) > 0;
  }
};

std::unique_ptr<BatchCost> ReadingCostMaker::make(std::unique_ptr<ReadingModel> model,
                                                  const RowSource& source, std::vector<double> node_s,
                                                  Eigen::VectorXd reading, const Eigen::MatrixXd& whitening) {
  auto cost = std::make_unique<ReadingCost>(motions_, unknowns_.blocks());
  cost->model = std::move(model);
  cost->source = source;
  const Subject subject = subjectOf(source);
  setEffects(subject, *cost);
  if (!node_s.empty()) followKnots(*cost);
  setPlaces(subject, cost->at_reference);
  setMotions(subject, std::move(node_s), *cost);
  addOthers(subject, *cost);
  linkDrift(*cost);
  linkEffects(*cost);
  linkDraws(subject, *cost);
  cost->whitening = whitening / options_.noise_scale[indexOf(source.channel)];
  cost->robust_threshold = thresholdOf(source.channel, reading.size());
  cost->reading = std::move(reading);
  cost->finish();
  return cost;
}

ReadingCostMaker::Subject ReadingCostMaker::subjectOf(const RowSource& source) const {
  Subject subject;
  const auto take = [&](const auto& all, std::ptrdiff_t at, auto& seen) {
    if (at < 0) return;
    seen = &all[static_cast<std::size_t>(at)];
    subject.panel = seen->panel;
    subject.image = seen->image;
  };
  take(data_.markers, source.marker, subject.marker);
  take(data_.patches, source.patch, subject.patch);
  take(data_.blurs, source.blur, subject.blur);
  return subject;
}

std::bitset<kEffectCount> ReadingCostMaker::actingOn(const ReadingModel& model, const RowSource& source,
                                                     const EffectParameters<double>& effects) const {
  const EffectParameters<double>& all = unknowns_.reference().effects;
  const Subject subject = subjectOf(source);
  std::bitset<kEffectCount> acting;
  for (std::size_t e = 0; e < kEffectCount; ++e) {
    const bool on = effects.on[e] || (options_.estimate[e] && all.concerns(e, source.instance));
    if (!on || !effects.active_s[e].contains(source.t_s) || !model.dependsOn(e)) continue;
    bool acts = true;
    for (std::size_t s = kEffectOffsets[e]; s < kEffectOffsets[e + 1]; ++s) {
      const double value = effects.values[s];
      if (parameterOf(s).kind == ParameterKind::marker_id)
        acts = acts && static_cast<int>(std::lround(value)) == subject.markerId();
      if (parameterOf(s).kind == ParameterKind::region)
        acts = acts && subject.isIn(kImageRegions.at(static_cast<std::size_t>(std::lround(value))));
      if (parameterOf(s).kind == ParameterKind::sensor)
        acts = acts && static_cast<int>(std::lround(value)) == sensorKindOf(source.channel);
      if (parameterOf(s).kind == ParameterKind::time) acts = acts && source.t_s >= value;
    }
    acting[e] = acts;
  }
  return acting;
}

void ReadingCostMaker::setEffects(const Subject& subject, ReadingCost& cost) const {
  ForwardPoint& point = cost.at_reference;
  setDiscrete(point, subject.markerId(), subject.patch, cost.source);
  const EffectParameters<double> effects = unknowns_.reference().effects.of(cost.source.instance);
  cost.acting = actingOn(*cost.model, cost.source, effects);
  for (const EffectInfo& effect : allEffects())
    cost.told[effect.index] = cost.model->dependsOn(effect.index) &&
                              (subject.patch == nullptr || effect.text.channel == EffectChannel::image);
  point.on = cost.acting;
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (cost.acting[e])
      for (const std::size_t s : continuousScalars(e)) point.effects[s] = effects.values[s];
}

/// An estimate of the effect that knots follow moves the whole path under what is read, but for what takes
/// poses as they are and what is about the knots themselves.
void ReadingCostMaker::followKnots(ReadingCost& cost) const {
  const BatchState& reference = unknowns_.reference();
  if (cost.source.channel == kChannel<Prior> || !reference.path.isSpline()) return;
  cost.knot_effect = knotEffect(reference.effects);
  if (unknowns_.knotBlock() == nullptr) return;
  cost.at_reference = cost.onMovingKnots(cost.at_reference);
  cost.acting.set(*cost.knot_effect);
  cost.told.set(*cost.knot_effect);
}

void ReadingCostMaker::setPlaces(const Subject& subject, ForwardPoint& point) const {
  const BatchState& reference = unknowns_.reference();
  if (subject.panel != kNone) point.T_odom_panel = reference.T_odom_panel[subject.panel];
  if (!data_.panels.empty()) point.first_panel_odom = data_.panels.front().T_odom_panel.position;
  point.water = reference.water;
  point.flaws = reference.flaws;
  point.T_left_right = reference.T_left_right;
  point.sea_floor_z_m = reference.sea_floor_z_m;
}

/// When it was valid, and which poses that makes.
void ReadingCostMaker::setMotions(const Subject& subject, std::vector<double> node_s,
                                  ReadingCost& cost) const {
  ForwardPoint& point = cost.at_reference;
  point.validity_s = cost.model->validity_s(point);
  if (node_s.size() == 2 && node_s[0] == node_s[1]) node_s.pop_back();
  std::vector<MotionNode> nodes;
  for (const double t_s : node_s) nodes.push_back(unknowns_.nodeOf(t_s + point.validity_s, subject.image));
  if (nodes.empty()) nodes.push_back({0, 0, 0.0});  // whatever the robot's pose
  for (const MotionNode& node : nodes) cost.motions.push_back(motions_.add(node));
  if (subject.patch != nullptr || subject.blur != nullptr)
    point.motion = unknowns_.motionAt(cost.source.t_s + point.validity_s, subject.image);
  if (subject.patch != nullptr) {
    const MotionNode node = unknowns_.nodeOf(cost.source.t_s + point.validity_s, subject.image);
    cost.taken = {motions_.add(node), {}};
    for (int k = 0; k < node.count; ++k)
      cost.taken->blocks.push_back(
          unknowns_.placeOf(UnknownBlock::Kind::pose, static_cast<std::size_t>(node.first + k)));
    if (unknowns_.find(UnknownBlock::Kind::panel, subject.panel) != nullptr)
      cost.taken->blocks.push_back(unknowns_.placeOf(UnknownBlock::Kind::panel, subject.panel));
  }
  const auto [first, last] = std::minmax_element(
      nodes.begin(), nodes.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  cost.first_pose = first->first;
  cost.pose_count = last->first + last->count - first->first;
  for (int k = 0; k < cost.pose_count; ++k)
    cost.blocks.push_back(
        unknowns_.placeOf(UnknownBlock::Kind::pose, static_cast<std::size_t>(cost.first_pose + k)));
}

void ReadingCostMaker::addOthers(const Subject& subject, ReadingCost& cost) const {
  const auto add = [&](UnknownBlock::Kind kind, std::size_t index, int column) {
    cost.others.push_back({cost.blocks.size(), column});
    cost.blocks.push_back(unknowns_.placeOf(kind, index));
  };
  using enum UnknownBlock::Kind;
  if (subject.marker != nullptr && unknowns_.find(panel, subject.panel) != nullptr)
    add(panel, subject.panel, kPanelColumn);
  if (cost.source.tie_point >= 0) add(right_camera, 0, kRightColumn);
  if (cost.source.channel == kChannel<Altimeter>) add(sea_floor, 0, kFloorColumn);
  if (subject.patch != nullptr) add(water, 0, kWaterColumn);
  if (subject.patch != nullptr || subject.blur != nullptr || cost.source.specks >= 0)
    add(flaws, 0, kFlawColumn);
}

/// The scalars are a block's coordinates, times a factor.
void ReadingCostMaker::link(std::size_t block, const std::vector<std::size_t>& scalars, double factor,
                            ReadingCost& cost) const {
  int coordinate = 0;
  cost.blocks.push_back(block);
  for (const std::size_t s : scalars) cost.links.push_back({s, cost.blocks.size() - 1, coordinate++, factor});
}

void ReadingCostMaker::linkDrift(ReadingCost& cost) const {
  const BatchState& reference = unknowns_.reference();
  const auto track = reference.driftOf(cost.source.channel, cost.source.instance);
  if (!track) return;
  const std::size_t effect = *modelOf(cost.source.channel).drift_effect;
  const std::vector<std::size_t> components = continuousScalars(effect);
  ForwardPoint& point = cost.at_reference;
  point.on.set(effect);
  const auto linkKnot = [&](std::size_t k, double share) {
    link(unknowns_.placeOf(UnknownBlock::Kind::drift, *track, k), components, share, cost);
    for (std::size_t i = 0; i < components.size(); ++i)
      point.effects[components[i]] += share * reference.drifts[*track].knots[k][static_cast<Eigen::Index>(i)];
  };
  const std::size_t knots = reference.drifts[*track].knots.size();
  if (knots == 1) return linkKnot(0, 1.0);
  const double at = std::clamp((cost.source.t_s - reference.path.begin_s) / reference.drift_interval_s, 0.0,
                               static_cast<double>(knots) - 1.0);
  const auto k = std::min(static_cast<std::size_t>(at), knots - 2);
  const double share = at - static_cast<double>(k);
  linkKnot(k, 1.0 - share);
  linkKnot(k + 1, share);
}

void ReadingCostMaker::linkEffects(ReadingCost& cost) const {
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (cost.acting[e] && cost.told[e] && unknowns_.find(UnknownBlock::Kind::effect, e) != nullptr &&
        unknowns_.reference().effects.concerns(e, cost.source.instance))
      link(unknowns_.placeOf(UnknownBlock::Kind::effect, e), continuousScalars(e), 1.0, cost);
}

/// Drawn anew for each image: of its own one's.
void ReadingCostMaker::linkDraws(const Subject& subject, ReadingCost& cost) const {
  const std::vector<Draw>& draws = unknowns_.draws();
  for (std::size_t i = 0; subject.patch != nullptr && i < draws.size(); ++i) {
    const auto& [scalar, of_image] = draws[i];
    if (of_image != subject.image || !cost.acting[effectOf(scalar)]) continue;
    cost.at_reference.effects[scalar] = unknowns_.reference().drawn(draws[i]);
    link(unknowns_.placeOf(UnknownBlock::Kind::draw, i), {scalar}, 1.0, cost);
  }
}

double ReadingCostMaker::thresholdOf(Channel channel, Eigen::Index rows) {
  if (!textOf(channel).has_outliers || options_.robust_probability >= 1.0) return 0.0;
  const auto [known, is_new] = robust_thresholds_.try_emplace(rows);
  if (is_new)
    known->second = std::sqrt(chiSquareQuantile(static_cast<double>(rows), options_.robust_probability));
  return known->second;
}

}  // namespace fathom
