#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>

#include "sensors/all_instruments.h"

/// The channels of all instruments, and what of images is compared beside them: what is fused, estimated,
/// diagnosed and told in results.
namespace fathom {

// Of images. Their predictions are in camera_geometry.h, image_patch.h, image_texture.h, marker_blur.h,
// marine_snow.h, two_views.h.

/// A pose from markers, as the filter takes it.
struct Landmark {
  static constexpr ChannelText channel{.id = "landmark",
                                       .label = "MARKERS",
                                       .unit = "sigma",
                                       .is_of_images = true,
                                       .is_estimated = false,
                                       .tells = ChannelText::Tells::position};
};
/// Corners of markers.
struct Markers {
  static constexpr ChannelText channel{.id = "markers",
                                       .label = "MARKERS",
                                       .unit = "px",
                                       .metric = "reprojection_rms_px",
                                       .material = 0.03,
                                       .components = {"x", "y", ""},
                                       .component_count = 2,
                                       .is_of_images = true,
                                       .has_outliers = true,
                                       .is_filtered = false};
};
/// Points that both cameras of a pair see.
struct EpipolarResidual {
  static constexpr ChannelText channel{.id = "tie points",
                                       .label = "TIE_POINTS",
                                       .unit = "sigma",
                                       .metric = "contradiction_rms_sigma",
                                       .material = 0.1,  // of the sigma stated
                                       .components = {"across the lines of sight", "", ""},
                                       .component_count = 1,
                                       .is_of_images = true,
                                       .has_outliers = true,
                                       .is_filtered = false};
};
/// Patches of known albedo and distance.
struct Pixels {
  static constexpr ChannelText channel{.id = "pixels",
                                       .label = "CAMERA",
                                       .unit = "DN",
                                       .scale = 255,
                                       .metric = "patch_rms_dn",
                                       // Of a patch of a hundred pixels, whose noise is not much less.
                                       .material = 0.03 / 255,
                                       .components = {"red", "green", "blue"},
                                       .is_of_images = true,
                                       .has_outliers = true,
                                       .is_filtered = false};
};
/// How blurred markers' edges are.
struct Edges {
  static constexpr ChannelText channel{
      .id = "edges",
      .label = "CAMERA",
      .unit = "px²",
      .metric = "blur_rms_px2",
      .material = 0.15,  // a blur of 0.4 px. Another renderer's pixels differed by 0.05, marker by marker
      .components = {"across", "aslant", "upright"},
      .is_of_images = true,
      .has_outliers = true,
      .is_filtered = false};
};
/// Numbers of particles seen, by size.
struct Specks {
  static constexpr ChannelText channel{.id = "specks",
                                       .label = "CAMERA",
                                       .unit = "specks",
                                       .metric = "specks_rms_count",
                                       .material = 0.3,  // of a size, in an image
                                       .components = {"1 to 3 px", "4 to 15 px", "16 px or more"},
                                       .has_outliers = true,
                                       .is_filtered = false};
};
/// What interpolated colours and compression leave in the noise of images: logarithms of ratios of variances.
struct Texture {
  static constexpr ChannelText channel{.id = "texture",
                                       .label = "CAMERA",
                                       .unit = "1",
                                       .metric = "texture_rms",
                                       .material = 0.03,  // 3 % of a variance
                                       .components = {"chessboard", "blocks", ""},
                                       .component_count = 2,
                                       .has_outliers = true,
                                       .is_filtered = false};
};
/// What is assumed beforehand.
struct Prior {
  static constexpr ChannelText channel{.id = "prior", .label = "prior", .unit = "1", .is_filtered = false};
};

namespace detail {
template <class... Instruments>
auto channelsOf(std::tuple<Instruments...>*) -> decltype(std::tuple_cat(typename Instruments::Channels{}...));
}  // namespace detail

/// Of all instruments, in order.
using InstrumentChannels = decltype(detail::channelsOf(static_cast<AllInstruments*>(nullptr)));
using AllChannels = decltype(std::tuple_cat(
    InstrumentChannels{},
    std::tuple<Landmark, Markers, EpipolarResidual, Pixels, Edges, Specks, Texture, Prior>{}));

inline constexpr std::size_t kChannelCount = std::tuple_size_v<AllChannels>;
inline constexpr std::size_t kInstrumentChannelCount = std::tuple_size_v<InstrumentChannels>;

/// One of AllChannels, by its place.
enum class Channel : std::uint8_t {};

namespace detail {
template <class C, std::size_t I = 0>
constexpr std::size_t placeOf() {
  static_assert(I < kChannelCount, "channel is not in AllChannels");
  if constexpr (std::is_same_v<C, std::tuple_element_t<I, AllChannels>>)
    return I;
  else
    return placeOf<C, I + 1>();
}
template <std::size_t... I>
constexpr auto everyChannel(std::index_sequence<I...>) {
  return std::array{static_cast<Channel>(I)...};
}
template <class... Channels>
constexpr auto channelTexts(std::tuple<Channels...>*) {
  return std::array{Channels::channel...};
}
}  // namespace detail

template <class C>
inline constexpr Channel kChannel = static_cast<Channel>(detail::placeOf<C>());
inline constexpr auto kEveryChannel = detail::everyChannel(std::make_index_sequence<kChannelCount>{});

constexpr std::size_t indexOf(Channel channel) { return static_cast<std::size_t>(channel); }

inline constexpr auto kChannelTexts = detail::channelTexts(static_cast<AllChannels*>(nullptr));
constexpr const ChannelText& textOf(Channel channel) { return kChannelTexts[indexOf(channel)]; }

namespace detail {
template <class... Channels>
constexpr auto sensorKinds(std::tuple<Channels...>*) {
  const auto kindOf = []<class C>() {
    if constexpr (requires { C::Instrument::label; })
      return sensorKind(C::Instrument::label);
    else
      return sensorKind(Camera::label);
  };
  return std::array{kindOf.template operator()<Channels>()...};
}
}  // namespace detail

/// Whose clock stamps it: the instrument's place in kSensorKinds, of what is not an instrument's the
/// camera's.
inline int sensorKindOf(Channel channel) {
  static constexpr auto kinds = detail::sensorKinds(static_cast<AllChannels*>(nullptr));
  return kinds[indexOf(channel)];
}

/// The name in configs, results and plots, e.g. "gyro".
inline std::string nameOf(Channel channel) { return std::string(textOf(channel).id); }

}  // namespace fathom
