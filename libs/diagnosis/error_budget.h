#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sensors/vehicle.h"

/// What a recording may differ from its model by for no reason that has a name: the declared error budget
/// (config/error_budget.yaml), a file of the user's.
namespace fathom {

inline constexpr double kSigmasOf99 = 2.576;  ///< so many hold 99 % of a normal variable

/// A field that is smooth in a reading's covariates: a Gaussian process with a squared-exponential kernel.
struct SmoothField {
  std::vector<std::string> over;  ///< names of covariate.h: "image x", "brightness", …
  /// Of correlation, one for each, in the unit that is printed; in the image in focal lengths.
  std::vector<double> length;

  bool operator==(const SmoothField&) const = default;
};

/// One way in which readings are off, whose sigma is known to a factor.
struct VarianceComponent {
  /// What has a value of its own. A place has one for each colour, a spot is a place in all colours alike.
  enum class Each { recording, sensor, instrument, marker, place, spot, image, image_colour, reading };

  std::string name;  ///< "print-placement"
  /// What acts: "EFFECT.PARAMETER", of lists "EFFECT.PARAMETER.y", that parameter being the value; or
  /// "CHANNEL" or "CHANNEL.y", the reading itself in its own unit; or "CHANNEL.share", a share of it.
  std::vector<std::string> by;
  Each each = Each::recording;
  std::optional<SmoothField> smooth;
  double sigma = 0;   ///< in `unit`
  double factor = 2;  ///< 99 % of such are between sigma / factor and sigma * factor
  /// Of a camera that processes its images, where that is another one.
  struct Processed {
    double sigma = 0, factor = 2;
    bool operator==(const Processed&) const = default;
  };
  std::optional<Processed> processed;
  bool of_processed_only = false;  ///< no other camera has it
  /// Nobody states how large it is: it is as a recording shows it, and nothing is looked for against the
  /// declared sigma.
  bool is_as_shown = false;
  std::string unit, source;

  /// Standard deviation of ln sigma.
  double logSd() const;
  bool operator==(const VarianceComponent&) const = default;
};

struct ErrorBudget {
  std::string name;  ///< "field"
  std::vector<VarianceComponent> components;
  double outlier_share = 0;  ///< of any channel's readings
  double noise_factor = 3;   ///< within which a channel's noise is what is stated

  /// What it allows images of such a camera to be off by.
  ErrorBudget of(CameraPipeline pipeline) const;
  bool operator==(const ErrorBudget&) const = default;
};

}  // namespace fathom
