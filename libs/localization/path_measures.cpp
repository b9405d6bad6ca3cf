#include "localization/path_measures.h"

#include <cmath>

#include "core/uncertain_pose.h"

namespace fathom {
namespace {

/// Sums for Pearson's correlation of pairs.
class Correlation {
 public:
  void add(double x, double y) {
    ++n_;
    const double dx = x - mean_x_, dy = y - mean_y_;
    mean_x_ += dx / n_;
    mean_y_ += dy / n_;
    xx_ += dx * (x - mean_x_);
    yy_ += dy * (y - mean_y_);
    xy_ += dx * (y - mean_y_);
  }
  /// Nothing where one of the two does not vary.
  std::optional<double> r() const {
    constexpr double kStill = 1e-18;  // increments of a nanometre or nanoradian are rounding
    if (n_ < 2 || xx_ / n_ < kStill || yy_ / n_ < kStill) return std::nullopt;
    return xy_ / std::sqrt(xx_ * yy_);
  }

 private:
  double n_ = 0, mean_x_ = 0, mean_y_ = 0, xx_ = 0, yy_ = 0, xy_ = 0;
};

Vector6d increment(const Pose& from, const Pose& to) {
  Vector6d result;
  result << to.position - from.position, logSO3<double>(from.rotation.transpose() * to.rotation);
  return result;
}

}  // namespace

std::optional<PathErrors> errorsAgainst(const std::vector<StampedPose>& reference,
                                        const std::vector<StampedPose>& path) {
  std::vector<double> positions, angles;
  for (const StampedPose& there : reference) {
    const auto here = poseAt(path, there.time);
    if (!here) continue;
    positions.push_back((here->position - there.T_odom_robot.position).norm());
    angles.push_back(angleBetween(here->rotation, there.T_odom_robot.rotation));
  }
  if (positions.empty()) return std::nullopt;
  return PathErrors{positions.size(), meanAndSigma(positions), meanAndSigma(angles)};
}

std::optional<PathSmoothness> smoothnessOf(const std::vector<StampedPose>& path,
                                           const std::vector<Time>& times) {
  std::array<Correlation, 6> axes;
  std::optional<Pose> last;
  std::optional<Vector6d> last_increment;
  double products = 0, terms = 0;
  for (const Time& time : times) {
    const auto pose = poseAt(path, time);
    if (!pose || !last) {
      last = pose;
      last_increment.reset();
      continue;
    }
    products += pose->position.dot(last->position);
    ++terms;
    const Vector6d step = increment(*last, *pose);
    if (last_increment)
      for (std::size_t axis = 0; axis < axes.size(); ++axis) {
        const auto i = static_cast<Eigen::Index>(axis);
        axes[axis].add((*last_increment)[i], step[i]);
      }
    last = pose;
    last_increment = step;
  }
  double sum = 0, moving = 0;
  for (const Correlation& axis : axes)
    if (const auto r = axis.r()) {
      sum += *r;
      ++moving;
    }
  if (moving == 0) return std::nullopt;
  return PathSmoothness{sum / moving, products / terms};
}

}  // namespace fathom
