#pragma once

#include <Eigen/LU>
#include <algorithm>
#include <bitset>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "effects/catalogue.h"
#include "estimation/batch_cost.h"
#include "estimation/readings.h"

/// The two kinds of rows that a batch problem is made of: of a reading, and of what is linear.
namespace fathom {

/// Effects that look at the motion besides the pose, whatever the sensor: latencies and the shutter.
inline const std::bitset<kEffectCount>& effectsOfMotion() {
  static const std::bitset<kEffectCount> mask = [] {
    std::bitset<kEffectCount> effects;
    forEachEffect([&]<class Effect>() {
      using Stage = typename Effect::template Stage<double>;
      effects[kEffectIndex<Effect>] = kIsValidityOffset<Stage> || std::is_same_v<Stage, Shutter<double>>;
    });
    return effects;
  }();
  return mask;
}

/// An effect's scalar as a sum of unknowns.
struct Link {
  std::size_t scalar = 0;
  std::size_t block = 0;  ///< place among the cost's blocks
  int coordinate = 0;     ///< in that block
  double factor = 1.0;
};

/// Rows of one reading.
class ReadingCost final : public BatchCost {
 public:
  ReadingCost(const MotionTable& table, const std::vector<UnknownBlock>& unknowns)
      : table_(table), unknowns_(unknowns) {}

  std::unique_ptr<ReadingModel> model;
  ForwardPoint at_reference;         ///< but for the motion
  std::vector<std::size_t> motions;  ///< whose predictions' mean it is: their numbers in the table
  Eigen::VectorXd reading;
  Eigen::MatrixXd whitening;
  int first_pose = 0, pose_count = 0;  ///< their blocks come first
  /// Beside the robot's poses: the panel's, the right camera's, the water, the images' flaws.
  struct Other {
    std::size_t block = 0;  ///< place among the cost's blocks
    int column = 0;         ///< the model's first
  };
  std::vector<Other> others;
  std::vector<Link> links;
  std::optional<std::size_t> knot_effect;  ///< of what looks at the path: see knotEffect()
  std::bitset<kEffectCount> acting, told;  ///< effects in the model; those it can tell something of
  /// Poses that are taken as they are: the motion's number in the table, its poses, and the panel's behind
  /// them where that is an unknown.
  struct Taken {
    std::size_t motion = 0;
    std::vector<std::size_t> blocks;
  };
  std::optional<Taken> taken;

  void finish() {
    finishSetup(unknowns_, static_cast<int>(reading.size()));
    local_.clear();
    int column = 0;
    for (const std::size_t b : blocks) {
      local_.push_back(column);
      column += unknowns_[b].size;
    }
    local_.push_back(column);
    columns_ = model->motionColumns();
    if ((acting & effectsOfMotion()).any()) {
      columns_.clear();
      for (int c = 0; c < kMotionSize; ++c) columns_.push_back(c);
    }
    motion_columns_ = columns_.size();
    for (const auto& [block, first] : others)
      for (int c = 0; c < blockAt(block).size; ++c) columns_.push_back(first + c);
    for (const Link& link : links) {
      const int c = kEffectColumn + static_cast<int>(link.scalar);
      if (std::find(columns_.begin(), columns_.end(), c) == columns_.end()) columns_.push_back(c);
    }
  }

  void compute(const BatchPoint& at, Eigen::VectorXd& residual, Eigen::MatrixXd* derivative) const override {
    ForwardPoint point = pointAt(at.x);
    Eigen::VectorXd prediction = Eigen::VectorXd::Zero(reading.size());
    if (derivative != nullptr) derivative->setZero(reading.size(), local_.back());
    Eigen::MatrixXd slope;
    for (const std::size_t motion : motions) {
      setMotion(point, at.motions, motion);
      if (derivative == nullptr) {
        prediction += model->predict(point);
        continue;
      }
      prediction += model->differentiate(point, columns_, slope);
      accumulate(slope, at.motions.derivatives[motion], table_.node(motion), *derivative);
    }
    const double share = 1.0 / static_cast<double>(motions.size());
    residual = whitening * (reading - share * prediction);
    if (derivative == nullptr) return;
    *derivative = (-share * whitening.lazyProduct(*derivative)).eval();  // small: blocks would only cost
    for (std::size_t b = 0; b < blocks.size(); ++b) turnByRightJacobian(at.x, b, *derivative);
  }

  ByTaken byTaken(const Motions& at) const override {
    if (!taken) return {};
    ForwardPoint point = at_reference;
    setMotion(point, at, taken->motion);
    std::vector<int> columns;
    for (const int first : {kPositionColumn, kOrientationColumn})
      for (int i = 0; i < 3; ++i) columns.push_back(first + i);
    const auto motion_columns = std::ssize(columns);
    const Eigen::Index poses = 6 * table_.node(taken->motion).count;
    const Eigen::Index of_panel = 6 * std::ssize(taken->blocks) - poses;
    for (int i = 0; i < of_panel; ++i) columns.push_back(kPanelColumn + i);
    Eigen::MatrixXd slope;
    model->differentiate(point, columns, slope);
    const MotionJacobian& by_poses = at.derivatives[taken->motion];
    Eigen::MatrixXd derivative = Eigen::MatrixXd::Zero(slope.rows(), poses + of_panel);
    for (Eigen::Index c = 0; c < motion_columns; ++c)
      derivative.leftCols(poses) +=
          slope.col(c) * by_poses.row(columns[static_cast<std::size_t>(c)]).head(poses);
    derivative.rightCols(of_panel) = slope.rightCols(of_panel);
    return {taken->blocks, -whitening * derivative};
  }

  /// So that the effect that knots follow moves them; as at_reference where it has that one's value.
  ForwardPoint onMovingKnots(ForwardPoint point) const {
    point.on.set(*knot_effect);
    point.knot_latency_s = point.effects[kEffectOffsets[*knot_effect]];
    return point;
  }

  bool dependsOn(std::size_t effect) const override { return model->dependsOn(effect); }

  Eigen::MatrixXd raw(const Eigen::MatrixXd& residuals) const override {
    const Eigen::FullPivLU<Eigen::MatrixXd> factors(whitening);
    Eigen::MatrixXd all(residuals.rows(), residuals.cols());
    for (Eigen::Index k = 0; k < all.cols(); ++k) all.col(k) = factors.solve(residuals.col(k));
    return all;
  }

  void effectColumns(const Motions& at, Eigen::Ref<Eigen::MatrixXd> columns) const override {
    columns.setZero();
    std::vector<std::size_t> wanted;
    for (std::size_t e = 0; e < kEffectCount; ++e)
      for (std::size_t s = kEffectOffsets[e]; told[e] && s < kEffectOffsets[e + 1]; ++s)
        if (isDifferentiated(parameterOf(s).kind)) wanted.push_back(s);
    const Eigen::MatrixXd scale = -1.0 / static_cast<double>(motions.size()) * whitening;
    for (const std::size_t motion : motions) {
      ForwardPoint point = at_reference;
      point.knot_latency_s.reset();  // the path as it is
      setMotion(point, at, motion);
      for (std::size_t first = 0; first < wanted.size(); first += kColumnsAtOnce)
        addColumns(point, std::span(wanted).subspan(first, std::min(kColumnsAtOnce, wanted.size() - first)),
                   scale, columns);
    }
  }

  Eigen::VectorXd knotColumn(const Motions& at) const override {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(reading.size(), 1), slope;
    if (!knot_effect) return sum;
    ForwardPoint point = onMovingKnots(at_reference);
    const std::vector<int> column{kEffectColumn + static_cast<int>(kEffectOffsets[*knot_effect])};
    for (const std::size_t motion : motions) {
      setMotion(point, at, motion);
      model->differentiate(point, column, slope);
      sum += slope;
    }
    return -1.0 / static_cast<double>(motions.size()) * whitening * sum;
  }

 private:
  static constexpr std::size_t kColumnsAtOnce = 8;

  /// Others that are neutral change nothing, so only those are switched on that are differentiated by: some
  /// are costly.
  void addColumns(ForwardPoint point, std::span<const std::size_t> wanted, const Eigen::MatrixXd& scale,
                  Eigen::Ref<Eigen::MatrixXd> columns) const {
    std::vector<int> model_columns;
    for (const std::size_t s : wanted) {
      point.on.set(effectOf(s));
      model_columns.push_back(kEffectColumn + static_cast<int>(s));
    }
    Eigen::MatrixXd slope;
    model->differentiate(point, model_columns, slope);
    slope = (scale * slope).eval();
    for (std::size_t i = 0; i < wanted.size(); ++i)
      columns.col(static_cast<Eigen::Index>(wanted[i])) += slope.col(static_cast<Eigen::Index>(i));
  }

  void setMotion(ForwardPoint& point, const Motions& at, std::size_t motion) const {
    if (table_.node(motion).count > 0) point.motion = at.values[motion];
  }

  ForwardPoint pointAt(const Eigen::VectorXd& x) const {
    ForwardPoint point = at_reference;
    for (const auto& [block, first] : others) {
      const int at = blockAt(block).column;
      if (first == kPanelColumn) point.T_odom_panel = retracted(point.T_odom_panel, x.segment<6>(at));
      if (first == kRightColumn) point.T_left_right = retracted(point.T_left_right, x.segment<6>(at));
      if (first == kWaterColumn) point.water += x.segment<9>(at);
      if (first == kFloorColumn) point.sea_floor_z_m += x[at];
      if (first == kFlawColumn) point.flaws += x.segment<kFlaws>(at);
    }
    for (const Link& link : links)
      point.effects[link.scalar] += link.factor * x[blockAt(link.block).column + link.coordinate];
    return point;
  }

  const UnknownBlock& blockAt(std::size_t place) const { return unknowns_[blocks[place]]; }

  /// Chain rule: columns of the model -> columns of the blocks.
  void accumulate(const Eigen::MatrixXd& slope, const MotionJacobian& motion_slope, const MotionNode& node,
                  Eigen::MatrixXd& derivative) const {
    // Most of a motion's derivatives are zero: a position moves with positions only, axis by axis.
    auto by_pose = derivative.middleCols(6 * (node.first - first_pose), 6 * node.count);
    for (std::size_t c = 0; c < motion_columns_; ++c)
      for (Eigen::Index p = 0; p < by_pose.cols(); ++p)
        if (const double factor = motion_slope(columns_[c], p); factor != 0.0)
          by_pose.col(p) += factor * slope.col(static_cast<Eigen::Index>(c));
    auto next = static_cast<Eigen::Index>(motion_columns_);
    for (const Other& other : others) {
      const int size = blockAt(other.block).size;
      derivative.middleCols(local_[other.block], size) += slope.middleCols(next, size);
      next += size;
    }
    for (const Link& link : links) {
      const auto c =
          std::find(columns_.begin(), columns_.end(), kEffectColumn + static_cast<int>(link.scalar));
      derivative.col(local_[link.block] + link.coordinate) += link.factor * slope.col(c - columns_.begin());
    }
  }

  /// Derivatives so far are by the error of the pose at x; the unknown is that of the reference.
  void turnByRightJacobian(const Eigen::VectorXd& x, std::size_t place, Eigen::MatrixXd& derivative) const {
    const UnknownBlock& block = blockAt(place);
    if (block.kind != UnknownBlock::Kind::pose && block.kind != UnknownBlock::Kind::panel &&
        block.kind != UnknownBlock::Kind::right_camera)
      return;
    const Vector3d turn = x.segment<3>(block.column + 3);
    auto columns = derivative.middleCols<3>(local_[place] + 3);
    columns = (columns * rightJacobianSO3<double>(turn)).eval();
  }

  const MotionTable& table_;
  const std::vector<UnknownBlock>& unknowns_;
  std::vector<int> local_;    ///< first column of each block; the last entry is their number
  std::vector<int> columns_;  ///< by which the model is differentiated: motion, panel, scalars
  std::size_t motion_columns_ = 0;
};

/// r = value + sum of slope x over its blocks.
class LinearCost final : public BatchCost {
 public:
  LinearCost(const std::vector<UnknownBlock>& unknowns, std::vector<std::size_t> of,
             const Eigen::VectorXd& value, const Eigen::MatrixXd& slope)
      : unknowns_(unknowns), value_(value), slope_(slope) {
    blocks = std::move(of);
    finishSetup(unknowns_, static_cast<int>(value_.size()));
  }

  void compute(const BatchPoint& at, Eigen::VectorXd& residual, Eigen::MatrixXd* derivative) const override {
    residual = value_;
    int column = 0;
    for (const std::size_t b : blocks) {
      const int size = unknowns_[b].size;
      residual += slope_.middleCols(column, size) * at.x.segment(unknowns_[b].column, size);
      column += size;
    }
    if (derivative != nullptr) *derivative = slope_;
  }

 private:
  const std::vector<UnknownBlock>& unknowns_;
  Eigen::VectorXd value_;
  Eigen::MatrixXd slope_;
};

}  // namespace fathom
