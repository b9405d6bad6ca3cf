#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/marine_snow.h"
#include "sensors/vehicle.h"

/// Specks on plain surfaces: pixels that are off what their surroundings show, by far more than noise. Marine
/// snow makes them; water, lamps, lens and sensor do not.
namespace fathom {

/// Pixels side by side of one surface, which show about the same.
struct SpeckCell {
  Backdrop backdrop;
  BySpeckClass inside = BySpeckClass::Zero();  ///< pixels so far inside that a speck of that class counts
};

struct SpeckCount {
  BySpeckClass specks = BySpeckClass::Zero();  ///< counted
  std::vector<SpeckCell> cells;                ///< what was looked at
};

/// In which flakes would have made specks there; `environment`: the base model's, with which the light came.
SpeckVolumes volumesOf(const std::vector<SpeckCell>& cells, const Environment& environment);

/// What an image is, and what is known of what it shows; all of one size.
struct SpeckImage {
  cv::Mat light;   ///< CV_32FC3 as radianceOf() gives it: red green blue, linear
  cv::Mat mask;    ///< CV_8UC1, not 0 where a known surface of one albedo is, some pixels from every edge
  cv::Mat labels;  ///< CV_32SC1: which surface; below 0: none that counts
  cv::Mat z_m;     ///< CV_32FC1, of the surface, along the optical axis
};

/// Counts specks of each class.
///
/// What is behind them: on each label a polynomial of second degree in the pixel's place, for each colour,
/// fitted robustly (Tukey's weights). So neither a wrong albedo nor a gradient of light looks like a speck,
/// and a tenth of the pixels may be covered. Noise: the sheet's, with rounding, or what the label's pixels
/// scatter by where that is more (texture). A colour that is at full scale does not count.
///
/// A speck counts where its middle is so far inside the mask that all of one of its class would be, the
/// nearest flake's included; volumes are of the same pixels. Else specks that the mask cuts would be fewer,
/// and smaller.
///
/// Not for images kept as JPEG: it smears small specks (some are missed), those of strong contrast ring
/// through its blocks (up to twice as many are counted at a quality of 90), and dark slopes become steps.
///
/// `lens`: the image's own.
SpeckCount countSpecks(const SpeckImage& image, const CameraSheet& sheet, const CameraModel& lens);

}  // namespace fathom
