#pragma once

#include <opencv2/core.hpp>

#include "core/random.h"
#include "ordinary.h"
#include "sealed_case.h"
#include "sight_lines.h"
#include "vehicle.h"

namespace fathom::sealed {

/// From the light before the lens to numbers: lens, port, sensor, response.
class Exposure {
 public:
  Exposure(const Vehicle& vehicle, const SealedCase& sealed);

  /// Blue, green, red, 8 bits, as OpenCV writes them. `log_gain`: of this image, standard normal.
  cv::Mat3b expose(const cv::Mat3f& light, const SightLines& sight, double stamp_s, double log_gain,
                   Random& random) const;

 private:
  void addFlatField();
  double ordinaryLogGain(double stamp_s) const;
  void coverView(cv::Mat3f& light, double stamp_s) const;
  void passPort(cv::Mat3f& light) const;
  void passLens(cv::Mat3f& light, const SightLines& sight, double stamp_s) const;
  void spreadPoints(cv::Mat3f& light, double stamp_s) const;
  void strewLight(cv::Mat3f& light, double stamp_s) const;
  void weighColours(cv::Mat3f& light, const SightLines& sight, double stamp_s) const;
  void countElectrons(cv::Mat3f& light, Random& random) const;
  void mosaic(cv::Mat3f& light, double stamp_s) const;
  cv::Mat3b compressed(const cv::Mat3b& image, double stamp_s) const;
  cv::Mat3d sharpened(const cv::Mat3d& readings, double stamp_s) const;
  cv::Mat3b respond(const cv::Mat3f& light, double stamp_s) const;

  const Vehicle& vehicle_;
  const SealedCase& sealed_;
  cv::Mat3f sensitivity_;  ///< of each pixel: not all alike in a rich or ordinary recording
  FieldTable response_;    ///< fraction that a number is larger by, over numbers
  Vector2d blotch_;
};

}  // namespace fathom::sealed
