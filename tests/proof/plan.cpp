#include "plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "core/for_each.h"
#include "core/text.h"
#include "decoys.h"

namespace fathom::proof {
namespace fs = std::filesystem;
namespace {

constexpr std::array kCornerDives{DivePlan{"rich", "clear"},     DivePlan{"survey", "clear"},
                                  DivePlan{"approach", "clear"}, DivePlan{"turns", "clear"},
                                  DivePlan{"rich", "clear"},     DivePlan{"station", "clear"}};
constexpr std::array kImageDives{
    DivePlan{"rich", "moderate", true, 30}, DivePlan{"approach", "clear", true, 30},
    DivePlan{"survey", "moderate", true, 30}, DivePlan{"rich", "turbid", true, 30},
    DivePlan{"approach", "moderate", true, 30}};
/// Of poor excitation.
constexpr std::array kDecoyDives{DivePlan{"station", "clear"}, DivePlan{"closing", "moderate", true, 30},
                                 DivePlan{"approach", "clear"}, DivePlan{"closing", "clear", false, 30},
                                 DivePlan{"approach", "moderate", true, 30}};

/// Currents come and go.
Hidden drawnEffect(const EffectInfo& effect, const PlannedDive& dive, Random& random) {
  const Hidden hidden = madeEffect(effect, dive, random);
  if (effect.id != "water-current" || random.uniform() >= 0.5) return hidden;
  return test::activeDuring(hidden, test::randomInterval(dive.duration_s, random));
}

/// Lays the cases out, dive by dive in turn.
class Planner {
 public:
  Planner(const Extent& extent, const Programs& programs, fs::path folder)
      : extent_(extent), programs_(programs), folder_(std::move(folder)) {}

  std::vector<ProofCase> plan() {
    layOutDives();
    using enum ProofCase::Kind;
    addAll(effect, &Planner::addEffects);
    addAll(pair, &Planner::addPairs);
    addAll(null, &Planner::addNulls);
    addAll(outside, &Planner::addOutside);
    addAll(interval, &Planner::addIntervals);
    addAll(decoy, &Planner::addDecoys);
    return std::move(cases_);
  }

 private:
  void addAll(ProofCase::Kind kind, void (Planner::*addThem)()) {
    if (!extent_.has(kind)) return;
    turn_ = {};
    of_kind_ = 0;
    (this->*addThem)();
  }

  /// What hides nothing needs no size.
  bool needsResolution() const { return extent_.kinds != std::set<ProofCase::Kind>{ProofCase::Kind::null}; }

  void layOutDives() {
    const auto add = [&](const auto& plans, std::size_t count) {
      for (std::size_t i = 0; i < count; ++i)
        dives_.push_back(plannedDive(plans[i % plans.size()], extent_.first_seed + i, extent_.ordinary));
    };
    add(kCornerDives, extent_.corner_dives);
    add(kImageDives, extent_.image_dives);
    add(kDecoyDives, extent_.decoy_dives);
    if (!needsResolution()) return;
    forEachIndex(dives_.size(), "dives", [&](std::size_t i) {
      const std::string name = print("dive-%zu", i);
      dives_[i].resolution.emplace(
          sealedInput(generatorCase(name, dives_[i], 1000 + i), programs_, folder_ / name));
    });
  }

  /// The next dive with images, or of corners.
  PlannedDive& nextDive(bool images) {
    std::size_t& turn = turn_[images ? 1 : 0];
    const std::size_t count = images ? extent_.image_dives : extent_.corner_dives;
    return dives_[(images ? extent_.corner_dives : 0) + turn++ % count];
  }

  ProofCase& add(ProofCase::Kind kind, const std::string& name, const PlannedDive& dive) {
    ProofCase c;
    c.kind = kind;
    c.name = name;
    c.generator = generatorCase(
        name, dive, extent_.first_seed * 100000 + 10000 * static_cast<std::uint64_t>(kind) + of_kind_++);
    cases_.push_back(c);
    return cases_.back();
  }

  void hide(const Hidden& hidden, const PlannedDive& dive, ProofCase& c) {
    c.generator["effects"].push_back(generatorEffect(hidden, dive));
    c.effects.push_back(describedEffect(hidden, *dive.resolution));
  }

  /// The first of the dives in turn on which `draw` makes an effect that can have that size.
  template <class Draw>
  std::optional<Hidden> sizedEffect(const EffectInfo& effect, double sqrt_lambda, const PlannedDive*& dive,
                                    const Draw& draw) {
    const bool images = effect.text.channel == EffectChannel::image;
    for (std::size_t tries = 0; tries < 2 * dives_.size(); ++tries) {
      dive = &nextDive(images);
      if (!canHide(effect, *dive)) continue;
      if (auto hidden = ofSize(draw(*dive), *dive, sqrt_lambda)) return hidden;
    }
    return {};
  }

  void addEffects() {
    for (const EffectInfo& effect : allEffects()) {
      if (effect.index % extent_.every != 0) continue;
      for (const double stratum : extent_.strata)
        for (std::size_t k = 0; k < extent_.each; ++k) {
          Random random =
              Random::stream(extent_.first_seed + k, 100 * effect.index + static_cast<std::size_t>(stratum));
          const PlannedDive* dive = nullptr;
          const auto hidden = sizedEffect(
              effect, stratum, dive, [&](const PlannedDive& on) { return drawnEffect(effect, on, random); });
          if (!hidden) continue;
          ProofCase& c = add(ProofCase::Kind::effect,
                             print("%s-%g-%zu", std::string(effect.id).c_str(), stratum, k), *dive);
          c.stratum = stratum;
          hide(*hidden, *dive, c);
        }
    }
  }

  /// Both of sqrt(lambda) 10 to 32, on one dive.
  void addPairs() {
    Random random = Random::stream(extent_.first_seed, 7001);
    for (std::size_t tries = 0, made = 0; made < extent_.pairs && tries < 20 * extent_.pairs; ++tries) {
      PlannedDive& dive = nextDive(made % 2 == 1);
      std::vector<Hidden> both;
      for (int k = 0; k < 2; ++k) {
        const EffectInfo& effect = effectsOfGenerator()[random.bits() % effectsOfGenerator().size()];
        const bool again = !both.empty() && both[0].candidate.effect == effect.index;
        if (again || !canHide(effect, dive)) break;
        const double size = std::exp(random.uniform(std::log(10.0), std::log(32.0)));
        const auto hidden = ofSize(drawnEffect(effect, dive, random), dive, size);
        if (hidden) both.push_back(*hidden);
      }
      if (both.size() < 2) continue;
      ProofCase& c = add(ProofCase::Kind::pair, print("pair-%zu", made++), dive);
      c.stratum = 10;
      for (const Hidden& hidden : both) hide(hidden, dive, c);
    }
  }

  /// By a world richer than the model, if not by an ordinary one; three in five without images.
  void addNulls() {
    for (std::size_t i = 0; i < extent_.nulls; ++i) {
      ProofCase& c = add(ProofCase::Kind::null, print("null-%zu", i), nextDive(i % 5 >= 3));
      c.generator["rich"] = extent_.ordinary == 0;
    }
  }

  struct Outsider {
    const char* kind;
    bool images;
    std::array<double, 3> sizes;
  };
  static constexpr std::array kOutsiders{Outsider{"panel-folded", false, {0.5, 1.0, 2.0}},
                                         Outsider{"port-blotch", true, {0.02, 0.05, 0.2}},
                                         Outsider{"panel-bowed", false, {3, 6, 12}},
                                         Outsider{"response-by-colour", true, {0.01, 0.03, 0.1}},
                                         Outsider{"dvl-quadratic", false, {0.1, 0.2, 0.4}},
                                         Outsider{"bubbles", true, {20, 60, 200}},
                                         Outsider{"gyro-g-sensitivity", false, {1e-4, 3e-4, 1e-3}},
                                         Outsider{"mount-shake", false, {0.02, 0.05, 0.2}}};

  void addOutside() {
    std::vector<const PlannedDive*> dives;
    const std::size_t first = cases_.size();
    for (std::size_t i = 0; i < extent_.outside; ++i) {
      const Outsider& outsider = kOutsiders[i % kOutsiders.size()];
      const PlannedDive& dive = nextDive(outsider.images);
      const double size = outsider.sizes[i / kOutsiders.size() % outsider.sizes.size()];
      ProofCase& c = add(ProofCase::Kind::outside, print("%s-%zu", outsider.kind, i), dive);
      c.generator["outside"].push_back({{"kind", outsider.kind}, {"size", size}});
      dives.push_back(&dive);
    }
    forEachIndex(dives.size(), "outsiders", [&](std::size_t i) {
      ProofCase& c = cases_[first + i];
      nlohmann::json quiet = c.generator;
      quiet["noise"] = false;
      const Resolution::Shown shown =
          dives[i]->resolution->shownBy(sealedInput(quiet, programs_, folder_ / c.name));
      c.lambda = shown.lambda;
      c.left = shown.left;
    });
  }

  /// Of effects that last; every third comes and stays.
  void addIntervals() {
    constexpr std::array kLasting{"dvl-scale",           "lamp",
                                  "gyro-bias",           "slant-range",
                                  "ins-latency",         "gamma",
                                  "camera-misalignment", "separate-backscatter",
                                  "focal-scale",         "dvl-misalignment"};
    for (std::size_t i = 0; i < extent_.intervals; ++i) {
      const EffectInfo& effect = *findEffect(kLasting[i % kLasting.size()]);
      const double stratum = i / kLasting.size() % 2 == 0 ? 16 : 32;
      Random random = Random::stream(extent_.first_seed, 9000 + i);
      const PlannedDive* dive = nullptr;
      const auto hidden = sizedEffect(effect, stratum, dive, [&](const PlannedDive& on) {
        Interval active_s = test::randomInterval(on.duration_s, random);
        if (i % 3 == 2) active_s.to_s = on.duration_s;
        return test::activeDuring(madeEffect(effect, on, random), active_s);
      });
      if (!hidden) continue;
      ProofCase& c =
          add(ProofCase::Kind::interval, print("part-%s-%zu", kLasting[i % kLasting.size()], i), *dive);
      c.stratum = stratum;
      hide(*hidden, *dive, c);
    }
  }

  /// Of each dive of poor excitation some, evenly from the hardest on.
  void addDecoys() {
    constexpr double kSize = 10;
    for (std::size_t i = dives_.size() - extent_.decoy_dives; i < dives_.size(); ++i) {
      const std::vector<Decoy> all = decoysOn(dives_[i], kSize, extent_.first_seed + i);
      const std::size_t count = std::min(all.size(), extent_.decoys_a_dive);
      for (std::size_t k = 0; k < count; ++k) {
        const Decoy& decoy = all[k * all.size() / count];
        ProofCase& c = add(ProofCase::Kind::decoy, print("decoy-%zu-%zu", i, k), dives_[i]);
        c.stratum = kSize;
        c.generator["effects"].push_back(generatorEffect(decoy.hidden, dives_[i]));
        c.effects.push_back(decoy.described);
      }
    }
  }

  const Extent& extent_;
  const Programs& programs_;
  fs::path folder_;
  std::vector<PlannedDive> dives_;
  std::array<std::size_t, 2> turn_{};
  std::size_t of_kind_ = 0;  ///< cases so far
  std::vector<ProofCase> cases_;
};

}  // namespace

Extent wholeProof() { return {}; }

Extent quickProof() {
  Extent quick;
  quick.corner_dives = 2;
  quick.image_dives = 1;
  quick.strata = {16};
  quick.every = 24;
  quick.pairs = 1;
  quick.nulls = 1;
  quick.outside = 1;
  quick.intervals = 1;
  quick.decoy_dives = 1;
  quick.decoys_a_dive = 1;
  return quick;
}

std::vector<ProofCase> planProof(const Extent& extent, const Programs& programs, const fs::path& folder) {
  return Planner(extent, programs, folder).plan();
}

}  // namespace fathom::proof
