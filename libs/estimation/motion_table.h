#pragma once

#include <map>
#include <vector>

#include "estimation/motion.h"

namespace fathom {

/// Motions by their number in a table, and their derivatives, which are left out unless asked for.
struct Motions {
  std::vector<Motion> values;
  std::vector<MotionJacobian> derivatives;
};

/// The nodes that a problem's readings look at, each once: gyro, accelerometer and attitude of one instant
/// share theirs, and a spline's motion costs as much as what a sensor's model makes of it.
class MotionTable {
 public:
  /// Number of a node: the same for equal ones.
  std::size_t add(const MotionNode& node);
  const MotionNode& node(std::size_t number) const { return nodes_[number]; }
  /// Of all nodes, on all cores.
  Motions at(const PosePath& path, bool with_derivatives) const;

 private:
  std::vector<MotionNode> nodes_;
  std::map<MotionNode, std::size_t> number_of_;
};

}  // namespace fathom
