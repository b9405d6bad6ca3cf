#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "localization/result.h"
#include "localization/setup.h"
#include "recording/samples.h"

namespace fathom {

/// The filter, fed with samples in the order in which they arrive. Late ones (by stamp or by a calibrated
/// latency) are fused at their own time. TRUTH and images are not looked at. Landmarks come as PoseSample
/// with the label MARKERS or as PanelSample with the label PANEL; LandmarkOptions::form says which are fused.
/// Several localizers may run in as many threads.
class Localizer {
 public:
  Localizer(LocalizationSetup setup, LocalizationSink sink);
  ~Localizer();
  Localizer(Localizer&&) noexcept;
  Localizer& operator=(Localizer&&) noexcept;

  /// May hand results to the sink.
  void add(const Sample& sample);
  /// Hands out what is left. Nothing may be added after it.
  LocalizationSummary finish();

 private:
  class Run;
  template <int N>
  class RunOf;
  std::unique_ptr<Run> run_;
};

/// Feeds a localizer with all that `next` gives.
LocalizationSummary localize(const LocalizationSetup& setup,
                             const std::function<std::optional<Sample>()>& next,
                             const LocalizationSink& sink);

}  // namespace fathom
