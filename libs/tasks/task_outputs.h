#pragma once

#include <zlib.h>

#include <fstream>
#include <map>
#include <memory>

#include "core/files.h"
#include "localization/evaluation.h"
#include "tasks/results_log.h"

namespace fathom {

/// Every innovation of a run as gzipped CSV (t_s,channel,degrees_of_freedom,nis,fused): NIS, gates and
/// rejections, kept whatever the recording's length. Throws Error where it cannot be written.
class InnovationLog {
 public:
  explicit InnovationLog(const std::filesystem::path& file);
  ~InnovationLog();
  InnovationLog(const InnovationLog&) = delete;
  InnovationLog& operator=(const InnovationLog&) = delete;
  void write(const Innovation& innovation);
  void finish();

 private:
  PendingFile file_;
  gzFile gz_;
};

/// Mean NIS over windows of time, in bounded memory: windows double in length when there are too many.
class NisWindows {
 public:
  struct Window {
    double begin_s = 0.0, sum = 0.0;
    std::size_t count = 0;
  };
  void add(const Innovation& innovation);
  double length_s() const { return length_s_; }
  const std::vector<Window>& windows() const { return windows_; }

 private:
  double length_s_ = 1.0;
  std::vector<Window> windows_;
};

/// Writes what a task gives while it runs (trajectory, innovations, its poses in the results rawlog), and
/// keeps what the report needs.
class TaskOutputs {
 public:
  /// Files go to `folder`, poses to a stream of `results` under the label EKF_TASK.
  TaskOutputs(const std::filesystem::path& folder, const std::string& task, bool smoothed,
              ResultsLog& results, std::size_t stream);

  void estimate(const Estimate& estimate);
  void smoothed(const Estimate& estimate);
  void innovation(const Innovation& innovation);
  void event(const Event& event);
  /// Puts its files under their names. Throws Error.
  void finish();

  const std::vector<StampedPose>& poses() const { return poses_; }
  const std::vector<bool>& lost() const { return lost_; }  ///< of each pose
  /// Of each pose: m/s, robot axes.
  const std::vector<Vector3d>& velocities() const { return velocities_; }
  const std::vector<StampedPose>& smoothedPoses() const { return smoothed_poses_; }
  const std::vector<Event>& events() const { return events_; }
  const std::map<Channel, NisWindows>& nis() const { return nis_; }
  std::optional<Estimate> last() const { return last_; }
  /// One pose with its covariance every kMarkEvery_s where the estimate is not lost, to draw.
  struct Mark {
    double t_s = 0.0;
    UncertainPose T_odom_robot;
  };
  const std::vector<Mark>& marks() const { return marks_; }
  static constexpr double kMarkEvery_s = 1.0;

  static constexpr std::size_t kEventsKept = 1000;

 private:
  struct TumFile {
    explicit TumFile(const std::filesystem::path& target) : file(target), out(file.path()) {}
    void finish();
    PendingFile file;
    std::ofstream out;
  };

  std::string label_;
  ResultsLog& results_;
  std::size_t stream_;
  TumFile trajectory_;
  std::unique_ptr<TumFile> smoothed_;
  InnovationLog innovations_;
  std::vector<StampedPose> poses_, smoothed_poses_;
  std::vector<bool> lost_;
  std::vector<Vector3d> velocities_;
  std::vector<Mark> marks_;
  std::vector<Event> events_;  ///< the first kEventsKept, and all that tell what may be relied on
  std::size_t other_events_ = 0;
  std::map<Channel, NisWindows> nis_;
  std::optional<Estimate> last_;
};

}  // namespace fathom
