#include "programs.h"

#include <fcntl.h>
#include <sched.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"

extern char** environ;

namespace fathom::proof {
namespace fs = std::filesystem;
namespace {

std::string lastLineOf(const fs::path& file) {
  std::string text = readTextFile(file);
  while (!text.empty() && text.back() == '\n') text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

/// Of what the program needs to start: the same places on any Debian.
std::vector<std::string> systemFolders() {
  std::vector<std::string> words;
  for (const char* folder : {"/usr", "/lib", "/lib64", "/bin", "/etc"})
    if (fs::exists(folder)) words.insert(words.end(), {"--ro-bind", folder, folder});
  return words;
}

}  // namespace

void runProgram(const std::vector<std::string>& words, const fs::path& log) {
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
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0 && interrupted()) throw Interrupted{};  // as it was too: that is no answer
  if (!WIFEXITED(status))
    throw Error(words[0], "", "was stopped by signal " + std::to_string(WTERMSIG(status)));
  if (WEXITSTATUS(status) != 0)
    throw Error(words[0], "",
                "ended with status " + std::to_string(WEXITSTATUS(status)) + ": " + lastLineOf(log));
}

void sealRecording(const Programs& programs, const nlohmann::json& generator_case, const fs::path& recording,
                   const fs::path& truth) {
  fs::create_directories(truth.parent_path());
  for (const fs::path& unfinished : {recording, truth}) fs::remove_all(unfinished);
  const std::string file = truth.string() + "-case.json";
  writeTextFile(file, generator_case.dump(1) + "\n");
  runProgram({programs.seal, file, "--out", recording, "--truth", truth}, truth.string() + "-seal.log");
}

void diagnoseBlind(const Programs& programs, const fs::path& recording, const std::vector<fs::path>& judges,
                   const fs::path& answer, const fs::path& truth) {
  fs::create_directories(answer);
  std::vector<std::string> sandbox{"bwrap", "--unshare-all", "--die-with-parent", "--proc", "/proc",
                                   "--dev", "/dev",          "--tmpfs",           "/tmp"};
  const std::vector<std::string> system = systemFolders();
  sandbox.insert(sandbox.end(), system.begin(), system.end());
  sandbox.insert(sandbox.end(), {"--ro-bind", programs.fathom, "/program/fathom", "--bind", recording,
                                 "/recording", "--bind", answer, "/answer"});
  std::vector<std::string> command{"/program/fathom", "diagnose", "/recording/recording.rawlog", "--out",
                                   "/answer"};
  for (std::size_t i = 0; i < judges.size(); ++i) {
    const std::string place = "/judge" + std::to_string(i);
    sandbox.insert(sandbox.end(), {"--bind", judges[i], place});
    command.insert(command.end(), {"--judge", place + "/recording.rawlog"});
  }
  const auto inSandbox = [&](const std::vector<std::string>& words) {
    std::vector<std::string> all = sandbox;
    all.insert(all.end(), words.begin(), words.end());
    runProgram(all, answer / "diagnose.log");
  };
  inSandbox({"/usr/bin/test", "!", "-e", truth});  // or else nothing that follows is a proof
  inSandbox(command);
}

}  // namespace fathom::proof
