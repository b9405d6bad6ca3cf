#include "core/child_process.h"

#include <fcntl.h>
#include <sched.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <thread>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"

extern char** environ;

namespace fathom {
namespace {

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

pid_t start(const std::vector<std::string>& words, const std::filesystem::path& log) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, 1, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&files, 1, 2);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, arguments[0], &files, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw Error(words[0], "", std::strerror(failed));
  return child;
}

}  // namespace

ChildResult runChild(const std::vector<std::string>& words, const std::filesystem::path& log) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  const pid_t child = start(words, log);
  int status = 0;
  rusage used{};
  // Looked at again and again, since a signal to stop need not reach the child by itself. Short runs are not
  // to wait long.
  auto pause = std::chrono::microseconds(500);
  bool asked = false;
  while (wait4(child, &status, WNOHANG, &used) == 0) {
    if (interrupted() && !asked) asked = kill(child, SIGTERM) == 0;
    std::this_thread::sleep_for(pause);
    pause = std::min(pause * 2, std::chrono::microseconds(50000));
  }
  // Asked by us, or by the same key that stopped it too: what it had not finished is no result.
  if (interrupted() && status != 0) throw Interrupted{};
  ChildResult result;
  result.wall_s = std::chrono::duration<double>(Clock::now() - begin).count();
  result.cpu_s = seconds(used.ru_utime) + seconds(used.ru_stime);
  result.peak_mb = static_cast<double>(used.ru_maxrss) / 1000;
  if (WIFEXITED(status))
    result.status = WEXITSTATUS(status);
  else
    result.signal = WTERMSIG(status);
  return result;
}

void stayOnOneCore(std::size_t number) {
  cpu_set_t all, one;
  if (sched_getaffinity(0, sizeof all, &all) != 0) return;
  CPU_ZERO(&one);
  std::size_t seen = 0;
  const auto count = static_cast<std::size_t>(CPU_COUNT(&all));
  for (std::size_t cpu = 0; cpu < CPU_SETSIZE; ++cpu)
    if (CPU_ISSET(cpu, &all) && seen++ == number % count) CPU_SET(cpu, &one);
  sched_setaffinity(0, sizeof one, &one);
}

std::string lastLineOf(const std::filesystem::path& file) {
  std::string text = readTextFile(file);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

}  // namespace fathom
