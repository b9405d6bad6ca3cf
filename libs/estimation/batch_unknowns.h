#pragma once

#include <Eigen/Core>
#include <bitset>
#include <cstddef>
#include <map>
#include <tuple>
#include <vector>

#include "estimation/batch_cost.h"
#include "estimation/batch_state.h"
#include "estimation/motion.h"

namespace fathom {

/// The unknowns of a batch problem: error coordinates of a reference state, zero there, added up by at().
class BatchUnknowns {
 public:
  /// estimate: effects whose continuous parameters are unknown.
  BatchUnknowns(const BatchData& data, const std::bitset<kEffectCount>& estimate,
                const BatchState& reference);

  const BatchState& reference() const { return reference_; }
  BatchState at(const Eigen::VectorXd& x) const;
  /// The path of at().
  PosePath pathAt(const Eigen::VectorXd& x) const;

  /// In the order of elimination: by time, then what is constant.
  const std::vector<UnknownBlock>& blocks() const { return blocks_; }
  /// Null: not estimated.
  const UnknownBlock* find(UnknownBlock::Kind kind, std::size_t index, std::size_t knot = 0) const;
  /// Of the effect that knots follow, see knotEffect(): null where none does or it is not estimated.
  const UnknownBlock* knotBlock() const;
  /// Its place among blocks(); there must be one.
  std::size_t placeOf(UnknownBlock::Kind kind, std::size_t index, std::size_t knot = 0) const {
    return place_of_.at({kind, index, knot});
  }
  /// Number of coordinates.
  int size() const { return size_; }
  /// Of effects that are on, or estimated: by effect, then by image.
  const std::vector<Draw>& draws() const { return draws_; }

  /// Whether it is known at all where the robot was when an image was taken.
  bool hasPose(std::size_t image) const;
  /// What the motion at a stamp, or on an image, is made of; the image must have a pose.
  MotionNode nodeOf(double t_s, std::size_t image) const;
  /// That of the reference.
  Motion motionAt(double t_s, std::size_t image) const;

 private:
  void layOut(const BatchData& data, const std::bitset<kEffectCount>& estimate);
  void addDraws(const BatchData& data, std::size_t effect);
  void placeBlocks();

  BatchState reference_;
  std::vector<UnknownBlock> blocks_;
  std::map<std::tuple<UnknownBlock::Kind, std::size_t, std::size_t>, std::size_t> place_of_;
  std::vector<Draw> draws_;
  std::vector<std::size_t> image_pose_;  ///< of poses by themselves: by image
  int size_ = 0;
};

}  // namespace fathom
