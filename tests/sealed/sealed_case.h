#pragma once

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/geometry.h"

/// What a sealed recording hides: the case file, and its effects as functions of time.
namespace fathom::sealed {

struct DiveCase {
  std::string manoeuvre;       ///< rich, survey, station, approach, closing, turns or given
  std::filesystem::path path;  ///< of what is given: TUM text, see given_path.h; else empty
  std::uint64_t seed = 0;
  double duration_s = 0;
  bool images = false;  ///< else the corners that a detector would measure
  double image_rate_hz = 1;
  std::string water;                ///< clear, moderate or turbid
  bool panel_with_squares = false;  ///< `panel`: plain (where it is left out) or squares, see panel_design.h
};

/// An effect of the catalogue; parameters as `fathom effects ID` documents them.
struct HiddenEffect {
  std::string id;
  std::map<std::string, std::vector<double>, std::less<>> parameters;
  std::string sensor;                               ///< of `clock-drift`: a label of the recording
  std::vector<std::pair<double, double>> active_s;  ///< since the recording's first entry; empty: always

  bool activeAt(double t_s) const {
    const auto holds = [t_s](const auto& interval) {
      return t_s >= interval.first && t_s <= interval.second;
    };
    return active_s.empty() || std::any_of(active_s.begin(), active_s.end(), holds);
  }
};

/// What no effect of the catalogue describes.
struct Outsider {
  std::string kind;
  double size = 0;  ///< unit by kind, see sealed_case.cpp
};

struct SealedCase {
  std::string name;
  DiveCase dive;
  std::uint64_t seed = 0;
  bool noise = true;    ///< false: no random noise at all; images are still rounded to 8 bits
  bool rich = false;    ///< imperfections below what matters, that the program's model lacks
  double ordinary = 0;  ///< imperfections that every recording has, in units of kOrdinary; 0: none
  std::vector<HiddenEffect> effects;
  std::vector<Outsider> outsiders;
  nlohmann::json document;  ///< the case file as it is

  /// Nothing where the effect is not hidden, or not active then.
  const HiddenEffect* find(std::string_view id, double t_s) const;
  /// A parameter then; zero, which is neutral, where the effect is not active or leaves it out.
  double number(std::string_view id, std::string_view parameter, double t_s) const;
  Vector3d vector(std::string_view id, std::string_view parameter, double t_s) const;
  /// A rotation vector parameter in degrees as a rotation.
  Matrix3d rotation(std::string_view id, std::string_view parameter_deg, double t_s) const;
  /// When a sensor measured what its drifting clock stamps so.
  double trueTime_s(std::string_view sensor, double stamp_s) const;
  /// Zero where it is not hidden.
  double outsideSize(std::string_view kind) const;
};

/// Strict: throws Error (file, key, reason) for whatever is unknown, missing, twice or of the wrong kind, and
/// for an effect on light where there are no images.
SealedCase readSealedCase(const std::filesystem::path& file);
SealedCase parseSealedCase(const std::string& text, const std::string& name);

}  // namespace fathom::sealed
