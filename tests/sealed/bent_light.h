#pragma once

#include "picture.h"

namespace fathom::sealed {

/// Scene and veil together, the scene's bent light where its bends take it.
cv::Mat3f withBentLight(const Picture& picture, const Camera& camera);

}  // namespace fathom::sealed
