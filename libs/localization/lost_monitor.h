#pragma once

#include <deque>
#include <optional>
#include <string>

#include "localization/options.h"

namespace fathom {

/// Says when an estimate is not to be relied on. It looks at final results in time order:
///   - positions are seen in a frame whose heading is not known yet (OdomFrame);
///   - where odom is hangs on a fix that the latest contradicts (LandmarkMonitor);
///   - the filter's own sigma of position or orientation is above its limit, or is no number;
///   - nothing has told velocity or position (DVL, USBL, landmark) for blind_s;
///   - a channel contradicts the filter: for contradiction_s most of its readings (kMost) had an innovation
///     that a consistent filter sees once in 10 000, whether the gate let them pass or not. Ranges to the sea
///     floor are left out: ground that is not flat contradicts them, and they tell the height only;
///   - landmarks had to correct the filter (or a panel was said to have moved) kCorrections times within
///     kCorrected_s: a sensor is wrong, not the start and not the panels.
class LostMonitor {
 public:
  static constexpr double kMost = 0.8;
  static constexpr std::size_t kCorrections = 3;
  static constexpr double kCorrected_s = 60.0;

  explicit LostMonitor(const LostOptions& options) : options_(options) {}

  void start(double t_s);
  void reading(double t_s, Channel channel, bool fused, bool contradicts);
  void corrected(double t_s);

  /// Why the estimate is lost at that time; nothing where it is not. Sigma: root of the covariance's trace.
  std::optional<std::string> judge(double t_s, double position_sigma_m, double angle_sigma_rad,
                                   bool is_turned = false, bool is_in_doubt = false);

 private:
  struct Contradiction {
    double share = 0.0;  ///< of recent readings, exponential average
    double last_s = 0.0;
    bool any = false, lost = false;
  };
  LostOptions options_;
  std::array<Contradiction, kChannelCount> channels_{};
  std::deque<double> corrections_s_;
  double last_seeing_s_ = 0.0;
  bool unsure_ = false;
};

}  // namespace fathom
