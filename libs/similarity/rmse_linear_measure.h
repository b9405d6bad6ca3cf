#pragma once

#include <array>
#include <cmath>

#include "imaging/image_model.h"
#include "similarity/measure.h"

namespace fathom {

/// How far apart the light is that the two images stand for, on the panel: root mean square over its pixels
/// and red, green and blue, in shares of the camera's full scale.
/// Source: the camera's response undone, radianceOf() in imaging/image_model.h.
struct RmseLinearMeasure {
  static constexpr std::string_view id = "rmse-linear";
  static constexpr std::string_view about =
      "root mean square difference of linear light on the panel, of full scale";
  static constexpr std::array<Quantity, 1> quantities{{{"rmse", "1", Better::lower}}};

  static MeasureOutcome measure(const PairView& pair) {
    if (const std::string why = whyNot(*pair.operator->()); !why.empty()) return notMeasured(why);
    const cv::Mat recorded = radianceOf(pair->recorded, *pair->camera);
    const cv::Mat simulated = radianceOf(pair->simulated, *pair->camera);
    const double distance = cv::norm(recorded, simulated, cv::NORM_L2, pair->panel_mask);
    return {{distance / std::sqrt(3.0 * cv::countNonZero(pair->panel_mask))}, ""};
  }

 private:
  static std::string whyNot(const ImagePair& pair) {
    if (pair.camera == nullptr) return "the camera is not known";
    if (pair.camera->bits != 8)
      return "the camera has " + std::to_string(pair.camera->bits) + " bits, the images 8";
    if (pair.panel_mask.empty()) return "where the panel is in the image is not known";
    if (pair.panel_mask.type() != CV_8UC1 || pair.panel_mask.size() != pair.recorded.size())
      return "the panel's mask is of another size or type than the images";
    if (cv::countNonZero(pair.panel_mask) == 0) return "the panel is not in the image";
    return "";
  }
};

}  // namespace fathom
