#include "batch/batch_run.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "batch/batch_plan.h"
#include "core/files.h"
#include "support/shared_data.h"

namespace fathom {
namespace {

// Half of a file, another program's, or what somebody wrote by hand: the job runs again.
TEST(BatchRun, ARecordOfSomethingElseIsNone) {
  const auto folder = test::scratchFolder();
  const BatchJob job{
      .name = "dive.TL2", .recording = {}, .run = "TL2", .seed = {}, .words = {"info", "dive.rawlog"}};
  const auto record = folderOf(job, folder) / "job.json";
  std::filesystem::create_directories(record.parent_path());
  for (const char* text :
       {"", "{", "[]", "\"done\"", "{}", R"({"inputs": 5})", R"({"inputs": "", "status": "done"})"}) {
    writeTextFile(record, text);
    EXPECT_EQ(outcomeOf(job, folder).state, JobOutcome::State::open) << text;
  }
}

// Names in a folder may lead anywhere, and back to themselves.
TEST(BatchPlan, WhatNobodyCanLookAtIsNoRecording) {
  const auto folder = test::scratchFolder();
  writeTextFile(folder / "dive.rawlog", "");
  std::filesystem::create_symlink(folder / "loop.rawlog", folder / "loop.rawlog");
  writeTextFile(folder / "batch.yaml",
                "recordings: [" + folder.string() + "]\nruns:\n  - {name: info, command: info}\n");
  const BatchPlan plan = readBatchPlan(folder / "batch.yaml");
  ASSERT_EQ(plan.jobs.size(), 1U);
  EXPECT_EQ(plan.jobs[0].recording.filename(), "dive.rawlog");
}

}  // namespace
}  // namespace fathom
