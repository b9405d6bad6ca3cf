#pragma once

#include <array>
#include <bitset>
#include <cstddef>
#include <tuple>
#include <type_traits>
#include <utility>

#include "effects/accelerometer_bias.h"
#include "effects/dvl_latency.h"
#include "effects/dvl_lever_arm.h"
#include "effects/dvl_misalignment.h"
#include "effects/dvl_scale.h"
#include "effects/gyro_bias.h"
#include "effects/pressure_offset.h"

/// To add an effect: write libs/effects/NAME.h like its neighbours, include it here and add it to AllEffects.
/// Simulator, filter, calibration file and the property test over the registry then know it.
namespace fathom {

/// The only registration. Effects at the same stage are applied in this order: a misalignment turns the
/// mounting before a lever arm moves it, a scale acts on what the sensor would have read.
using AllEffects = std::tuple<DvlMisalignment, DvlLeverArm, DvlLatency, DvlScale, GyroBias, AccelerometerBias,
                              PressureOffset>;

inline constexpr std::size_t kEffectCount = std::tuple_size_v<AllEffects>;

/// Number of scalars in an effect's parameters.
template <class Effect>
constexpr std::size_t parameterSize() {
  std::size_t size = 0;
  for (const Parameter& p : Effect::parameters) size += static_cast<std::size_t>(p.size);
  return size;
}

namespace detail {
template <class Effect, std::size_t I = 0>
constexpr std::size_t effectIndex() {
  static_assert(I < kEffectCount, "effect is not in AllEffects");
  if constexpr (std::is_same_v<Effect, std::tuple_element_t<I, AllEffects>>)
    return I;
  else
    return effectIndex<Effect, I + 1>();
}
template <std::size_t... I>
constexpr auto effectOffsets(std::index_sequence<I...>) {
  std::array<std::size_t, kEffectCount + 1> offsets{};
  const std::array<std::size_t, kEffectCount> sizes{parameterSize<std::tuple_element_t<I, AllEffects>>()...};
  for (std::size_t k = 0; k < kEffectCount; ++k) offsets[k + 1] = offsets[k] + sizes[k];
  return offsets;
}
}  // namespace detail

template <class Effect>
inline constexpr std::size_t kEffectIndex = detail::effectIndex<Effect>();
/// Where each effect's scalars start in EffectParameters::values; the last entry is the total.
inline constexpr auto kEffectOffsets = detail::effectOffsets(std::make_index_sequence<kEffectCount>{});

/// Which effects are on, and with which parameters. All off: the nominal model.
template <class T>
struct EffectParameters {
  std::array<T, kEffectOffsets[kEffectCount]> values{};
  std::bitset<kEffectCount> on;

  template <class Effect>
  T* of() {
    return values.data() + kEffectOffsets[kEffectIndex<Effect>];
  }
  template <class Effect>
  const T* of() const {
    return values.data() + kEffectOffsets[kEffectIndex<Effect>];
  }
  template <class Effect>
  bool has() const {
    return on[kEffectIndex<Effect>];
  }
  /// Switches an effect on and adds to its parameters: a calibrated bias and a random one add up.
  template <class Effect>
  void add(const std::array<T, parameterSize<Effect>()>& increment) {
    on.set(kEffectIndex<Effect>);
    for (std::size_t i = 0; i < increment.size(); ++i) of<Effect>()[i] += increment[i];
  }
  /// The same parameters as another scalar, e.g. constants among Jets.
  template <class U>
  EffectParameters<U> cast() const {
    EffectParameters<U> other;
    other.on = on;
    for (std::size_t i = 0; i < values.size(); ++i)
      if (on.any()) other.values[i] = U(values[i]);
    return other;
  }
};

/// Calls f.template operator()<Effect>() for every registered effect, in order.
template <class F>
void forEachEffect(F&& f) {
  [&]<class... Effects>(std::tuple<Effects...>*) {
    (f.template operator()<Effects>(), ...);
  }(static_cast<AllEffects*>(nullptr));
}

/// Applies every effect that acts at this stage and is on.
template <class T, class Stage>
void applyEffects(const EffectParameters<T>& parameters, Stage& stage) {
  if (parameters.on.none()) return;
  forEachEffect([&]<class Effect>() {
    if constexpr (std::is_same_v<typename Effect::template Stage<T>, Stage>)
      if (parameters.template has<Effect>())
        Effect::template apply<T>(parameters.template of<Effect>(), stage);
  });
}

}  // namespace fathom
