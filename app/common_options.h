#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "inputs/batch_recording.h"
#include "tasks/sample_chain.h"

/// Options that several commands have.
namespace fathom {

/// Of numbers. As CLI11's, whose complaints have the largest number that there is with its 309 digits.
CLI::Validator positive();
CLI::Validator notNegative();

/// --name, of files that come to lie in --out. `default_name`: what it is where none is given, for --help.
void addNameOption(CLI::App& command, std::string& name, const std::string& default_name);

/// --accept and --correct.
void addAuditOptions(CLI::App& command, AuditChoice& choice);

/// All of a chain's options but the rawlog, as options of a command.
void addChainOptions(CLI::App& command, ChainOptions& options);

/// What goes into the batch estimate besides the recording.
void addBatchInputOptions(CLI::App& command, BatchRecordingOptions& options);
/// RECORDING, --out and these.
void addBatchRecordingOptions(CLI::App& command, BatchRecordingOptions& options);

/// Adds `--calibration FILE`.
CLI::Option* addCalibrationOption(CLI::App& command, std::string& file, const std::string& help);
/// Adds `--at SECONDS`, of images that have no time of their own.
CLI::Option* addTimeOption(CLI::App& command, double& t_s, CLI::Option* calibration);

/// What --help says of effects in images of views.
inline constexpr const char* kEffectsInViews =
    "With --calibration (a file as `fathom diagnose` writes it), the images have those effects; readers and\n"
    "estimators know nothing of them. Views have no time of their own: what is active for a part of a "
    "recording\n"
    "(active_s), or peaks, is there as it is at --at. What is drawn for each image is drawn for each view. "
    "The\n"
    "camera truly is where the view has it, and stands still: effects on navigation sensors, latencies, the\n"
    "camera's mounting and the panel's pose change nothing.\n";

}  // namespace fathom
