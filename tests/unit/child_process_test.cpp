// Programs that are started, and how they ended.
#include "core/child_process.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <thread>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

std::filesystem::path logFile() {
  static const std::filesystem::path folder = test::scratchFolder();  // emptied at each call
  return folder / "log.txt";
}

ChildResult runScript(const std::string& script) { return runChild({"sh", "-c", script}, logFile()); }

TEST(ChildProcess, TellsHowItEnded) {
  EXPECT_EQ(runScript("exit 3").status, 3);
  EXPECT_EQ(runScript("kill -KILL $$").signal, 9);
  const ChildResult done = runScript("echo one; echo two >&2; echo");
  EXPECT_EQ(done.status, 0);
  EXPECT_GT(done.peak_mb, 0);
  EXPECT_EQ(lastLineOf(logFile()), "two");
  EXPECT_THROW(runChild({"/no/such/program"}, logFile()), Error);
}

TEST(ChildProcess, StaysOnOneCore) {
  std::thread([] {
    stayOnOneCore(1);
    EXPECT_EQ(runScript("test $(nproc) = 1").status, 0);
  }).join();
}

/// Exits with 7 where it was interrupted. In a process of its own: that is for good.
[[noreturn]] void runInterrupted(const std::string& script) {
  catchInterrupts();
  try {
    runScript(script);
  } catch (const Interrupted&) {
    std::_Exit(7);
  }
  std::_Exit(0);
}

// The terminal's key stops both: the child may be gone before it is asked to.
TEST(ChildProcess, WhatTheUserStoppedHasNoResult) {
  EXPECT_EXIT(runInterrupted("kill -INT $PPID; exit 130"), testing::ExitedWithCode(7), "");
  EXPECT_EXIT(runInterrupted("kill -INT $PPID; exec sleep 60"), testing::ExitedWithCode(7), "");
  // Deaf to being asked, since it may be asked before it has ended.
  EXPECT_EXIT(runInterrupted("trap '' TERM; kill -INT $PPID; exit 0"), testing::ExitedWithCode(0), "")
      << "that was whole";
}

}  // namespace
}  // namespace fathom
