#include "diagnosis/stretches.h"

#include <algorithm>

#include "diagnosis/constants.h"

namespace fathom {

Stretches::Stretches(const BatchData& data, int folds)
    : is_instant_(!(data.last_s > data.first_s)),
      first_(is_instant_ ? 0 : data.first_s),
      folds_(folds),
      count_(folds * kStretches),
      span_((is_instant_ ? static_cast<double>(data.markers.size()) : data.last_s - first_) / count_) {}

int Stretches::foldOf(const RowInfo& row) const { return partOf(row) / kPartsOfStretch % folds_; }

int Stretches::partOf(const RowInfo& row) const {
  const double at = is_instant_ ? static_cast<double>(row.marker) : row.t_s;
  return std::clamp(static_cast<int>((at - first_) / span_ * kPartsOfStretch), 0,
                    count_ * kPartsOfStretch - 1);
}

}  // namespace fathom
