#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/refit.h"
#include "diagnosis/screening.h"

namespace fathom {

/// Fits of sets of effects to one recording under one noise, each made once, and what they are worth beside
/// the nominal model. The same whatever the number of threads.
class Fits {
 public:
  /// `segments`: onsets and ends are looked for at so many places first. The data is referred to.
  Fits(const BatchData& data, int segments) : data_(data), segments_(segments) {}

  /// Under another noise: what was fitted is forgotten. `base`: the nominal fit's options, with that noise.
  void beginWith(Refit nominal, BatchOptions base, const NoiseModel& noise);
  void setThreshold(double log_odds) { threshold_ = log_odds; }

  const BatchData& data() const { return data_; }
  const Refit& nominal() const { return nominal_; }
  const NoiseModel& noise() const { return noise_; }
  const BatchOptions& base() const { return base_; }
  int segments() const { return segments_; }
  double segment_s() const;

  /// In the order of the sets; those that are new are made at once, from where `from` ended. But the last few
  /// that were asked for, fits are without their models (modelOf()).
  std::vector<Refit> of(const Refit& from, const std::vector<std::vector<Candidate>>& sets);
  Refit of(const Refit& from, const std::vector<Candidate>& effects) {
    return of(from, std::vector<std::vector<Candidate>>{effects}).front();
  }
  /// With one effect fewer; without any: the nominal one.
  Refit without(const Refit& from, std::size_t one);
  /// Makes those at once, to be asked for.
  void makeWithoutEach(const Refit& fit);

  /// ln of how much likelier a fit's effects make the readings than none: no more than they do to first
  /// order, see Weight::log_bayes_factor; the rest is another minimum's.
  double gainOf(const Refit& fit) const;
  /// ln of the odds of a fit's effects against the nominal model, before looking and by the readings.
  double logOdds(const Refit& fit) const;
  /// Of those that succeeded.
  std::optional<Refit> bestOf(std::vector<Refit> all) const;
  /// What an effect has to add to the log odds to be named.
  double threshold() const { return threshold_; }
  /// The same, of one that comes beside others.
  double thresholdBeside() const;
  /// Of each: intervals and times to a fraction of a segment, and whether what seems lasting was on for a
  /// part only.
  std::vector<Refit> settled(std::vector<Refit> all);
  /// With those for good that were on for a part where that fits better: of an effect that is far from linear
  /// a part can seem better to first order, and others then stand for the rest of it.
  Refit lastingWhereBetter(Refit fit);
  /// Without those effects that are not needed; one remains.
  Refit onlyNeeded(Refit fit);

  /// Each that was made until now, of a camera by itself.
  template <class Look>
  void forEach(Look&& look) const {
    for (const auto& [name, cached] : fitted_)
      if (cached.fit.succeeded) look(cached.fit);
  }

 private:
  const BatchData& data_;
  int segments_;
  BatchOptions base_;
  NoiseModel noise_;
  Refit nominal_;
  PriorOdds prior_;
  double threshold_ = 0;
  struct Asked {
    const Refit* from;  // where to begin
    std::vector<Candidate> effects;
  };
  std::vector<Refit> of(const std::vector<Asked>& all);
  Candidate settledOf(const Refit& rest, const Candidate& effect) const;
  bool mayLast(const Refit& fit, std::size_t effect);
  void letModelsGo();

  struct Cached {
    Refit fit;
    std::size_t asked = 0;  // when, last
  };
  std::map<std::string, Cached> fitted_;  // by the effects' names
  std::size_t asked_ = 0;
};

/// Of the log odds of what may turn out to be the best once it is refitted, or at its best times, beside the
/// largest.
double leastOfContenders(double largest);

}  // namespace fathom
