#pragma once

#include <string>
#include <variant>
#include <vector>

#include "recording/samples.h"
#include "sensors/channels.h"
#include "sensors/vehicle.h"

/// Entries of instruments without asking which: sensors/all_instruments.h knows them.
namespace fathom {

/// Calls `f.template operator()<Instrument>(entry)` where the sample is an instrument's. `AnySample`: Sample
/// or const Sample.
template <class AnySample, class F>
void withInstrument(AnySample& sample, F&& f) {
  forEachInstrument([&]<class Instrument>() {
    if (auto* entry = std::get_if<typename Instrument::Sample>(&sample.reading);
        entry != nullptr && sample.label == Instrument::label)
      f.template operator()<Instrument>(*entry);
  });
}

/// In their order: "INS", "DVL", …
inline std::vector<std::string> instrumentLabels() {
  std::vector<std::string> labels;
  forEachInstrument([&]<class Instrument>() { labels.emplace_back(Instrument::label); });
  return labels;
}

inline bool isOfInstrument(const Sample& sample) {
  bool is_one = false;
  withInstrument(sample, [&]<class Instrument>(const auto&) { is_one = true; });
  return is_one;
}

namespace detail {
template <class C>
constexpr bool needsSheet() {  // true unless it says otherwise
  if constexpr (requires { C::Instrument::needs_sheet; })
    return C::Instrument::needs_sheet;
  else
    return true;
}
}  // namespace detail

/// Calls `f.template operator()<Channel>(observation)` for all that an entry tells, of instruments that the
/// vehicle file has.
template <class F>
void forEachObservation(const Sample& sample, const Vehicle& vehicle, F&& f) {
  withInstrument(sample, [&]<class Instrument>(const auto& entry) {
    if (detail::needsSheet<Instrument>() && !(vehicle.*Instrument::on_board)) return;
    [&]<class... Channels>(std::tuple<Channels...>*) {
      (Channels::observe(entry, sheetOf<Channels>(vehicle),
                         [&](const Observation& seen) { f.template operator()<Channels>(seen); }),
       ...);
    }(static_cast<typename Instrument::Channels*>(nullptr));
  });
}

}  // namespace fathom
