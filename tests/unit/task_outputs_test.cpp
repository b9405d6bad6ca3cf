// What a task's outputs keep for its report.
#include "tasks/task_outputs.h"

#include <gtest/gtest.h>

#include "support/recordings.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

// However many entries are garbage, since when the estimate is not to be relied on is told.
TEST(TaskOutputs, WhatTellsOfTrustIsKeptAmongAnyNumberOfEvents) {
  const std::filesystem::path folder = test::scratchFolder();
  ResultsLog results(folder / "results.rawlog", {}, test::kStart, 1);
  TaskOutputs outputs(folder, "T", false, results, 0);
  for (std::size_t k = 0; k < 2 * TaskOutputs::kEventsKept; ++k)
    outputs.event({0.1 * static_cast<double>(k), "not-a-number", "garbage"});
  outputs.event({500.0, "lost", "in the dark"});
  outputs.event({600.0, "found", "after 100 s"});
  ASSERT_EQ(outputs.events().size(), TaskOutputs::kEventsKept + 2);
  EXPECT_EQ(outputs.events()[TaskOutputs::kEventsKept].kind, "lost");
  EXPECT_EQ(outputs.events().back().kind, "found");
}

}  // namespace
}  // namespace fathom
