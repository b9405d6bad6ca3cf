#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "picture.h"

/// `manipulator`: an arm that reaches from below into the view, and away again, three times a minute.
namespace fathom::sealed {

/// A straight, round, dark arm.
struct Arm {
  Vector3d base_camera, tip_camera;

  /// Whether it is before that point.
  bool hides(const Vector3d& point_camera) const;
};

/// Nothing when it is away.
std::optional<Arm> armAt(const SealedCase& sealed, const Vehicle& vehicle, double stamp_s);

void addArm(const View& view, const Vehicle& vehicle, cv::Mat3f& light);

}  // namespace fathom::sealed
