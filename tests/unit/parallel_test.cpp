// Loops on all cores.
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

#include "core/for_each.h"

namespace fathom {
namespace {

using namespace std::chrono_literals;

void waitFor(const std::atomic<bool>& what) {
  for (int i = 0; i < 2000 && !what; ++i) std::this_thread::sleep_for(1ms);
}

// Where one body throws, another one that is in the middle of a loop of its own is not left with half of it.
// (On one core they come one after the other, and nothing is told.)
TEST(ParallelFor, ALoopWithinIsWholeWhenAnotherBodyThrows) {
  std::atomic<bool> has_begun = false, has_thrown = false;
  std::atomic<int> done = 0;
  int done_when_it_ended = -1;
  EXPECT_THROW(parallelFor(2,
                           [&](int i) {
                             if (i == 0) {
                               waitFor(has_begun);
                               has_thrown = true;
                               throw std::runtime_error("stop");
                             }
                             parallelFor(100, [&](int) {
                               has_begun = true;
                               waitFor(has_thrown);
                               std::this_thread::sleep_for(1ms);
                               ++done;
                             });
                             done_when_it_ended = done;
                           }),
               std::runtime_error);
  EXPECT_TRUE(done_when_it_ended == 100 || done_when_it_ended == -1) << done_when_it_ended;
}

TEST(ForEachIndex, WorksOnNoMoreAtOnceThanAllowed) {
  std::atomic<int> now = 0, most = 0;
  std::vector<int> made(40, 0);
  const auto make = [&](std::size_t i) {
    const int running = ++now;
    for (int seen = most; seen < running && !most.compare_exchange_weak(seen, running);) {
    }
    parallelFor(10,
                [](int) { std::this_thread::sleep_for(200us); });  // whoever waits here takes no other one
    ++made[i];
    --now;
  };
  forEachIndex(made.size(), "", make, 1);
  EXPECT_EQ(most, 1);
  EXPECT_EQ(made, std::vector<int>(40, 1));
  forEachIndex(made.size(), "", make, 40);
  EXPECT_EQ(made, std::vector<int>(40, 2));
  EXPECT_THROW(forEachIndex(
                   5, "", [](std::size_t i) { throw std::runtime_error(i == 0 ? "first" : "later"); }, 1),
               std::runtime_error);
}

TEST(ForEachIndex, ManySmallImagesAtOnceAndOneLargeOne) {
  EXPECT_GE(imagesAtOnce(640, 480), 32u);
  EXPECT_EQ(imagesAtOnce(3840, 2160), 1u);
  EXPECT_EQ(imagesAtOnce(20000, 10000), 1u);
}

}  // namespace
}  // namespace fathom
