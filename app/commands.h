#pragma once

#include <CLI/CLI.hpp>
#include <string>

/// The command table. A command is one file, command_NAME.cpp, with one function that adds it to the command
/// line (options, help) and sets as its callback what it does; and one line in kCommands.
namespace fathom {

/// What a command may know of the run besides its options.
struct RunContext {
  CLI::App* root = nullptr;  ///< the whole command line, for `completion`
  std::string command_line;  ///< as typed, quoted where a shell needs it; for result.json
};

/// The context outlives the parse, in which the callback runs.
using AddCommand = void (*)(const RunContext& context);

void addImport(const RunContext& context);
void addExport(const RunContext& context);
void addInfo(const RunContext& context);
void addSimulate(const RunContext& context);
void addLocalize(const RunContext& context);
void addSmooth(const RunContext& context);
void addDiagnose(const RunContext& context);
void addStress(const RunContext& context);
void addTune(const RunContext& context);
void addBudget(const RunContext& context);
void addCalibrate(const RunContext& context);
void addDetect(const RunContext& context);
void addMap(const RunContext& context);
void addEvaluate(const RunContext& context);
void addCompareFiducials(const RunContext& context);
void addEffects(const RunContext& context);
void addFitWater(const RunContext& context);
void addFsim(const RunContext& context);
void addSil(const RunContext& context);
void addHandles(const RunContext& context);
void addBatch(const RunContext& context);
void addCompletion(const RunContext& context);
void addMan(const RunContext& context);

inline constexpr AddCommand kCommands[] = {
    addImport,           addExport,  addInfo,   addSimulate,  addLocalize, addSmooth,  addDiagnose,
    addStress,           addTune,    addBudget, addCalibrate, addDetect,   addMap,     addEvaluate,
    addCompareFiducials, addEffects, addFsim,   addSil,       addFitWater, addHandles, addBatch,
    addCompletion,       addMan};

/// Kinds of values. They show in --help, and tell the shell's completion what to offer: "FILE.x" files that
/// end in .x, "FILE" any file, "FOLDER" folders.
namespace values {
inline constexpr const char* kRawlog = "FILE.rawlog";
inline constexpr const char* kYaml = "FILE.yaml";
inline constexpr const char* kTum = "FILE.tum";
inline constexpr const char* kBag = "FILE.bag";
inline constexpr const char* kCsv = "FILE.csv";
inline constexpr const char* kFile = "FILE";
inline constexpr const char* kFolder = "FOLDER";
}  // namespace values

}  // namespace fathom
