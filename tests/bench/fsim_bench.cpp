// How many 640x480 images FSIM compares in a second on one core, beside OpenCV's SSIM in the same run. Each
// takes pairs (both images new) and one kept reference with image after image. Times are the thread's
// own, medians of rounds that take turns, so that what else the machine does hits all alike.
#include <cstdio>
#include <ctime>
#include <functional>
#include <opencv2/quality/qualityssim.hpp>
#include <vector>

#include "core/median.h"
#include "similarity/fsim.h"
#include "support/textured_images.h"

namespace fathom {
namespace {

constexpr int kRounds = 41;

double now_s() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double secondsOf(const std::function<void()>& work) {
  const double begin = now_s();
  work();
  return now_s() - begin;
}

struct Contender {
  const char* name;
  std::function<void()> work;
  std::vector<double> seconds{};

  double median_s() const { return upperMedian(seconds); }
};

void run() {
  const cv::Mat reference = test::texturedImage({640, 480}, 1);
  const cv::Mat image = test::noisy(test::blurred(reference, 1.5), 4, 2);
  const FsimComparer comparer;
  const FsimFeatures kept = comparer.features(reference);
  const auto ssim = cv::quality::QualitySSIM::create(reference);
  std::vector<Contender> contenders{
      {"FSIM and FSIMc of a pair", [&] { comparer.compare(reference, image); }},
      {"SSIM of a pair, three channels",
       [&] { cv::quality::QualitySSIM::compute(reference, image, cv::noArray()); }},
      {"FSIM and FSIMc, reference kept", [&] { FsimComparer::compare(kept, comparer.features(image)); }},
      {"SSIM, three channels, reference kept", [&] { ssim->compute(image); }},
  };
  for (int round = 0; round < kRounds; ++round)
    for (auto& contender : contenders) contender.seconds.push_back(secondsOf(contender.work));
  for (auto& contender : contenders)
    std::printf("%-38s %6.2f ms, %6.1f a second\n", contender.name, 1e3 * contender.median_s(),
                1 / contender.median_s());
  std::printf("FSIM's time over SSIM's: pair %.2f, reference kept %.2f\n",
              contenders[0].median_s() / contenders[1].median_s(),
              contenders[2].median_s() / contenders[3].median_s());
}

}  // namespace
}  // namespace fathom

int main() {
  cv::setNumThreads(1);
  fathom::run();
}
