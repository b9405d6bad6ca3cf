#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "recording/samples.h"

/// A recording's streams, thinned to what an audit compares: a few megabytes an hour.
namespace fathom {

/// The readings of an INS within kInsWindow_s, in its own axes.
struct InsWindow {
  double t_s = 0;                                              ///< middle of its readings' stamps
  Vector3d rate = Vector3d::Zero(), force = Vector3d::Zero();  ///< means, rad/s and m/s²
  std::size_t rates = 0, forces = 0;                           ///< how many
  std::optional<Matrix3d> attitude;                            ///< of the reading nearest the middle
  double attitude_t_s = 0;                                     ///< whose stamp this is
};
inline constexpr double kInsWindow_s = 0.1;

struct InsStream {
  Pose T_robot_ins;
  std::vector<InsWindow> windows;  ///< in time order; none where there were no readings
};

template <class Value>
struct Timed {
  double t_s = 0;
  Value value{};
};

struct DvlStream {
  Pose T_robot_dvl;
  std::vector<Timed<Vector3d>> velocities;  ///< m/s, its own axes; with bottom lock only
};

struct DepthStream {
  Pose T_robot_depth;
  std::vector<Timed<double>> pressures;  ///< Pa as recorded; at most kMostPressuresHz
};
inline constexpr double kMostPressuresHz = 10;

/// When the entries of one label came, by their stamps.
struct StampStream {
  std::vector<double> t_s;        ///< in the order of the recording; seconds since the first
  std::size_t without_stamp = 0;  ///< entries
  /// By how much each entry is older than the latest one of any other label; s, 0: it is newer than all.
  std::vector<double> behind_s;
};

/// How often what is measured is exactly as it was, to the last bit: noise does not allow that for long.
/// Zero is not counted: absence is written so, and what stands still has it by wheels.
struct Repeats {
  struct Run {
    double from_s = 0, to_s = 0;
    std::size_t repeated = 0;  ///< readings, without the first
  };
  std::size_t readings = 0, repeated = 0;
  Run longest;

  void add(double t_s, std::span<const double> reading);

 private:
  std::vector<double> last_;
  Run run_;
};

struct ImageStream {
  RecordedCamera intrinsics;       ///< of the first
  std::vector<std::string> files;  ///< of left images, of a pair
};

class Streams {
 public:
  void add(const Sample& sample);

  std::map<Instance, InsStream> ins;
  std::map<Instance, DvlStream> dvl;
  std::map<Instance, DepthStream> depth;
  std::map<std::string, StampStream> stamps;                       ///< by label
  std::map<std::pair<std::string, std::string>, Repeats> repeats;  ///< by label and what of it
  std::map<std::string, ImageStream> images;                       ///< by label
  std::optional<Time> time_zero;                                   ///< of the first entry that has a stamp

 private:
  double latestOfOthers(const StampStream& stream) const;
  void add(double t_s, const Instance& instance, const InsSample& sample);
  void add(double t_s, const Instance& instance, const DvlSample& sample);
  void add(double t_s, const Instance& instance, const DepthSample& sample);
  void addRepeats(double t_s, const Sample& sample);
};

}  // namespace fathom
