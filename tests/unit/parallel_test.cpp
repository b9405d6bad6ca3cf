// Loops on all cores.
#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

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

}  // namespace
}  // namespace fathom
