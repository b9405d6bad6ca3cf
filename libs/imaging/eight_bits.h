#pragma once

#include <opencv2/core.hpp>

/// Images of 16 bits as the eight that searches, similarities and pictures work on. The one place where they
/// become that, so that none of them cuts off what the others see.
namespace fathom {

/// The numbers that become 0 and 255.
struct LevelRange {
  double black = 0, white = 65535;
};

/// Of an image of 16 bits: from its darkest to its brightest number, without one pixel in 10 000 at either
/// end (hot and dead ones), so that a camera's 10 or 12 bits, or what little contrast turbid water leaves,
/// are kept wherever in the 16 they lie. No less than 256 numbers: nothing is drawn apart that is not there.
/// Where half of what 16 bits can hold is used, it is all of that: an image of 8 bits, each times 257,
/// becomes what it was.
LevelRange usedRange(const cv::Mat& image);
/// What holds both.
LevelRange joined(const LevelRange& a, const LevelRange& b);

/// CV_8U with as many channels, of CV_16U; an image of 8 bits is handed back as it is.
cv::Mat inEightBits(const cv::Mat& image, const LevelRange& range);
/// The same by its own usedRange(): what is to be seen in it, not how bright it was.
cv::Mat inEightBits(const cv::Mat& image);

/// How many bits an image's numbers have. Of 16, those that its camera's sheet says, unless a number is
/// beyond them: then they fill all 16.
int bitsOf(const cv::Mat& image, int sheet_bits);
/// Full scale to full scale, as measures of light want it.
cv::Mat fullScaleInEightBits(const cv::Mat& image, int sheet_bits);

}  // namespace fathom
