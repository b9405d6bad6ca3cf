#include "estimation/motion_table.h"

#include "core/parallel.h"

namespace fathom {

std::size_t MotionTable::add(const MotionNode& node) {
  const auto [entry, is_new] = number_of_.emplace(node, nodes_.size());
  if (is_new) nodes_.push_back(node);
  return entry->second;
}

Motions MotionTable::at(const PosePath& path, bool with_derivatives) const {
  Motions motions;
  motions.values.resize(nodes_.size());
  if (with_derivatives) motions.derivatives.resize(nodes_.size());
  parallelFor(nodes_.size(), [&](std::size_t i) {
    motions.values[i] = motionOf(path, nodes_[i]);
    if (with_derivatives) motions.derivatives[i] = motionJacobian(path, nodes_[i]);
  });
  return motions;
}

}  // namespace fathom
