#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace fathom::proof {

/// The programs that take part: the generator, and the one that is proved.
struct Programs {
  std::filesystem::path seal, fathom;
};

/// Runs a program with arguments, its output into a file. Throws Error where it does not end with status
/// 0, Interrupted where that is because the user stopped both.
void runProgram(const std::vector<std::string>& words, const std::filesystem::path& log);

/// The generator: a recording in `recording`, its truth in `truth`.
void sealRecording(const Programs& programs, const nlohmann::json& generator_case,
                   const std::filesystem::path& recording, const std::filesystem::path& truth);

/// `fathom diagnose` of a sealed recording, and of others that its answer is judged on, in a sandbox
/// (bubblewrap) that has the system's libraries, the program, the recordings and the folder for its answer,
/// and nothing else: no plan, no network, and no `truth`, of which that is checked.
void diagnoseBlind(const Programs& programs, const std::filesystem::path& recording,
                   const std::vector<std::filesystem::path>& judges, const std::filesystem::path& answer,
                   const std::filesystem::path& truth);

}  // namespace fathom::proof
