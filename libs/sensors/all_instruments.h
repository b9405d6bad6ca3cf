#pragma once

#include <tuple>
#include <type_traits>

#include "sensors/altimeter.h"
#include "sensors/compass.h"
#include "sensors/depth.h"
#include "sensors/dvl.h"
#include "sensors/gnss.h"
#include "sensors/ins.h"
#include "sensors/usbl.h"

namespace fathom {

/// The only registration. Simulator, filter, batch estimate, diagnosis, vehicle file, recordings, faults and
/// tables go through it; entries of one time stamp and channels in results are in this order.
using AllInstruments = std::tuple<Ins, Dvl, DvlBeams, Depth, Usbl, Compass, Gnss, Altimeter>;

/// Calls `f.template operator()<Instrument>()` for each, in order.
template <class F>
void forEachInstrument(F&& f) {
  [&]<class... Instruments>(std::tuple<Instruments...>*) {
    (f.template operator()<Instruments>(), ...);
  }(static_cast<AllInstruments*>(nullptr));
}

namespace detail {
template <class Sample, std::size_t I = 0>
constexpr auto instrumentOf() {
  if constexpr (I == std::tuple_size_v<AllInstruments>)
    return std::type_identity<void>{};
  else if constexpr (std::is_same_v<Sample, typename std::tuple_element_t<I, AllInstruments>::Sample>)
    return std::type_identity<std::tuple_element_t<I, AllInstruments>>{};
  else
    return instrumentOf<Sample, I + 1>();
}
}  // namespace detail

/// The instrument that writes entries of a type; void: none does.
template <class Sample>
using InstrumentOf = typename decltype(detail::instrumentOf<std::remove_cvref_t<Sample>>())::type;
template <class Sample>
inline constexpr bool kIsInstruments = !std::is_void_v<InstrumentOf<Sample>>;

}  // namespace fathom
