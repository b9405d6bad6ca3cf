#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>

namespace fathom {

/// y = slope x through zero, by least squares over numbers or vectors that are added one by one.
class Regression {
 public:
  void add(double x, double y) { xx_ += x * x, xy_ += x * y, yy_ += y * y, ++count_; }
  void add(const Eigen::Vector3d& x, const Eigen::Vector3d& y) {
    xx_ += x.squaredNorm(), xy_ += x.dot(y), yy_ += y.squaredNorm(), ++count_;
  }

  /// Sum of squares of y - slope x.
  double squareOff(double slope) const { return yy_ - 2 * slope * xy_ + slope * slope * xx_; }

  std::size_t count() const { return count_; }
  double slope() const { return xx_ > 0 ? xy_ / xx_ : 0; }
  /// From -1 to 1.
  double correlation() const { return xx_ > 0 && yy_ > 0 ? xy_ / std::sqrt(xx_ * yy_) : 0; }
  double rmsX() const { return count_ > 0 ? std::sqrt(xx_ / static_cast<double>(count_)) : 0; }
  double rmsY() const { return count_ > 0 ? std::sqrt(yy_ / static_cast<double>(count_)) : 0; }

 private:
  double xx_ = 0, xy_ = 0, yy_ = 0;
  std::size_t count_ = 0;
};

/// Whether b is a to so many parts of it, sign included.
inline bool isNear(double a, double b, double share) { return std::abs(a - b) <= share * std::abs(b); }

}  // namespace fathom
