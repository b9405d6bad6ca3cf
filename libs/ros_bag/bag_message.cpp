#include "ros_bag/bag_message.h"

#include "core/text.h"

namespace fathom {

Vector3d BagMessage::finite(const Vector3d& v, const std::string& field) const {
  if (!v.allFinite()) throw error(field + " is not finite");
  return v;
}

double BagMessage::finite(double value, const std::string& field) const {
  if (!std::isfinite(value)) throw error(field + " is not finite");
  return value;
}

Matrix3d BagMessage::rotation(const ros1::Quaternion& q) const {
  const Eigen::Quaterniond quaternion(q.w, q.x, q.y, q.z);
  if (!quaternion.coeffs().allFinite() || std::abs(quaternion.norm() - 1.0) > 0.2)
    throw error(print("orientation is not a unit quaternion: its norm is %g", quaternion.norm()));
  return quaternion.normalized().toRotationMatrix();
}

BadMessage BagMessage::error(const std::string& why) const { return {bag_, where(), why}; }

std::string BagMessage::where() const {
  return instance_.getTopic() + ", message " + std::to_string(number_);
}

}  // namespace fathom
