#include <iostream>
#include <memory>

#include "batch/slurm.h"
#include "commands.h"
#include "core/child_process.h"
#include "core/error.h"
#include "core/files.h"
#include "reports/batch_report.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct BatchCommandOptions {
  std::string config, folder, share = "1/1";
  std::size_t at_once = 0, tasks = 100, cores_a_task = 1;
  bool slurm = false, wait = false, collect = false, no_report = false;
  std::vector<std::string> sbatch;
};

/// This program, wherever it was started from.
fs::path ownProgram() { return fs::read_symlink("/proc/self/exe"); }

/// Collects what there is: of jobs that others still run, nothing.
BatchStory storyOf(BatchPlan plan, const fs::path& folder, const RunContext& context) {
  BatchStory story{{.command_line = context.command_line}, std::move(plan), {}};
  for (const BatchJob& job : story.plan.jobs) story.outcomes.push_back(outcomeOf(job, folder));
  return story;
}

void report(const BatchStory& story, const fs::path& folder) {
  writeOutputs(story, folder);
  std::cout << formatTable(progressTable(story));
  if (!story.plan.columns.empty()) std::cout << "\n" << formatTable(summaryTable(story));
  for (std::size_t i = 0; i < story.outcomes.size(); ++i)
    if (story.outcomes[i].state == JobOutcome::State::failed)
      std::cout << story.plan.jobs[i].name << ": " << story.outcomes[i].complaint << "\n";
  std::cout << "\nreport: " << (folder / "report.html").string() << "\n";
}

/// sbatch with these options and script; the job's number.
std::string submit(const BatchCommandOptions& options, const std::vector<std::string>& more,
                   const fs::path& script) {
  std::vector<std::string> words{"sbatch", "--parsable"};
  words.insert(words.end(), options.sbatch.begin(), options.sbatch.end());
  words.insert(words.end(), more.begin(), more.end());
  words.push_back(script);
  const fs::path log = script.parent_path() / "sbatch.txt";
  const ChildResult child = runChild(words, log);
  if (child.status != 0 || child.signal != 0) throw Error("sbatch", "", lastLineOf(log));
  return submittedJob(readTextFile(log));
}

void submitToSlurm(const BatchCommandOptions& options, const BatchStory& story) {
  const std::size_t open = story.outcomes.size() - story.count(JobOutcome::State::done);
  if (open == 0) return;
  const fs::path folder = fs::absolute(options.folder) / "slurm";
  const std::vector<std::string> words{ownProgram(), "batch", options.config, "--out", options.folder};
  const SlurmScripts scripts =
      slurmScripts(words, std::min(options.tasks, open), folder.string(), options.cores_a_task);
  writeTextFile(folder / "array.sh", scripts.array);
  writeTextFile(folder / "collect.sh", scripts.collect);
  const std::string array = submit(options, {}, folder / "array.sh");
  std::cout << open << " jobs go to Slurm as job " << array << "\n" << std::flush;
  std::vector<std::string> after{"--dependency=afterany:" + array};
  if (options.wait) after.emplace_back("--wait");
  std::cout << "collected by job " << submit(options, after, folder / "collect.sh") << "\n";
}

void runBatchCommand(const BatchCommandOptions& options, const RunContext& context) {
  const BatchPlan plan = readBatchPlan(options.config);
  const fs::path folder = options.folder;
  const Share share = shareOf("--share", options.share);
  if (options.slurm) {
    submitToSlurm(options, storyOf(plan, folder, context));
    if (!options.wait) return;
  } else if (!options.collect) {
    runJobs(plan, {.program = ownProgram(), .folder = folder, .at_once = options.at_once, .share = share});
  }
  if (!options.no_report) report(storyOf(plan, folder, context), folder);
}

}  // namespace

void addBatch(const RunContext& context) {
  auto* command = context.root->add_subcommand(
      "batch", "Run commands on many recordings, resumable, on this machine or a Slurm cluster");
  command->footer(
      "CONFIG lists recordings (files, or folders of them), runs (a command, its options, seeds) and which "
      "numbers\n"
      "of each result.json go into the table; see config/batch.yaml. Each recording of each run with each "
      "seed is a\n"
      "job: a command of its own, with a folder of its own, OUT/jobs/NAME, what it prints in log.txt. Many "
      "jobs run\n"
      "at once, each on one core.\n"
      "\n"
      "The same command goes on where it was stopped, killed or ran out of disk: jobs that are done are not "
      "run\n"
      "again, but where the recording, the command or the program has changed. Failed ones are tried again. "
      "Any\n"
      "number of machines that share OUT can run the same command at once; each job is run by one of them.\n"
      "\n"
      "With --slurm the jobs that are not done go to the cluster as a job array, each task a share of them; "
      "tasks of\n"
      "lost nodes are queued again. A last job collects. Writes batch.csv, result.json, report.html, and "
      "costs.csv:\n"
      "time and memory of each job.\n"
      "\n"
      "Examples:\n"
      "  fathom batch config/batch.yaml --out out/batch\n"
      "  fathom batch config/batch.yaml --out out/batch --share 2/5\n"
      "  fathom batch config/batch.yaml --out out/batch --slurm --tasks 200 --sbatch=--time=4:00:00");
  const auto options = std::make_shared<BatchCommandOptions>();
  command->add_option("CONFIG", options->config, "What to run on what")->required()->type_name(values::kYaml);
  command->add_option("--out", options->folder, "Where results go")->required()->type_name(values::kFolder);
  command->add_option("--at-once", options->at_once, "Jobs at once; 0: one a core")->capture_default_str();
  command->add_option("--share", options->share, "Of the jobs, on one of several machines: 2/5")
      ->capture_default_str();
  command->add_flag("--collect", options->collect, "Run nothing, report what there is");
  command->add_flag("--no-report", options->no_report, "Run only");
  command->add_flag("--slurm", options->slurm, "Submit to Slurm instead of running here");
  command->add_flag("--wait", options->wait, "With --slurm: until all is done and collected");
  command->add_option("--tasks", options->tasks, "With --slurm: tasks of the job array, at most")
      ->check(CLI::Range(1, 100000))
      ->capture_default_str();
  command->add_option("--cores-a-task", options->cores_a_task, "With --slurm: and jobs at once in each")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_option("--sbatch", options->sbatch, "With --slurm: an option for sbatch, as often as needed");
  command->callback([options, &context] { runBatchCommand(*options, context); });
}

}  // namespace fathom
