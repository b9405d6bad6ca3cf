#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "recording/samples.h"
#include "sensors/channels.h"
#include "sensors/vehicle.h"

/// Entries of instruments without asking which: sensors/all_instruments.h knows them.
namespace fathom {

/// Calls `f.template operator()<Instrument>(entry, instance)` where the sample is an instrument's.
/// `AnySample`: Sample or const Sample.
template <class AnySample, class F>
void withInstrument(AnySample& sample, F&& f) {
  forEachInstrument([&]<class Instrument>() {
    auto* entry = std::get_if<typename Instrument::Sample>(&sample.reading);
    if (entry == nullptr) return;
    if (const auto instance = Instance::of(sample.label, Instrument::label))
      f.template operator()<Instrument>(*entry, *instance);
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
  withInstrument(sample, [&]<class Instrument>(const auto&, const Instance&) { is_one = true; });
  return is_one;
}

namespace detail {
template <class Instrument>
bool isOnBoard(const Vehicle& vehicle, const Instance& instance) {
  if constexpr (requires { Instrument::Instrument::needs_sheet; })
    if (!Instrument::Instrument::needs_sheet && instance.isFirst()) return true;
  return (vehicle.sensors(instance).*Instrument::on_board).has_value();
}
}  // namespace detail

/// Calls `f.template operator()<Channel>(observation)` for all that an entry tells, of instruments that the
/// vehicle file has.
template <class F>
void forEachObservation(const Sample& sample, const Vehicle& vehicle, F&& f) {
  withInstrument(sample, [&]<class Instrument>(const auto& entry, const Instance& instance) {
    if (!detail::isOnBoard<Instrument>(vehicle, instance)) return;
    [&]<class... Channels>(std::tuple<Channels...>*) {
      (Channels::observe(entry, sheetOf<Channels>(vehicle, instance),
                         [&](Observation seen) {
                           seen.instance = instance;
                           f.template operator()<Channels>(std::as_const(seen));
                         }),
       ...);
    }(static_cast<typename Instrument::Channels*>(nullptr));
  });
}

}  // namespace fathom
