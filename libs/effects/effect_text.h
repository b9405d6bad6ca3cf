#pragma once

#include <array>
#include <string_view>

namespace fathom {

enum class EffectChannel { navigation, marker_geometry, image };

/// What an engineer should know of an effect besides its parameters. It is the effect's docstring, and what
/// `fathom effects ID` prints.
struct EffectText {
  EffectChannel channel = EffectChannel::navigation;
  std::string_view title{};     ///< what is other than the nominal model has it, one line
  std::string_view equation{};  ///< in the parameters' names
  std::string_view source{};
  std::array<std::string_view, 4> confused_with{};  ///< ids; the rest empty
  std::string_view told_apart{};                    ///< what a recording needs to show this one
};

}  // namespace fathom
