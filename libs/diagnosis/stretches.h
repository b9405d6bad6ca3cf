#pragma once

#include "estimation/batch_data.h"
#include "estimation/linearization.h"

namespace fathom {

/// The recording cut into stretches, each a member of a fold, and each of parts for the bootstrap: of time,
/// or of the markers of a single image.
class Stretches {
 public:
  Stretches(const BatchData& data, int folds);

  int count() const { return count_; }
  bool areOfTime() const { return !is_instant_; }
  int foldOf(const RowInfo& row) const;
  /// Stretch by stretch.
  int partOf(const RowInfo& row) const;
  double begin_s(int stretch) const { return first_ + stretch * span_; }
  double length_s() const { return is_instant_ ? 0 : span_; }

 private:
  bool is_instant_;
  double first_;
  int folds_, count_;
  double span_;
};

}  // namespace fathom
