#pragma once

#include <limits>
#include <vector>

#include "core/random.h"
#include "recording/samples.h"

/// What every kind of fault is made of. A kind is a plain struct, NAME_fault.h:
///
/// ~~~
/// struct DropFault {
///   static constexpr const char* id = "drop";        // its name in YAML
///   static constexpr bool changes_values = false;    // true: only for sensors that have numbers
///   double probability = 0;
///   template <class F> void fields(F& f) { f.strength("probability", probability, Limit::probability); }
///   void apply(Arrival arrival, const FaultContext& context, std::vector<Arrival>& out) const;
/// };
/// ~~~
/// `fields` names its parameters once, for reading, scaling and varying them: f.strength(key, value, limit)
/// for what says how strong it is (zero changes nothing), f.option for what does not, f.amount(key, labels,
/// value, limit) for a strength that concerns some sensors only, f.choices(key, names, chosen) for a list of
/// words. `apply` puts what becomes of a sample into `out`: nothing, it, or more. It may delay an arrival,
/// never hasten it, and must draw the same number of random numbers however strong it is, so that a stronger
/// fault hits what a weaker one hits, and more.
namespace fathom {

/// A sample on its way, and when it gets there: seconds on the stream's clock (degraded_source.h).
struct Arrival {
  double arrival_s = 0.0;
  Sample sample;
};

struct FaultContext {
  double since_begin_s;  ///< from the stage's begin to the sample's stamp
  Random& random;
};

/// What a parameter may be.
enum class Limit {
  any,
  not_negative,
  positive,
  probability,  ///< 0 to 1
};

}  // namespace fathom
