#include "estimation/batch_unknowns.h"

#include <algorithm>
#include <limits>
#include <set>

#include "core/stable_sort.h"
#include "effects/catalogue.h"
#include "effects/drawn.h"

namespace fathom {
namespace {

using Kind = UnknownBlock::Kind;
constexpr std::size_t kNoPose = std::numeric_limits<std::size_t>::max();

}  // namespace

BatchUnknowns::BatchUnknowns(const BatchData& data, const std::bitset<kEffectCount>& estimate,
                             const BatchState& reference)
    : reference_(reference) {
  layOut(data, estimate);
  placeBlocks();
  for (std::size_t i = 0; i < reference_.images.size(); ++i) {
    image_pose_.resize(std::max(image_pose_.size(), reference_.images[i] + 1), kNoPose);
    image_pose_[reference_.images[i]] = i;
  }
}

/// Unknowns in the order in which a sparse factorization without fill eliminates them: poses by time, a drift
/// behind the last pose that shares a reading with it, then what is constant.
void BatchUnknowns::layOut(const BatchData& data, const std::bitset<kEffectCount>& estimate) {
  struct Placed {
    double at_s;
    UnknownBlock block;
  };
  std::vector<Placed> placed;
  const double knot_s = reference_.path.knot_s;
  for (std::size_t i = 0; i < reference_.path.poses.size(); ++i)
    placed.push_back({knot_s * (static_cast<double>(i) - 1.0), {Kind::pose, i, 6, 0}});
  const std::vector<DriftTrack>& drifts = reference_.drifts;
  for (std::size_t i = 0; i < drifts.size(); ++i)
    for (std::size_t k = 0; drifts[i].knots.size() > 1 && k < drifts[i].knots.size(); ++k)
      placed.push_back({reference_.drift_interval_s * (static_cast<double>(k) + 1.0) + 3.5 * knot_s,
                        {Kind::drift, i, static_cast<int>(drifts[i].knots[k].size()), 0, k}});
  stableSort(placed, [](const Placed& a, const Placed& b) { return a.at_s < b.at_s; });
  for (const Placed& p : placed) blocks_.push_back(p.block);
  for (std::size_t i = 0; i < drifts.size(); ++i)
    if (drifts[i].knots.size() == 1)
      blocks_.push_back({Kind::drift, i, static_cast<int>(drifts[i].knots[0].size()), 0});
  if (!data.of<Altimeter>().empty() && reference_.path.isSpline())
    blocks_.push_back({Kind::sea_floor, 0, 1, 0});
  for (std::size_t i = 0; i < data.panels.size(); ++i)
    if (data.panels[i].position_sigma_m > 0 && data.panels[i].angle_sigma_rad > 0)
      blocks_.push_back({Kind::panel, i, 6, 0});
  if (!data.tie_points.empty()) blocks_.push_back({Kind::right_camera, 0, 6, 0});
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (isDrawn(e) && (estimate[e] || reference_.effects.on[e])) addDraws(data, e);
  for (std::size_t i = 0; i < draws_.size(); ++i) blocks_.push_back({Kind::draw, i, 1, 0});
  if (!data.patches.empty()) blocks_.push_back({Kind::water, 0, 9, 0});
  if (!data.patches.empty() || !data.blurs.empty() || !data.specks.empty())
    blocks_.push_back({Kind::flaws, 0, kFlaws, 0});
  for (std::size_t e = 0; e < kEffectCount; ++e)
    if (const auto size = std::ssize(continuousScalars(e)); estimate[e] && size > 0)
      blocks_.push_back({Kind::effect, e, static_cast<int>(size), 0});
}

void BatchUnknowns::addDraws(const BatchData& data, std::size_t effect) {
  std::set<std::size_t> images;
  for (const ImagePatch& patch : data.patches)
    if (reference_.effects.active_s[effect].contains(patch.t_s)) images.insert(patch.image);
  for (std::size_t s = kEffectOffsets[effect]; s < kEffectOffsets[effect + 1]; ++s)
    for (const std::size_t image : images)
      if (parameterOf(s).kind == ParameterKind::spread) draws_.push_back({s, image});
}

void BatchUnknowns::placeBlocks() {
  for (std::size_t b = 0; b < blocks_.size(); ++b) {
    blocks_[b].column = size_;
    size_ += blocks_[b].size;
    place_of_[{blocks_[b].kind, blocks_[b].index, blocks_[b].knot}] = b;
  }
}

const UnknownBlock* BatchUnknowns::find(Kind kind, std::size_t index, std::size_t knot) const {
  const auto found = place_of_.find({kind, index, knot});
  return found == place_of_.end() ? nullptr : &blocks_[found->second];
}

const UnknownBlock* BatchUnknowns::knotBlock() const {
  const auto effect = knotEffect(reference_.effects);
  return effect && reference_.path.isSpline() ? find(Kind::effect, *effect) : nullptr;
}

PosePath BatchUnknowns::pathAt(const Eigen::VectorXd& x) const {
  PosePath path = reference_.path;
  for (const UnknownBlock& block : blocks_)
    if (block.kind == Kind::pose)
      path.poses[block.index] = retracted(path.poses[block.index], x.segment<6>(block.column));
  return path;
}

BatchState BatchUnknowns::at(const Eigen::VectorXd& x) const {
  BatchState state = reference_;
  state.path = pathAt(x);
  for (const UnknownBlock& block : blocks_) {
    const auto e = x.segment(block.column, block.size);
    if (block.kind == Kind::panel)
      state.T_odom_panel[block.index] = retracted(state.T_odom_panel[block.index], e);
    if (block.kind == Kind::right_camera) state.T_left_right = retracted(state.T_left_right, e);
    if (block.kind == Kind::water) state.water += e;
    if (block.kind == Kind::flaws) state.flaws += e;
    if (block.kind == Kind::drift) state.drifts[block.index].knots[block.knot] += e;
    if (block.kind == Kind::sea_floor) state.sea_floor_z_m += e[0];
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
  moveKnots(reference_.effects, state);
  return state;
}

MotionNode BatchUnknowns::nodeOf(double t_s, std::size_t image) const {
  if (reference_.path.isSpline()) return reference_.path.nodeAt(t_s);
  return {static_cast<int>(image_pose_[image]), 1, 0.0};
}

Motion BatchUnknowns::motionAt(double t_s, std::size_t image) const {
  return motionOf(reference_.path, nodeOf(t_s, image));
}

bool BatchUnknowns::hasPose(std::size_t image) const {
  return reference_.path.isSpline() || (image < image_pose_.size() && image_pose_[image] != kNoPose);
}

}  // namespace fathom
