#pragma once

#include <cstddef>
#include <limits>
#include <vector>

namespace fathom {

/// Of a set of errors; NaN where there are none.
struct ErrorSummary {
  std::size_t count = 0;
  double mean = std::numeric_limits<double>::quiet_NaN();
  double sigma = std::numeric_limits<double>::quiet_NaN();   ///< about the mean, of the set itself (1/n)
  double median = std::numeric_limits<double>::quiet_NaN();  ///< the mean of the two middle ones where even
  double largest = std::numeric_limits<double>::quiet_NaN();
};
ErrorSummary summaryOf(std::vector<double> errors);

/// A half-open interval; the last of a row includes its end.
struct Bin {
  double low = 0, high = 0;
  bool last = true;

  bool contains(double value) const { return value >= low && (value < high || (last && value <= high)); }
  double middle() const { return 0.5 * (low + high); }
};
/// [low, high] in pieces of `width`, the last one shorter where it must be; one bin where low is high.
std::vector<Bin> binsOf(double low, double high, double width);

}  // namespace fathom
