#include "batch/batch_run.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <exception>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/child_process.h"
#include "core/error.h"
#include "core/files.h"
#include "core/fingerprint.h"
#include "core/for_each.h"
#include "core/text.h"
#include "core/version.h"
#include "report/run_info.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr const char* kRecord = "job.json";
constexpr const char* kLog = "log.txt";
constexpr const char* kLock = "lock";

/// Held until destroyed, or until the process dies.
class Lock {
 public:
  explicit Lock(const fs::path& file) : descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0) throw Error(file.string(), "", std::strerror(errno));
    held_ = flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
  }
  ~Lock() { close(descriptor_); }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  bool held() const { return held_; }

 private:
  int descriptor_;
  bool held_ = false;
};

/// Of command, program and recording: that by size and time, since reading ten thousand of them to learn that
/// nothing is to be done would take hours.
std::string fingerprintOf(const BatchJob& job) {
  Fingerprint print;
  print.add(programVersion());
  for (const std::string& word : job.words) print.add(word).add("\n");
  std::error_code missing;
  print.add(static_cast<double>(fs::file_size(job.recording, missing)));
  print.add(static_cast<double>(fs::last_write_time(job.recording, missing).time_since_epoch().count()));
  return print.hex();
}

/// All but the lock.
void clear(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (entry.path().filename() != kLock) fs::remove_all(entry.path());
}

void runJob(const BatchJob& job, const BatchRunOptions& options) {
  const fs::path folder = folderOf(job, options.folder);
  fs::create_directories(folder);
  const Lock lock(folder / kLock);
  if (!lock.held() || outcomeOf(job, options.folder).state == JobOutcome::State::done) return;
  clear(folder);
  std::vector<std::string> words{options.program};
  words.insert(words.end(), job.words.begin(), job.words.end());
  words.insert(words.end(), {"--out", folder});
  const ChildResult child = runChild(words, folder / kLog);
  std::string complaint;
  if (child.signal != 0)
    complaint = "stopped by signal " + std::to_string(child.signal);
  else if (child.status != 0)
    complaint = lastLineOf(folder / kLog);
  writeJson(folder / kRecord, {{"job", job.name},
                               {"inputs", fingerprintOf(job)},
                               {"status", child.signal != 0 ? 128 + child.signal : child.status},
                               {"complaint", complaint},
                               {"wall_s", child.wall_s},
                               {"cpu_s", child.cpu_s},
                               {"peak_mb", child.peak_mb}});
}

/// As many threads as jobs at once, each taking the next job.
template <class Run>
void inThreads(std::size_t threads, std::size_t jobs, const Run& run) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::thread> all;
  for (std::size_t thread = 0; thread < threads; ++thread)
    all.emplace_back([&, thread] {
      if (threads > 1) stayOnOneCore(thread);
      for (std::size_t i = next++; i < jobs && !interrupted(); i = next++) run(i);
    });
  for (std::thread& thread : all) thread.join();
}

}  // namespace

fs::path folderOf(const BatchJob& job, const fs::path& folder) { return folder / "jobs" / job.name; }

JobOutcome outcomeOf(const BatchJob& job, const fs::path& folder) try {
  JobOutcome outcome;
  const fs::path record = folderOf(job, folder) / kRecord, result = folderOf(job, folder) / "result.json";
  if (!isThere(record)) return outcome;
  const auto json = nlohmann::json::parse(readTextFile(record), nullptr, false);
  if (!json.is_object() || json.value("inputs", "") != fingerprintOf(job)) return outcome;
  outcome.wall_s = json.value("wall_s", 0.0);
  outcome.cpu_s = json.value("cpu_s", 0.0);
  outcome.peak_mb = json.value("peak_mb", 0.0);
  outcome.state = json.value("status", 1) == 0 ? JobOutcome::State::done : JobOutcome::State::failed;
  outcome.complaint = json.value("complaint", "");
  if (outcome.state == JobOutcome::State::done && isThere(result))
    outcome.result = nlohmann::ordered_json::parse(readTextFile(result), nullptr, false);
  return outcome;
} catch (const nlohmann::json::exception&) {  // a record of something else
  return {};
}

void runJobs(const BatchPlan& plan, const BatchRunOptions& options) {
  std::vector<const BatchJob*> mine;
  for (std::size_t i = 0; i < plan.jobs.size(); ++i)
    if (options.share.has(i)) mine.push_back(&plan.jobs[i]);
  const std::size_t cores = std::max(1U, std::thread::hardware_concurrency());
  const std::size_t at_once = std::min(mine.size(), options.at_once > 0 ? options.at_once : cores);
  SharedProgress progress("jobs", mine.size());
  std::mutex failing;
  std::exception_ptr failure;  // a folder that cannot be written, a full disk: no job's own
  inThreads(at_once, mine.size(), [&](std::size_t i) {
    try {
      runJob(*mine[i], options);
      progress.oneDone();
    } catch (const Interrupted&) {  // seen again below
    } catch (...) {
      const std::scoped_lock lock(failing);
      failure = std::current_exception();
    }
  });
  if (interrupted()) throw Interrupted{};
  try {
    if (failure) std::rethrow_exception(failure);
  } catch (const fs::filesystem_error& error) {
    throw Error(error.path1().string(), "", error.code().message());
  }
}

}  // namespace fathom
