#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/geometry.h"
#include "effects/effect_text.h"
#include "effects/parameter.h"

/// The registered effects without their types, for listings, reports and fits.
namespace fathom {

struct EffectInfo {
  std::string_view id;
  EffectText text;
  std::span<const Parameter> parameters;
  std::size_t index = 0;                      ///< in EffectParameters::on and active_s
  std::size_t first_scalar = 0;               ///< in EffectParameters::values
  std::size_t scalars = 0;                    ///< so many, list by list in the order of the parameters
  const DerivedParameter* derived = nullptr;  ///< null: there is none
  /// It acts on an instrument, of which a vehicle may have several, not on the world.
  bool is_of_instrument = true;
  /// Its value by the effect's scalars; the first of derived->size count.
  Vector3d (*derive)(const double* p, const DerivedFrom& from) = nullptr;

  std::vector<std::string_view> confusedWith() const;
  /// Whether any of its parameters is of this kind.
  bool has(ParameterKind kind) const;
};

/// In the order of the registry.
const std::vector<EffectInfo>& allEffects();
/// Of a scalar by its place in EffectParameters::values: what it is, and which effect's.
const Parameter& parameterOf(std::size_t scalar);
std::size_t effectOf(std::size_t scalar);
/// How far from where its effect does nothing a scalar of this value is: 0 where it only says where or when.
double sizeOf(std::size_t scalar, double value);
/// What people know as the parameter, in its unit, of what EffectParameters hold: another only where it is
/// squared.
double asNamed(const Parameter& parameter, double value);
/// The inverse, of a value that is possible.
double asHeld(const Parameter& parameter, double named);
/// The same of a standard deviation about that value.
double sigmaAsNamed(const Parameter& parameter, double value, double sigma);
/// Whether a parameter can have this value: not less than nothing of what is positive.
bool isPossible(const Parameter& parameter, double value);
/// Null: no such effect.
const EffectInfo* findEffect(std::string_view id);
/// All ids, separated by commas, for messages.
std::string knownEffects();

/// "navigation", "marker geometry", "image".
std::string_view nameOf(EffectChannel channel);
/// "continuous", "marker id", …
std::string_view nameOf(ParameterKind kind);

}  // namespace fathom
