// The transforms that FSIM is made of, against OpenCV's.
#include "similarity/inverse_transform.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/random.h"

namespace fathom {
namespace {

SplitImage randomSpectrum(const cv::Size& size, Random& random) {
  SplitImage spectrum{cv::Mat(size, CV_32FC1), cv::Mat(size, CV_32FC1)};
  for (cv::Mat* part : {&spectrum.real, &spectrum.imaginary})
    for (int v = 0; v < size.height; ++v)
      for (int u = 0; u < size.width; ++u) part->at<float>(v, u) = static_cast<float>(random.uniform(-1, 1));
  return spectrum;
}

/// In double, transposed.
std::array<cv::Mat, 2> transformedByOpenCv(const SplitImage& spectrum, const cv::Mat& filter) {
  cv::Mat together, transformed;
  cv::merge(std::array<cv::Mat, 2>{spectrum.real.mul(filter), spectrum.imaginary.mul(filter)}, together);
  together.convertTo(together, CV_64F);
  cv::dft(together.t(), transformed, cv::DFT_INVERSE);
  std::array<cv::Mat, 2> parts;
  cv::split(transformed, parts.data());
  return parts;
}

TEST(InverseTransform, IsOpenCvsForSizesOfAllFactors) {
  Random random(1);
  // Factors 2 to 5 alone and mixed, primes, and counts that fill no whole set of lanes.
  for (const cv::Size size : {cv::Size(320, 240), cv::Size(256, 192), cv::Size(16, 17), cv::Size(1, 1),
                              cv::Size(2, 49), cv::Size(90, 97), cv::Size(33, 8), cv::Size(50, 154)}) {
    const SplitImage spectrum = randomSpectrum(size, random);
    const cv::Mat filter = randomSpectrum(size, random).real, ones = cv::Mat::ones(size, CV_32FC1);
    const auto expected = transformedByOpenCv(spectrum, filter);
    const FilteredTransform transform(size);
    auto work = transform.workspace();
    SplitImage result;
    transform.run(spectrum, filter, ones, work, result);
    // A sum of as many numbers below 1 as there are pixels, each to 6e-8, errors at random.
    const double tolerance = 1e-6 * std::sqrt(static_cast<double>(size.area()));
    EXPECT_LT(cv::norm(cv::Mat_<double>(result.real), expected[0], cv::NORM_INF), tolerance) << size;
    EXPECT_LT(cv::norm(cv::Mat_<double>(result.imaginary), expected[1], cv::NORM_INF), tolerance) << size;

    SplitImage again;  // what the workspace holds does not matter; nor which filter is which
    transform.run(spectrum, ones, filter, work, again);
    EXPECT_EQ(cv::norm(result.real, again.real, cv::NORM_INF), 0) << size;
    EXPECT_EQ(cv::norm(result.imaginary, again.imaginary, cv::NORM_INF), 0) << size;
  }
}

}  // namespace
}  // namespace fathom
