#include "similarity/inverse_transform.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "similarity/wide_vectors.h"

namespace fathom {
namespace {

constexpr int kLanes = InverseTransform::kLanes;

std::vector<int> factorsOf(int length) {
  std::vector<int> factors;
  for (const int factor : {5, 3, 4})
    for (; length % factor == 0; length /= factor) factors.push_back(factor);
  for (int factor = 2; length > 1; ++factor)
    for (; length % factor == 0; length /= factor) factors.push_back(factor);
  return factors;
}

/// A group of a stage. Input r is a + i b from r * step on, output k is x + i y from k * size on; each is of
/// `size` numbers with the same twiddle factors.
struct Span {
  std::ptrdiff_t size, step;
};

FATHOM_WIDE_VECTORS void combine4(const float* __restrict a, const float* __restrict b, float* __restrict x,
                                  float* __restrict y, const Span& span, const float* cosines,
                                  const float* sines) {
  const auto n = span.size, step = span.step;
  const float c1 = cosines[0], c2 = cosines[1], c3 = cosines[2], s1 = sines[0], s2 = sines[1], s3 = sines[2];
  FATHOM_INDEPENDENT
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const float sum02 = a[i] + a[i + 2 * step], difference02 = a[i] - a[i + 2 * step];
    const float sum13 = a[i + step] + a[i + 3 * step], difference13 = a[i + step] - a[i + 3 * step];
    const float isum02 = b[i] + b[i + 2 * step], idifference02 = b[i] - b[i + 2 * step];
    const float isum13 = b[i + step] + b[i + 3 * step], idifference13 = b[i + step] - b[i + 3 * step];
    const float p1 = difference02 - idifference13, q1 = idifference02 + difference13;
    const float p2 = sum02 - sum13, q2 = isum02 - isum13;
    const float p3 = difference02 + idifference13, q3 = idifference02 - difference13;
    x[i] = sum02 + sum13, y[i] = isum02 + isum13;
    x[i + n] = c1 * p1 - s1 * q1, y[i + n] = c1 * q1 + s1 * p1;
    x[i + 2 * n] = c2 * p2 - s2 * q2, y[i + 2 * n] = c2 * q2 + s2 * p2;
    x[i + 3 * n] = c3 * p3 - s3 * q3, y[i + 3 * n] = c3 * q3 + s3 * p3;
  }
}

FATHOM_WIDE_VECTORS void combine3(const float* __restrict a, const float* __restrict b, float* __restrict x,
                                  float* __restrict y, const Span& span, const float* cosines,
                                  const float* sines) {
  constexpr float cosine = -0.5F, sine = 0.866025404F;  // of a third of a turn
  const auto n = span.size, step = span.step;
  const float c1 = cosines[0], c2 = cosines[1], s1 = sines[0], s2 = sines[1];
  FATHOM_INDEPENDENT
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const float sum = a[i + step] + a[i + 2 * step], isum = b[i + step] + b[i + 2 * step];
    const float across = sine * (a[i + step] - a[i + 2 * step]),
                iacross = sine * (b[i + step] - b[i + 2 * step]);
    const float along = a[i] + cosine * sum, ialong = b[i] + cosine * isum;
    const float p1 = along - iacross, q1 = ialong + across, p2 = along + iacross, q2 = ialong - across;
    x[i] = a[i] + sum, y[i] = b[i] + isum;
    x[i + n] = c1 * p1 - s1 * q1, y[i + n] = c1 * q1 + s1 * p1;
    x[i + 2 * n] = c2 * p2 - s2 * q2, y[i + 2 * n] = c2 * q2 + s2 * p2;
  }
}

FATHOM_WIDE_VECTORS void combine5(const float* __restrict a, const float* __restrict b, float* __restrict x,
                                  float* __restrict y, const Span& span, const float* cosines,
                                  const float* sines) {
  constexpr float cosine1 = 0.309016994F, sine1 = 0.951056516F;  // of a fifth of a turn
  constexpr float cosine2 = -0.809016994F, sine2 = 0.587785252F;
  const auto n = span.size, step = span.step;
  const float c1 = cosines[0], c2 = cosines[1], c3 = cosines[2], c4 = cosines[3];
  const float s1 = sines[0], s2 = sines[1], s3 = sines[2], s4 = sines[3];
  FATHOM_INDEPENDENT
  for (std::ptrdiff_t i = 0; i < n; ++i) {
    const float sum1 = a[i + step] + a[i + 4 * step], isum1 = b[i + step] + b[i + 4 * step];
    const float sum2 = a[i + 2 * step] + a[i + 3 * step], isum2 = b[i + 2 * step] + b[i + 3 * step];
    const float less1 = a[i + step] - a[i + 4 * step], iless1 = b[i + step] - b[i + 4 * step];
    const float less2 = a[i + 2 * step] - a[i + 3 * step], iless2 = b[i + 2 * step] - b[i + 3 * step];
    const float along1 = a[i] + cosine1 * sum1 + cosine2 * sum2;
    const float ialong1 = b[i] + cosine1 * isum1 + cosine2 * isum2;
    const float along2 = a[i] + cosine2 * sum1 + cosine1 * sum2;
    const float ialong2 = b[i] + cosine2 * isum1 + cosine1 * isum2;
    const float across1 = sine1 * less1 + sine2 * less2, iacross1 = sine1 * iless1 + sine2 * iless2;
    const float across2 = sine2 * less1 - sine1 * less2, iacross2 = sine2 * iless1 - sine1 * iless2;
    const float p1 = along1 - iacross1, q1 = ialong1 + across1, p4 = along1 + iacross1,
                q4 = ialong1 - across1;
    const float p2 = along2 - iacross2, q2 = ialong2 + across2, p3 = along2 + iacross2,
                q3 = ialong2 - across2;
    x[i] = a[i] + sum1 + sum2, y[i] = b[i] + isum1 + isum2;
    x[i + n] = c1 * p1 - s1 * q1, y[i + n] = c1 * q1 + s1 * p1;
    x[i + 2 * n] = c2 * p2 - s2 * q2, y[i + 2 * n] = c2 * q2 + s2 * p2;
    x[i + 3 * n] = c3 * p3 - s3 * q3, y[i + 3 * n] = c3 * q3 + s3 * p3;
    x[i + 4 * n] = c4 * p4 - s4 * q4, y[i + 4 * n] = c4 * q4 + s4 * p4;
  }
}

/// Any factor: each output the sum of all inputs, turned.
FATHOM_WIDE_VECTORS void combineAny(const float* __restrict a, const float* __restrict b, float* __restrict x,
                                    float* __restrict y, const Span& span, int factor, const float* cosines,
                                    const float* sines) {
  const auto n = span.size;
  for (int k = 0; k < factor; ++k) {
    std::fill_n(x + k * n, n, 0.0F), std::fill_n(y + k * n, n, 0.0F);
    for (int r = 0; r < factor; ++r) {
      const float c = cosines[k * factor + r], s = sines[k * factor + r];
      const auto from = r * span.step, to = k * n;
      FATHOM_INDEPENDENT
      for (std::ptrdiff_t i = 0; i < n; ++i) {
        x[to + i] += c * a[from + i] - s * b[from + i];
        y[to + i] += c * b[from + i] + s * a[from + i];
      }
    }
  }
}

bool hasOwnCode(int factor) { return factor >= 3 && factor <= 5; }

/// A constant count takes no call.
inline void copyLanes(const float* from, int count, float* to) {
  count == kLanes ? std::copy_n(from, kLanes, to) : std::copy_n(from, count, to);
}

/// Up to kLanes columns of a spectrum, filtered, as lanes.
struct FilteredColumns {
  const float *real, *imaginary, *filter, *other_filter;
  std::ptrdiff_t row_step;
  int rows, count;
};

FATHOM_WIDE_VECTORS void load(const FilteredColumns& columns, float* __restrict real,
                              float* __restrict imaginary) {
  for (int v = 0; v < columns.rows; ++v) {
    const std::ptrdiff_t from = v * columns.row_step, to = static_cast<std::ptrdiff_t>(v) * kLanes;
    FATHOM_INDEPENDENT
    for (int lane = 0; lane < columns.count; ++lane) {
      const float filter = columns.filter[from + lane] * columns.other_filter[from + lane];
      real[to + lane] = filter * columns.real[from + lane];
      imaginary[to + lane] = filter * columns.imaginary[from + lane];
    }
  }
}

}  // namespace

InverseTransform::InverseTransform(int length) {
  int remaining = length, stride = 1;
  for (const int factor : factorsOf(length)) {
    Stage stage{factor, remaining / factor, stride, {}, {}};
    for (int q = 0; q < stage.groups; ++q)
      for (int k = hasOwnCode(factor) ? 1 : 0; k < factor; ++k)
        for (int r = 0; r < (hasOwnCode(factor) ? 1 : factor); ++r) {
          const double turns = static_cast<double>(q) * k / remaining + static_cast<double>(r) * k / factor;
          stage.cosines.push_back(static_cast<float>(std::cos(2 * std::numbers::pi * turns)));
          stage.sines.push_back(static_cast<float>(std::sin(2 * std::numbers::pi * turns)));
        }
    stages_.push_back(std::move(stage));
    remaining /= factor, stride *= factor;
  }
}

int InverseTransform::run(float* const real[2], float* const imaginary[2]) const {
  int from = 0;
  for (const Stage& stage : stages_) {
    const int to = 1 - from;
    const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(stage.stride) * kLanes;
    const auto twiddles = static_cast<std::ptrdiff_t>(stage.cosines.size()) / stage.groups;
    for (int q = 0; q < stage.groups; ++q) {
      const Span span{size, stage.groups * size};
      const float *a = real[from] + q * size, *b = imaginary[from] + q * size;
      float *x = real[to] + stage.factor * q * size, *y = imaginary[to] + stage.factor * q * size;
      const float *cosines = stage.cosines.data() + q * twiddles, *sines = stage.sines.data() + q * twiddles;
      switch (stage.factor) {
        case 3:
          combine3(a, b, x, y, span, cosines, sines);
          break;
        case 4:
          combine4(a, b, x, y, span, cosines, sines);
          break;
        case 5:
          combine5(a, b, x, y, span, cosines, sines);
          break;
        default:
          combineAny(a, b, x, y, span, stage.factor, cosines, sines);
      }
    }
    from = to;
  }
  return from;
}

FilteredTransform::Lanes::Lanes(int length) {
  constexpr std::size_t kApart = 5 * kLanes;  // so that not all begin at the same place of a cache
  const std::size_t size = static_cast<std::size_t>(length) * kLanes + kApart;
  numbers_.resize(4 * size);
  for (std::size_t i = 0; i < 2; ++i) {
    real[i] = numbers_.data() + 2 * i * size;
    imaginary[i] = numbers_.data() + (2 * i + 1) * size;
  }
}

FilteredTransform::FilteredTransform(const cv::Size& size)
    : size_(size), along_columns_(size.height), along_rows_(size.width) {}

FilteredTransform::Workspace::Workspace(const cv::Size& size)
    : columns(size.height),
      rows(size.width),
      between{cv::Mat(size.width, size.height, CV_32FC1), cv::Mat(size.width, size.height, CV_32FC1)} {}

FilteredTransform::Workspace FilteredTransform::workspace() const { return Workspace(size_); }

void FilteredTransform::run(const SplitImage& spectrum, const cv::Mat& filter, const cv::Mat& other_filter,
                            Workspace& work, SplitImage& result) const {
  for (auto* image : {&result.real, &result.imaginary}) image->create(size_.width, size_.height, CV_32FC1);
  for (int u = 0; u < size_.width; u += kLanes) transformColumns(spectrum, filter, other_filter, u, work);
  for (int v = 0; v < size_.height; v += kLanes) transformRows(v, work, result);
}

void FilteredTransform::transformColumns(const SplitImage& spectrum, const cv::Mat& filter,
                                         const cv::Mat& other_filter, int u, Workspace& work) const {
  const int count = std::min(kLanes, size_.width - u);
  const Lanes& lanes = work.columns;
  load({spectrum.real.ptr<float>() + u, spectrum.imaginary.ptr<float>() + u, filter.ptr<float>() + u,
        other_filter.ptr<float>() + u, size_.width, size_.height, count},
       lanes.real[0], lanes.imaginary[0]);
  const int at = along_columns_.run(lanes.real, lanes.imaginary);
  for (int lane = 0; lane < count; ++lane) {
    auto *real = work.between.real.ptr<float>(u + lane),
         *imaginary = work.between.imaginary.ptr<float>(u + lane);
    for (int v = 0; v < size_.height; ++v) {
      real[v] = lanes.real[at][v * kLanes + lane];
      imaginary[v] = lanes.imaginary[at][v * kLanes + lane];
    }
  }
}

void FilteredTransform::transformRows(int v, Workspace& work, SplitImage& result) const {
  const int count = std::min(kLanes, size_.height - v);
  const Lanes& lanes = work.rows;
  for (int u = 0; u < size_.width; ++u) {
    copyLanes(work.between.real.ptr<float>(u) + v, count, lanes.real[0] + u * kLanes);
    copyLanes(work.between.imaginary.ptr<float>(u) + v, count, lanes.imaginary[0] + u * kLanes);
  }
  const int at = along_rows_.run(lanes.real, lanes.imaginary);
  for (int u = 0; u < size_.width; ++u) {
    copyLanes(lanes.real[at] + u * kLanes, count, result.real.ptr<float>(u) + v);
    copyLanes(lanes.imaginary[at] + u * kLanes, count, result.imaginary.ptr<float>(u) + v);
  }
}

}  // namespace fathom
