#pragma once

#include <variant>

#include "sources/bias_fault.h"
#include "sources/burst_fault.h"
#include "sources/clock_fault.h"
#include "sources/corrupt_fault.h"
#include "sources/delay_fault.h"
#include "sources/drop_fault.h"
#include "sources/duplicate_fault.h"
#include "sources/jitter_fault.h"
#include "sources/noise_fault.h"
#include "sources/outage_fault.h"
#include "sources/reorder_fault.h"
#include "sources/swing_fault.h"

namespace fathom {

/// The only registration. To add a kind of fault: write libs/sources/NAME_fault.h (see fault.h), include it
/// here and add it to this list. YAML, sweeps and the property tests over all kinds then know it.
using AnyFault = std::variant<DropFault, DelayFault, JitterFault, NoiseFault, BiasFault, OutageFault,
                              DuplicateFault, ReorderFault, CorruptFault, ClockFault, SwingFault, BurstFault>;

/// Calls `f.template operator()<Fault>()` for every kind, in order.
template <class F>
void forEachFault(F&& f) {
  [&]<class... Faults>(std::variant<Faults...>*) {
    (f.template operator()<Faults>(), ...);
  }(static_cast<AnyFault*>(nullptr));
}

}  // namespace fathom
