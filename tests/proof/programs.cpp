#include "programs.h"

#include <nlohmann/json.hpp>

#include "core/child_process.h"
#include "core/error.h"
#include "core/files.h"
#include "core/shipped_file.h"

namespace fathom::proof {
namespace fs = std::filesystem;
namespace {

/// Of what the program needs to start: the same places on any Debian.
std::vector<std::string> systemFolders() {
  std::vector<std::string> words;
  for (const char* folder : {"/usr", "/lib", "/lib64", "/bin", "/etc"})
    if (fs::exists(folder)) words.insert(words.end(), {"--ro-bind", folder, folder});
  return words;
}

}  // namespace

void runProgram(const std::vector<std::string>& words, const fs::path& log) {
  const ChildResult child = runChild(words, log);
  if (child.signal != 0) throw Error(words[0], "", "was stopped by signal " + std::to_string(child.signal));
  if (child.status != 0)
    throw Error(words[0], "", "ended with status " + std::to_string(child.status) + ": " + lastLineOf(log));
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
  // What the program reads wherever it is installed: a program in /program looks in /share.
  const fs::path configuration = shippedFile("config/error_budget.yaml").parent_path();
  sandbox.insert(sandbox.end(), {"--ro-bind", configuration, "/share/fathom/config"});
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
