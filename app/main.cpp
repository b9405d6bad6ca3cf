#include <malloc.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "commands.h"
#include "commit.h"
#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "core/shipped_file.h"
#include "core/text.h"
#include "core/version.h"
#include "given_values.h"

namespace fathom {
namespace {

constexpr int kDone = 0, kFault = 1, kBadInput = 2, kInterrupted = 130;

constexpr const char* kAbout =
    "fathom: where an underwater robot was, from what its sensors recorded.\n"
    "\n"
    "It reads recordings (MRPT rawlogs) of an inertial sensor, a Doppler velocity log and a pressure "
    "sensor,\n"
    "makes such recordings from other formats or by simulation, and estimates the robot's path from them.";

constexpr const char* kMoreHelp =
    "Examples:\n"
    "  fathom info rawlogs/dive/dive.rawlog\n"
    "  fathom localize rawlogs/dive/dive.rawlog --start reference --out out/dive\n"
    "  fathom COMMAND --help\n"
    "  eval \"$(fathom completion bash)\"\n"
    "\n"
    "Exit status: 0 done (whatever the verdict), 2 bad input, 1 a fault of the program, 130 interrupted.\n"
    "Documentation: README.md (installed: share/doc/fathom).";

/// As typed, so that it can be pasted into a shell again.
std::string commandLine(int argc, char** argv) {
  std::string text = "fathom";
  for (int i = 1; i < argc; ++i) text += " " + shellWord(argv[i]);
  return text;
}

using Claims = std::map<std::string, std::unique_ptr<FolderClaim>>;

/// Files that are named after what they come from lie side by side; `batch` divides its jobs by itself.
bool sharesItsFolder(const CLI::App& command) {
  const std::string& name = command.get_name();
  return command.get_option_no_throw("--name") != nullptr || name == "show" || name == "batch";
}

std::vector<CLI::App*> commandsOf(CLI::App& app) {
  return app.get_subcommands([](CLI::App*) { return true; });
}

/// Of every command whose results have names of their own, as soon as it is given.
void claimFolders(CLI::App& app, Claims& claims) {
  for (CLI::App* command : commandsOf(app)) {
    claimFolders(*command, claims);
    CLI::Option* out = command->get_option_no_throw("--out");
    if (out == nullptr || out->get_type_name() != values::kFolder || sharesItsFolder(*command)) continue;
    out->each([&claims](const std::string& folder) {
      if (!claims.contains(folder)) claims[folder] = std::make_unique<FolderClaim>(folder);
    });
  }
}

/// YAML files that are not where they are said to be may ship with the program.
void findShippedFiles(CLI::App& app) {
  for (CLI::App* command : commandsOf(app)) {
    findShippedFiles(*command);
    for (CLI::Option* option : command->get_options())
      if (option->get_type_name() == values::kYaml)
        option->transform([](const std::string& file) { return shippedFile(file).string(); }, "");
  }
}

/// CLI11 would only say that a command is needed. `words`: what follows the name of `app`.
void rejectUnknownCommand(CLI::App& app, std::span<char* const> words) {
  if (words.empty() || commandsOf(app).empty() || std::string_view(words[0]).starts_with("-")) return;
  std::vector<std::string> names;
  for (CLI::App* command : commandsOf(app)) {
    if (command->get_name() == words[0]) return rejectUnknownCommand(*command, words.subspan(1));
    names.push_back(command->get_name());
  }
  throw Error("command line", words[0], "no such command; there are " + CLI::detail::join(names, ", "));
}

/// "fathom import csv": the command that the words begin with.
std::string commandOf(CLI::App& app, std::span<char* const> words) {
  for (CLI::App* command : commandsOf(app))
    if (!words.empty() && command->get_name() == words[0])
      return app.get_name() + " " + commandOf(*command, words.subspan(1));
  return app.get_name();
}

/// The first option that no command has; it says more than that another one is missing.
std::optional<std::string> unknownOption(const CLI::App& app) {
  for (const CLI::App* command : app.get_subcommands())
    for (const std::string& word : command->remaining(true))
      if (word.starts_with("-")) return word;
  return std::nullopt;
}

int run(int argc, char** argv) {
  CLI::App app(kAbout);
  app.name("fathom");
  app.set_version_flag("--version", "fathom " + std::string(programVersion()) + " (commit " + commit() + ")",
                       "Print the version and exit");
  app.set_help_flag("-h,--help", "Print this help and exit");
  app.get_formatter()->column_width(34);
  app.footer(kMoreHelp);
  app.require_subcommand(1);
  const RunContext context{&app, commandLine(argc, argv)};
  for (const auto add : kCommands) add(context);
  Claims claims;
  claimFolders(app, claims);
  findShippedFiles(app);
  refuseNonFinite(app);
  app.parse_complete_callback([&app] { refuseOutputOverInput(app); });
  const std::span<char* const> words(argv + 1, static_cast<std::size_t>(std::max(argc - 1, 0)));
  rejectUnknownCommand(app, words);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& asked_for_help_or_version) {
    app.exit(asked_for_help_or_version);
  } catch (const CLI::ParseError& mistake) {
    const auto unknown = unknownOption(app);
    const std::string what = unknown ? *unknown + ": no such option" : oneLine(mistake.what());
    throw Error("command line", "", what + "; see " + commandOf(app, words) + " --help");
  }
  std::cout.flush();
  if (!std::cout) throw Error("standard output", "", "cannot be written");
  return kDone;
}

int complain(const std::string& what, int status) {
  std::cerr << "fathom: " << oneLine(what) << '\n';
  return status;
}

/// Images and matrices of a few MB come and go by thousands. Given back each time, the system clears their
/// pages anew, which is a fifth of what a diagnosis of images takes. What is larger would leave holes: a
/// fifth of the memory, and 4 % of the time, of three minutes of images.
void keepFreedMemory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 8 << 20);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  mallopt(M_ARENA_MAX, 2);
#endif
}

}  // namespace
}  // namespace fathom

int main(int argc, char** argv) {
  using namespace fathom;
  try {
    keepFreedMemory();
    catchInterrupts();
    return run(argc, argv);
  } catch (const Error& error) {
    return complain(error.what(), kBadInput);
  } catch (const Interrupted&) {
    return complain("interrupted; no half-written file is left", kInterrupted);
  } catch (const std::exception& error) {
    return complain("a fault of the program: " + std::string(error.what()), kFault);
  }
}
