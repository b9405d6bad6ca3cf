// Time of fitting water to 50 pairs of 640 x 480 px, beside that of rendering them.
//
//     build/release/tests/fit_water_bench
#include <cstdio>

#include "support/stopwatch.h"
#include "water_images.h"

namespace {

using namespace fathom;
using test::seconds;

}  // namespace

int main() {
  const test::WaterImages bench("fathom-fit-water-bench", 50);
  const PosedImages& images = bench.images;
  const std::vector<std::size_t>& some = bench.nearest;
  const PairMaker maker = bench.maker();
  maker.clean(images.posed.front());  // tools are made once

  SynchronizedImages pairs;
  WaterFit fit;
  const double rendering_s = seconds([&] {
    for (const std::size_t i : some) maker.clean(images.posed[i]);
  });
  const double patches_s = seconds([&] { pairs = synchronize(images.posed, some, maker); });
  const double fit_s = seconds([&] { fit = fitWater(pairs.patches, pairs.images.size()); });
  std::printf(
      "%zu pairs, %zu patches\nrendering alone, one core: %.2f s\nrendering and patches, all cores: "
      "%.2f s\nfit: %.2f s\ntogether: %.2f s (asked: 20), %.1f times the rendering\n",
      pairs.images.size(), pairs.patches.size(), rendering_s, patches_s, fit_s, patches_s + fit_s,
      (patches_s + fit_s) / rendering_s);
  return fit.solved ? 0 : 1;
}
