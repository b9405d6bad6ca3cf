#pragma once

#include <functional>
#include <map>
#include <string>

#include "localization/options.h"
#include "recording/samples.h"

namespace fathom {

/// Names what is wrong with the stream of samples: events not-a-number, impossible, duplicate, silent, gap,
/// time-jump.
class InputWatch {
 public:
  using Report = std::function<void(double t_s, const char* kind, std::string text)>;
  InputWatch(const LocalizationOptions& options, Report report)
      : options_(options), report_(std::move(report)) {}

  /// True where the sample may be used. `t_s` is its stamp.
  bool accept(const Sample& sample, double t_s);

 private:
  struct Sensor {
    double last_s = 0.0;
    double sum_s = 0.0, count = 0.0;  ///< of its intervals so far
  };
  bool isLongFor(const Sensor& sensor, double interval_s) const;

  const LocalizationOptions& options_;
  Report report_;
  std::map<std::string, Sensor, std::less<>> sensors_;
  double newest_s_ = 0.0;
  bool any_ = false;
};

}  // namespace fathom
