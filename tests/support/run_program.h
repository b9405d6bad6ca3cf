#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "core/files.h"
#include "support/sanitized.h"
#include "support/shared_data.h"

namespace fathom::test {

struct ProgramResult {
  int status = -1;  ///< exit status; -1 where it was killed
  std::string out, err;
};

/// A word for the shell, whatever is in it.
inline std::string shellQuoted(const std::string& word) {
  std::string result = "'";
  for (const char c : word) result += c == '\'' ? "'\\''" : std::string(1, c);
  return result + "'";
}

/// Runs a bash command with no standard input.
inline ProgramResult runShell(const std::string& command) {
  const auto folder = std::filesystem::temp_directory_path() / "fathom-tests";
  std::filesystem::create_directories(folder);
  std::string base = (folder / "run-XXXXXX").string();
  if (mkdtemp(base.data()) == nullptr) return {};
  const std::string redirected =
      "( " + command + "\n) </dev/null >" + shellQuoted(base + "/out") + " 2>" + shellQuoted(base + "/err");
  const int status = std::system(("bash -c " + shellQuoted(redirected)).c_str());
  ProgramResult result{WIFEXITED(status) ? WEXITSTATUS(status) : -1, readTextFile(base + "/out"),
                       readTextFile(base + "/err")};
  std::filesystem::remove_all(base);
  return result;
}

/// The program as built.
inline std::string fathomProgram() { return std::string(FATHOM_BINARY_DIR) + "/app/fathom"; }

/// `arguments` as one would type them.
inline ProgramResult runFathom(const std::string& arguments) {
  return runShell(shellQuoted(fathomProgram()) + " " + arguments);
}

/// The same in 1.5 GB of addresses and 20 s of time at most; a longer run has status 124. Sanitizers, which
/// take terabytes of addresses and several times as long, get neither limit.
inline ProgramResult runFathomWithinLimits(const std::string& arguments) {
  if (kSanitized) return runFathom(arguments);
  // Address space that each of many threads' heaps would only reserve is no use of memory.
  return runShell("ulimit -v 1500000; MALLOC_ARENA_MAX=2 timeout --kill-after=1 20 " +
                  shellQuoted(fathomProgram()) + " " + arguments);
}

/// One line that begins as all of the program's complaints do and contains `part`; status 2; nothing on
/// stdout.
inline void expectBadInput(const ProgramResult& result, const std::string& part) {
  EXPECT_EQ(result.status, 2) << result.err;
  EXPECT_EQ(result.out, "");
  EXPECT_TRUE(result.err.starts_with("fathom: ")) << result.err;
  EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
  EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
}

}  // namespace fathom::test
