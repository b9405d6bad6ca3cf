#pragma once

#include <algorithm>
#include <array>
#include <bitset>
#include <cstddef>
#include <optional>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/instance.h"
#include "effects/accelerometer_bias.h"
#include "effects/auto_exposure.h"
#include "effects/beam_bias.h"
#include "effects/beam_missing.h"
#include "effects/biofouling.h"
#include "effects/camera_latency.h"
#include "effects/camera_misalignment.h"
#include "effects/clock_drift.h"
#include "effects/dark_offset.h"
#include "effects/defocus.h"
#include "effects/demosaicing.h"
#include "effects/dome_port.h"
#include "effects/dvl_latency.h"
#include "effects/dvl_lever_arm.h"
#include "effects/dvl_misalignment.h"
#include "effects/dvl_scale.h"
#include "effects/earth_rotation.h"
#include "effects/edge_bias.h"
#include "effects/extra_effects.h"
#include "effects/flat_field.h"
#include "effects/flat_port_refraction.h"
#include "effects/flat_water_surface.h"
#include "effects/focal_scale.h"
#include "effects/forward_scatter.h"
#include "effects/gamma.h"
#include "effects/gyro_bias.h"
#include "effects/gyro_scale.h"
#include "effects/heading_disturbance.h"
#include "effects/illumination_gradient.h"
#include "effects/image_compression.h"
#include "effects/ins_latency.h"
#include "effects/ins_misalignment.h"
#include "effects/lamp.h"
#include "effects/lens_distortion.h"
#include "effects/marine_snow.h"
#include "effects/marker_moved.h"
#include "effects/marker_size.h"
#include "effects/motion_blur.h"
#include "effects/occlusion.h"
#include "effects/panel_moved.h"
#include "effects/panel_shape.h"
#include "effects/pressure_density.h"
#include "effects/pressure_lever_arm.h"
#include "effects/pressure_offset.h"
#include "effects/response_bend.h"
#include "effects/rolling_shutter.h"
#include "effects/separate_backscatter.h"
#include "effects/sharpening.h"
#include "effects/slant_range.h"
#include "effects/sun_flicker.h"
#include "effects/turbidity_plume.h"
#include "effects/veiling_glare.h"
#include "effects/vignetting.h"
#include "effects/water_current.h"
#include "effects/white_balance.h"

/// To add an effect: see libs/effects/README.md. Simulator, filter, calibration file, `fathom effects` and
/// the property tests over the registry then know it.
namespace fathom {

/// The only registration. Effects at the same stage are applied in this order: a misalignment turns the
/// mounting before a lever arm moves it, a scale acts on what the sensor would have read, a bias is added to
/// that; of the veil's own attenuation, too, the line of sight is the way.
using Catalogue =
    std::tuple<DvlMisalignment, DvlLeverArm, DvlLatency, WaterCurrent, DvlScale, EarthRotation, GyroScale,
               GyroBias, AccelerometerBias, InsMisalignment, InsLatency, PressureDensity, PressureOffset,
               FlatPortRefraction, FocalScale, LensDistortion, CameraMisalignment, CameraLatency,
               RollingShutter, MarkerMoved, MarkerSize, PanelMoved, SunFlicker, Lamp, SeparateBackscatter,
               TurbidityPlume, SlantRange, ForwardScatter, Vignetting, AutoExposure, Gamma, DarkOffset,
               MotionBlur, MarineSnow, HeadingDisturbance, ClockDrift, EdgeBias, PanelShape,
               IlluminationGradient, PressureLeverArm, FlatField, WhiteBalance, ResponseBend, VeilingGlare,
               Defocus, Sharpening, BeamMissing, BeamBias, DecentredDome, FlatWaterSurface, Biofouling,
               Occlusion, Demosaicing, ImageCompression>;

/// The catalogue, and after it what the build was told to know besides.
using AllEffects = decltype(std::tuple_cat(Catalogue{}, ExtraEffects{}));

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

/// When, s since the recording's first entry: once, or with pauses. The default outlasts every recording.
struct Interval {
  static constexpr double kForever_s = 1e9;
  double from_s = -kForever_s, to_s = kForever_s;
  /// Between these it is not; one that does not last is none. In the order of time.
  struct Pause {
    double from_s = 0, to_s = 0;
    bool isOne() const { return from_s < to_s; }
    friend bool operator==(const Pause&, const Pause&) = default;
  };
  std::array<Pause, 2> pauses{};

  bool contains(double t_s) const {
    if (!(from_s <= t_s && t_s <= to_s)) return false;
    for (const Pause& pause : pauses)
      if (pause.from_s < t_s && t_s < pause.to_s) return false;
    return true;
  }
  /// [from, to] of each time that it is.
  std::vector<std::array<double, 2>> parts() const {
    std::vector<std::array<double, 2>> all{{from_s, to_s}};
    for (const Pause& pause : pauses)
      if (pause.isOne()) {
        all.back()[1] = pause.from_s;
        all.push_back({pause.to_s, to_s});
      }
    return all;
  }
  friend bool operator==(const Interval&, const Interval&) = default;
};

/// Which effects are on, when, and with which parameters. All off: the nominal model.
template <class T>
struct EffectParameters {
  std::array<T, kEffectOffsets[kEffectCount]> values{};
  std::bitset<kEffectCount> on;
  std::array<Interval, kEffectCount> active_s{};
  /// On which of a vehicle's several instruments of the kind; nothing: on each.
  std::array<std::optional<Instance>, kEffectCount> only{};
  /// An effect that is on one instrument already, as another one has it besides.
  struct Further {
    std::size_t effect = 0;
    Instance instance;
    std::vector<T> values;
    Interval active_s;
  };
  std::vector<Further> further;
  /// Where not null, applyEffects() notes here which effects act at the stages that it is called with: so it
  /// is known which effects a model has.
  std::bitset<kEffectCount>* asked = nullptr;

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
  bool isActive(std::size_t effect, double t_s) const { return on[effect] && active_s[effect].contains(t_s); }
  bool concerns(std::size_t effect, const Instance& instance) const {
    return !only[effect] || *only[effect] == instance;
  }

  /// Switches an effect on and adds to its parameters: a calibrated bias and a random one add up.
  template <class Effect>
  void add(const std::array<T, parameterSize<Effect>()>& increment) {
    on.set(kEffectIndex<Effect>);
    for (std::size_t i = 0; i < increment.size(); ++i) of<Effect>()[i] += increment[i];
  }
  /// Those that act on one instrument, as if it were the only one.
  EffectParameters of(const Instance& instance) const {
    EffectParameters own = *this;
    for (std::size_t e = 0; on.any() && e < kEffectCount; ++e)
      if (!concerns(e, instance)) own.on.reset(e);
    own.only = {};
    own.further.clear();
    for (const Further& f : further) {
      if (!(f.instance == instance)) continue;
      own.on.set(f.effect);
      own.active_s[f.effect] = f.active_s;
      std::copy(f.values.begin(), f.values.end(), own.values.begin() + kEffectOffsets[f.effect]);
    }
    return own;
  }
  /// What is active at one time on one instrument, on for good and as another scalar, e.g. constants among
  /// Jets: what acts at all times (a bias that a filter carries) can be added to it.
  template <class U>
  EffectParameters<U> at(double t_s, const Instance& instance = {}) const {
    EffectParameters<U> now;
    for (std::size_t e = 0; on.any() && e < kEffectCount; ++e) {
      if (!isActive(e, t_s) || !concerns(e, instance)) continue;
      now.on.set(e);
      for (std::size_t i = kEffectOffsets[e]; i < kEffectOffsets[e + 1]; ++i) now.values[i] = U(values[i]);
    }
    for (const Further& f : further) {
      if (!(f.instance == instance) || !f.active_s.contains(t_s)) continue;
      now.on.set(f.effect);
      for (std::size_t i = 0; i < f.values.size(); ++i)
        now.values[kEffectOffsets[f.effect] + i] = U(f.values[i]);
    }
    return now;
  }
};

/// Calls `f.template operator()<Effect>()` for every registered effect, in order.
template <class F>
void forEachEffect(F&& f) {
  [&]<class... Effects>(std::tuple<Effects...>*) {
    (f.template operator()<Effects>(), ...);
  }(static_cast<AllEffects*>(nullptr));
}

/// Whether an effect acts at a stage: its own, or one that is of its own's kind.
template <class Effect, class T, class Stage>
inline constexpr bool kActsAt = std::is_base_of_v<typename Effect::template Stage<T>, Stage>;

/// The effects that act at a stage, which is one of T.
template <class T, class Stage>
const std::bitset<kEffectCount>& effectsAt() {
  static const std::bitset<kEffectCount> acting = [] {
    std::bitset<kEffectCount> effects;
    forEachEffect([&]<class Effect>() { effects[kEffectIndex<Effect>] = kActsAt<Effect, T, Stage>; });
    return effects;
  }();
  return acting;
}

/// Applies every effect that acts at this stage and is active t_s after the recording's first entry: the
/// entry's time stamp, whatever its latency. Of several instruments of a kind, the parameters must be this
/// one's (EffectParameters::of()).
template <class T, class Stage>
void applyEffects(const EffectParameters<T>& parameters, double t_s, Stage& stage) {
  if (parameters.asked != nullptr) *parameters.asked |= effectsAt<T, Stage>();
  if (parameters.on.none()) return;
  forEachEffect([&]<class Effect>() {
    if constexpr (kActsAt<Effect, T, Stage>)
      if (parameters.isActive(kEffectIndex<Effect>, t_s))
        Effect::template apply<T>(parameters.template of<Effect>(), stage);
  });
}

/// Whether any of the effects that act at this stage (of double) is on, at whatever time.
template <class Stage, class T>
bool anyActsAt(const EffectParameters<T>& parameters) {
  return (parameters.on & effectsAt<double, Stage>()).any();
}

}  // namespace fathom
