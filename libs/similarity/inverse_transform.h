#pragma once

#include <opencv2/core.hpp>
#include <vector>

namespace fathom {

/// A complex image as two of single precision, CV_32FC1: vectors of real numbers suit a processor better than
/// pairs.
struct SplitImage {
  cv::Mat real, imaginary;
};

/// Inverse Fourier transforms of one length, planned once: lanes of numbers side by side, each a signal.
/// Stockham's self-sorting form, in factors of 4, 3, 5 and what primes remain (e.g. Van Loan, "Computational
/// Frameworks for the Fast Fourier Transform", 1992, 1.7). Not scaled.
class InverseTransform {
 public:
  static constexpr int kLanes = 16;

  explicit InverseTransform(int length);

  /// Sample n of lane l is at n * kLanes + l. The result stands in the first pair of arrays or the second,
  /// whichever is returned as 0 or 1; the others are overwritten.
  int run(float* const real[2], float* const imaginary[2]) const;

 private:
  struct Stage {
    int factor, groups, stride;         ///< stride: of samples that are done with
    std::vector<float> cosines, sines;  ///< of each group, for each output but the first (all, for a prime)
  };
  std::vector<Stage> stages_;
};

/// Inverse transforms of filtered spectra of one size: four times as fast as general ones, for many of them.
/// A result is transposed (as it comes: saves a pass), not scaled, and the same on every processor.
class FilteredTransform {
  struct Lanes;

 public:
  /// What is written on the way, so that it need not be allocated each time. Of one thread.
  class Workspace;

  explicit FilteredTransform(const cv::Size& size);

  Workspace workspace() const;
  /// Of spectrum times both filters (CV_32FC1), all continuous. `result` is allocated where need be.
  void run(const SplitImage& spectrum, const cv::Mat& filter, const cv::Mat& other_filter, Workspace& work,
           SplitImage& result) const;

 private:
  void transformColumns(const SplitImage& spectrum, const cv::Mat& filter, const cv::Mat& other_filter, int u,
                        Workspace& work) const;
  void transformRows(int v, Workspace& work, SplitImage& result) const;

  cv::Size size_;
  InverseTransform along_columns_, along_rows_;
};

/// Two pairs of arrays for kLanes signals, for a pass to and fro.
struct FilteredTransform::Lanes {
  explicit Lanes(int length);
  float *real[2], *imaginary[2];

 private:
  std::vector<float> numbers_;
};

class FilteredTransform::Workspace {
  friend FilteredTransform;
  explicit Workspace(const cv::Size& size);
  Lanes columns, rows;
  SplitImage between;  ///< transformed along columns, which are now rows
};

}  // namespace fathom
