#pragma once

#include <filesystem>

#include "audit/correction.h"
#include "recording/imported.h"
#include "sea_trial/sea_trial.h"

/// A sea trial as its authors publish it (A-KIT, Cohen & Klein 2025): three tables a section, gzip or plain.
namespace fathom {

struct SeaTrialFiles {
  std::filesystem::path imu, dvl, gt;
};
/// IMU_trajectoryN.csv[.gz], DVL_… and GT_… in a folder. Throws Error where one is missing.
SeaTrialFiles seaTrialFiles(const std::filesystem::path& folder, int section);

struct SeaTrialOptions {
  /// The tables count seconds from an unpublished moment of June 2022: this stands for it, 2022-06-01 00:00
  /// UTC.
  Time start = fromUnixSeconds(1654041600.0);
  /// Also undo the stretch of the DVL's stamps, where it is established. Off: they are kept as published.
  bool undo_stamp_stretch = false;
  /// The reference as published: by its own clock, and where the navigation solution's point is. Off: on the
  /// IMU's clock and where the IMU is, both as established, so that what is compared with it is where and
  /// when it is.
  bool reference_as_published = false;
  /// Of the tables' entries, made before anything is concluded.
  std::vector<Correction> corrections;
};

/// The tables as they stand. Throws Error (see readCsv), also for fewer than 10 rows.
SeaTrialData readSeaTrial(const SeaTrialFiles& files);

/// Samples INS and DVL, nominal mounting (no lever arm, no rotation); axes as established, see
/// establishConventions. odom: x east, y north, z up from the first position of the reference, which is the
/// navigation solution. Throws Error.
ImportedRecording importSeaTrial(const SeaTrialFiles& files, const SeaTrialOptions& options = {});

}  // namespace fathom
