// FSIM against the authors' values, against phase congruency computed slowly another way, and by its laws.
#include "similarity/fsim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <thread>
#include <vector>

#include "image_files/image_file.h"
#include "similarity/phase_congruency.h"
#include "support/shared_data.h"
#include "support/textured_images.h"

namespace fathom {
namespace {
using test::blurred;
using test::noisy;
using test::texturedImage;

FsimScore score(const cv::Mat& a, const cv::Mat& b) {
  const auto result = FsimComparer().compare(a, b);
  EXPECT_TRUE(result);
  return result.value_or(FsimScore{});
}

cv::Mat grayFloat(const cv::Mat& bgr) {
  cv::Mat gray;
  cv::cvtColor(bgr, gray, cv::COLOR_BGR2GRAY);
  gray.convertTo(gray, CV_32F);
  return gray;
}

/// Phase congruency by its definition: sums over every pixel for every frequency, filters laid out with the
/// zero frequency in the middle, the noise's energy from the filters as they look in the image.
class SlowPhaseCongruency {
  using Complex = std::complex<double>;
  using Field = std::vector<Complex>;

 public:
  explicit SlowPhaseCongruency(const cv::Mat& image) : rows_(image.rows), columns_(image.cols) {
    for (int v = 0; v < rows_; ++v)
      for (int u = 0; u < columns_; ++u) image_.emplace_back(image.at<float>(v, u));
    const Field spectrum = transform(image_, -1);
    std::vector<double> energy(image_.size(), 0.0), amplitude(image_.size(), 0.0);
    for (int o = 0; o < 4; ++o) addOrientation(spectrum, o, energy, amplitude);
    for (std::size_t i = 0; i < energy.size(); ++i) map_.push_back(energy[i] / amplitude[i]);
  }

  double at(int v, int u) const { return map_[indexOf(v, u)]; }

 private:
  std::size_t indexOf(int v, int u) const {
    return static_cast<std::size_t>(v) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(u);
  }

  /// exp(sign 2 pi i k n / count), summed along columns, then rows; index k runs from -count / 2.
  Field transform(const Field& from, int sign) const { return along(along(from, sign, true), sign, false); }
  Field along(const Field& from, int sign, bool vertical) const {
    const int count = vertical ? rows_ : columns_, others = vertical ? columns_ : rows_;
    const auto index = [&](int place, int other) {
      return vertical ? indexOf(place, other) : indexOf(other, place);
    };
    Field to(from.size());
    for (int k = 0; k < count; ++k)
      for (int n = 0; n < count; ++n) {
        // Of the two only one is a frequency, and that counts from the middle.
        const int frequency_times_place = sign < 0 ? (k - count / 2) * n : k * (n - count / 2);
        const Complex wave = std::polar(1.0, sign * 2 * std::numbers::pi * frequency_times_place / count);
        for (int other = 0; other < others; ++other) to[index(k, other)] += wave * from[index(n, other)];
      }
    if (sign > 0)
      for (auto& value : to) value /= count;
    return to;
  }

  double filter(int v, int u, int scale, int orientation) const {
    const auto frequency = [](int index, int count) {
      const int from_middle = index - count / 2;
      return static_cast<double>(from_middle) / (count % 2 == 1 ? count - 1 : count);
    };
    const double x = frequency(u, columns_), y = frequency(v, rows_), radius = std::hypot(x, y);
    if (radius == 0) return 0;
    const double radial =
        std::exp(-std::pow(std::log(radius * 6 * (1 << scale)), 2) / (2 * std::pow(std::log(0.55), 2)));
    const double low_pass = 1 / (1 + std::pow(radius / 0.45, 30));
    const double sigma = std::numbers::pi / 4 / 1.2;
    const double cosine = (x * std::cos(orientation * std::numbers::pi / 4) -
                           y * std::sin(orientation * std::numbers::pi / 4)) /
                          radius;
    const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
    return radial * low_pass * std::exp(-angle * angle / (2 * sigma * sigma));
  }

  void addOrientation(const Field& spectrum, int o, std::vector<double>& energy,
                      std::vector<double>& amplitude) const {
    std::vector<Field> responses, filters;
    double finest_filter = 0;
    for (int s = 0; s < 4; ++s) {
      Field filtered = spectrum, alone(spectrum.size());
      for (int v = 0; v < rows_; ++v)
        for (int u = 0; u < columns_; ++u) {
          const auto i = indexOf(v, u);
          const double value = filter(v, u, s, o);
          filtered[i] *= value;
          alone[i] = value;
          if (s == 0) finest_filter += value * value;
        }
      responses.push_back(transform(filtered, 1));
      filters.push_back(transform(alone, 1));
    }
    const double threshold = noiseThreshold(responses[0], filters, finest_filter);
    for (std::size_t i = 0; i < energy.size(); ++i) {
      Complex sum = 0;
      for (const auto& response : responses) sum += response[i];
      const Complex mean = sum / (std::abs(sum) + 1e-4);
      double in_phase = 0;
      for (const auto& response : responses) {
        const Complex turned = response[i] * std::conj(mean);
        in_phase += turned.real() - std::abs(turned.imag());
        amplitude[i] += std::abs(response[i]);
      }
      energy[i] += std::max(in_phase - threshold, 0.0);
    }
  }

  static double noiseThreshold(const Field& finest, const std::vector<Field>& filters, double finest_filter) {
    std::vector<double> energies;
    for (const Complex& value : finest) energies.push_back(std::norm(value));
    std::sort(energies.begin(), energies.end());
    const double median = 0.5 * (energies[(energies.size() - 1) / 2] + energies[energies.size() / 2]);
    const double power = median / std::log(2.0) / finest_filter;
    double squares = 0, products = 0;
    const auto count = static_cast<double>(finest.size());
    for (std::size_t i = 0; i < finest.size(); ++i)
      for (std::size_t a = 0; a < 4; ++a) {
        squares += filters[a][i].real() * filters[a][i].real() * count;
        for (std::size_t b = a + 1; b < 4; ++b)
          products += filters[a][i].real() * filters[b][i].real() * count;
      }
    const double tau = std::sqrt((2 * power * squares + 4 * power * products) / 2);
    return (tau * std::sqrt(std::numbers::pi / 2) + 2 * std::sqrt((2 - std::numbers::pi / 2) * tau * tau)) /
           1.7;
  }

  int rows_, columns_;
  Field image_;
  std::vector<double> map_;
};

TEST(Fsim, IsTheAuthorsOnTheirImages) {
  FATHOM_NEEDS_SHARED("data/fsim");
  const auto folder = test::sharedData("data/fsim");
  const FsimScore found = score(readImage(folder / "i01.bmp"), readImage(folder / "i01_01_5.bmp"));
  // Published to five digits.
  EXPECT_NEAR(found.fsim, 0.93674, 1e-5);
  EXPECT_NEAR(found.fsimc, 0.92587, 1e-5);
}

TEST(Fsim, PhaseCongruencyIsThatOfTheDefinition) {
  for (const cv::Size size : {cv::Size(64, 48), cv::Size(51, 49), cv::Size(49, 66)}) {
    const cv::Mat image = grayFloat(noisy(texturedImage(size, 3), 3, 4));
    const SlowPhaseCongruency slow(image);
    const cv::Mat fast = PhaseCongruency(size).of(image);
    double largest = 0;
    for (int v = 0; v < size.height; ++v)
      for (int u = 0; u < size.width; ++u) {
        // Single precision: 6e-8 of 255, through four divisions by energies of some digital numbers.
        EXPECT_NEAR(fast.at<float>(v, u), slow.at(v, u), 2e-5) << size << " at " << v << ", " << u;
        largest = std::max(largest, slow.at(v, u));
      }
    EXPECT_GT(largest, 0.5);  // there are edges to be found
  }
}

TEST(Fsim, PhaseCongruencyDoesNotDependOnContrast) {
  const cv::Mat image = grayFloat(texturedImage({96, 80}, 5));
  const PhaseCongruency congruency(image.size());
  // All but the least energy of 1e-4, that counts the more the fainter the image.
  EXPECT_LT(cv::norm(congruency.of(image), congruency.of(0.5 * image + 20), cv::NORM_INF), 1e-3);
}

TEST(Fsim, IsExactlyOneForAnImageAndItself) {
  for (const cv::Size size : {cv::Size(640, 480), cv::Size(48, 48), cv::Size(301, 187)}) {
    const cv::Mat image = noisy(texturedImage(size, 6), 2, 7);
    const FsimScore found = score(image, image.clone());
    EXPECT_EQ(found.fsim, 1.0) << size;
    EXPECT_EQ(found.fsimc, 1.0) << size;
  }
}

TEST(Fsim, IsSymmetric) {
  const cv::Mat image = texturedImage({320, 240}, 8), other = texturedImage({320, 240}, 9);
  const FsimScore forth = score(image, other), back = score(other, image);
  EXPECT_EQ(forth.fsim, back.fsim);
  EXPECT_EQ(forth.fsimc, back.fsimc);
  EXPECT_LT(forth.fsim, 0.9);
}

TEST(Fsim, FallsAsBlurAndNoiseGrow) {
  const cv::Mat image = texturedImage({320, 240}, 10);
  const FsimComparer comparer;
  const FsimFeatures reference = comparer.features(image);
  const auto falls = [&](auto&& worse, const std::vector<double>& strengths) {
    FsimScore last{1, 1};
    for (const double strength : strengths) {
      const auto found = FsimComparer::compare(reference, comparer.features(worse(strength)));
      ASSERT_TRUE(found);
      EXPECT_LT(found->fsim, last.fsim) << strength;
      EXPECT_LT(found->fsimc, last.fsimc) << strength;
      EXPECT_LE(found->fsimc, found->fsim);
      last = *found;
    }
    EXPECT_LT(last.fsim, 0.95);
    EXPECT_GT(last.fsim, 0);
  };
  falls([&](double sigma_px) { return blurred(image, sigma_px); }, {0.5, 1, 2, 4, 8});
  falls([&](double sigma) { return noisy(image, sigma, 11); }, {2, 5, 10, 20, 40});
}

TEST(Fsim, ColourCountsInFsimcOnly) {
  const cv::Mat image = texturedImage({320, 240}, 12);
  cv::Mat gray, as_bgr;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  cv::cvtColor(gray, as_bgr, cv::COLOR_GRAY2BGR);
  const FsimScore of_gray = score(gray, blurred(gray, 1)), of_bgr = score(as_bgr, blurred(as_bgr, 1));
  EXPECT_EQ(of_gray.fsim, of_gray.fsimc);
  EXPECT_EQ(of_gray.fsim, of_bgr.fsim);
  const FsimScore uncoloured = score(image, gray);
  EXPECT_GT(uncoloured.fsim, 0.999);  // but for the rounding of gray
  EXPECT_LT(uncoloured.fsimc, uncoloured.fsim - 0.005);
}

TEST(Fsim, LargeImagesAreAveragedAsTheAuthorsDo) {
  const cv::Mat image = noisy(texturedImage({766, 646}, 13), 5, 14);
  for (const auto& [part, factor] : {std::pair(cv::Rect(0, 0, 766, 646), 3), {cv::Rect(0, 0, 499, 399), 2}}) {
    const cv::Mat whole = image(part);
    const FsimFeatures features = FsimComparer().features(whole);
    EXPECT_EQ(features.in_phase.size(),
              cv::Size((whole.cols - 1) / factor + 1, (whole.rows - 1) / factor + 1));
    // conv2(I, ones(factor) / factor², 'same'), every factor-th: the window of an even factor reaches
    // farther right and down; outside the image there are zeros.
    const auto averaged = [&, f = factor](int v, int u) {
      double sum = 0;
      for (int i = 0; i < f; ++i)
        for (int j = 0; j < f; ++j) {
          const int row = v * f + f / 2 - i, column = u * f + f / 2 - j;
          if (row < 0 || column < 0 || row >= whole.rows || column >= whole.cols) continue;
          const auto bgr = whole.at<cv::Vec3b>(row, column);
          sum += 0.596 * bgr[2] - 0.274 * bgr[1] - 0.322 * bgr[0];
        }
      return sum / (f * f);
    };
    const int last_row = features.in_phase.rows - 1, last_column = features.in_phase.cols - 1;
    for (const auto& [v, u] : {std::pair(0, 0), {0, 5}, {7, 0}, {31, 57}, {last_row, last_column}})
      EXPECT_NEAR(features.in_phase.at<float>(v, u), averaged(v, u), 1e-4) << factor << ": " << v << ' ' << u;
  }
}

TEST(Fsim, PlainImagesHaveNothingToCompare) {
  const cv::Mat plain(240, 320, CV_8UC3, cv::Scalar(33, 77, 121)),
      other(240, 320, CV_8UC3, cv::Scalar::all(9));
  EXPECT_FALSE(FsimComparer().compare(plain, other));
  EXPECT_FALSE(FsimComparer().compare(plain, plain));
  const FsimScore found = score(plain, texturedImage({320, 240}, 15));
  EXPECT_GT(found.fsim, 0);
  EXPECT_LT(found.fsim, 0.8);
}

TEST(Fsim, SaysWhyImagesCannotBeCompared) {
  const cv::Mat good = texturedImage({64, 48}, 16);
  const auto why = [&](const cv::Mat& image) { return FsimComparer::whyNot(good, image).value_or(""); };
  EXPECT_EQ(why(good), "");
  EXPECT_EQ(why(cv::Mat()), "the image is empty");
  EXPECT_EQ(why(texturedImage({48, 64}, 1)), "the image is of 48 x 64 pixels, the reference of 64 x 48");
  EXPECT_NE(why(texturedImage({64, 47}, 1)).find("64 x 47"), std::string::npos);
  EXPECT_NE(why(cv::Mat(48, 64, CV_32FC3)).find("8 bits"), std::string::npos);
  EXPECT_THROW(FsimComparer().compare(good, cv::Mat()), std::invalid_argument);
  EXPECT_THROW(FsimComparer().compare(good, texturedImage({80, 60}, 1)), std::invalid_argument);
  EXPECT_THROW(PhaseCongruency({64, 48}).of(cv::Mat(48, 65, CV_32FC1)), std::invalid_argument);
  EXPECT_THROW(PhaseCongruency({64, 1}), std::invalid_argument);
}

TEST(Fsim, SixteenBitsKeepWhatIsInThem) {
  const cv::Mat reference = texturedImage({96, 96}, 3), image = blurred(reference, 2);
  const FsimScore eight = score(reference, image);
  const auto in16 = [](const cv::Mat& of, double gain, double offset) {
    cv::Mat result;
    of.convertTo(result, CV_16U, gain, offset);
    return result;
  };
  const FsimScore filled = score(in16(reference, 257, 0), in16(image, 257, 0));
  EXPECT_DOUBLE_EQ(filled.fsim, eight.fsim);
  EXPECT_DOUBLE_EQ(filled.fsimc, eight.fsimc);
  const FsimScore low = score(in16(reference, 0.8, 20000), in16(image, 0.8, 20000));
  EXPECT_NEAR(low.fsim, eight.fsim, 0.05);
}

TEST(Fsim, ThreadsMayShareAComparer) {
  std::vector<cv::Mat> images;
  for (unsigned i = 0; i < 12; ++i)
    images.push_back(texturedImage({96 + 16 * static_cast<int>(i % 3), 96}, 20 + i));
  const auto compared = [&](const FsimComparer& comparer, std::size_t i) {
    return comparer.compare(images[i], blurred(images[i], 2))->fsimc;
  };
  const FsimComparer shared;
  std::vector<double> together(images.size());
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (std::size_t i = t; i < images.size(); i += 4) together[i] = compared(shared, i);
    });
  for (auto& thread : threads) thread.join();
  for (std::size_t i = 0; i < images.size(); ++i) EXPECT_EQ(together[i], compared(FsimComparer(), i)) << i;
}

}  // namespace
}  // namespace fathom
