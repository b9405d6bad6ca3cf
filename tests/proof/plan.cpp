#include "plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include "batch_recording.h"
#include "core/files.h"
#include "core/for_each.h"
#include "core/random.h"
#include "core/text.h"
#include "effects/drawn.h"
#include "resolution.h"

namespace fathom::proof {
namespace fs = std::filesystem;
namespace {

struct DivePlan {
  const char *manoeuvre, *water;
};
constexpr std::array kCornerDives{DivePlan{"rich", "clear"},     DivePlan{"survey", "clear"},
                                  DivePlan{"approach", "clear"}, DivePlan{"turns", "clear"},
                                  DivePlan{"rich", "clear"},     DivePlan{"station", "clear"}};
constexpr std::array kImageDives{DivePlan{"rich", "moderate"}, DivePlan{"approach", "clear"},
                                 DivePlan{"survey", "moderate"}, DivePlan{"rich", "turbid"},
                                 DivePlan{"approach", "moderate"}};

/// A dive that cases share, and what its recordings can resolve.
struct Dive {
  nlohmann::json json;
  bool images = false;
  double duration_s = 0;
  std::optional<Resolution> resolution;
};

Dive diveOf(const DivePlan& plan, bool images, std::uint64_t seed) {
  Dive dive;
  dive.images = images;
  dive.duration_s = images ? 30 : 80;
  dive.json = {{"manoeuvre", plan.manoeuvre},         {"seed", seed},
               {"duration_s", dive.duration_s},       {"camera", images ? "images" : "corners"},
               {"image_rate_hz", images ? 1.0 : 2.0}, {"water", plan.water}};
  return dive;
}

nlohmann::json generatorCase(const std::string& name, const Dive& dive, std::uint64_t seed) {
  return {{"name", name},
          {"dive", dive.json},
          {"seed", seed},
          {"noise", true},
          {"rich", false},
          {"effects", nlohmann::json::array()},
          {"outside", nlohmann::json::array()}};
}

/// Seals a recording and reads it as the program does.
BatchInput inputOf(const nlohmann::json& generator_case, const Programs& programs, const fs::path& folder) {
  sealRecording(programs, generator_case, folder / "recording", folder / "truth");
  BatchRecordingOptions options;
  options.rawlog = folder / "recording" / "recording.rawlog";
  options.pixels = true;
  options.folder = folder;
  return readBatchRecording(options, {}).input;
}

/// What the generator knows nothing of stays as it is.
bool isMade(const std::string_view effect, const std::string_view parameter) {
  if (effect == "vignetting") return parameter == "corner_loss";
  if (effect == "flat-port-refraction") return parameter != "index_error" && parameter != "slab_m";
  return true;
}

/// An effect at random: its parameters in units of what an engineer expects, its marker, its time.
Hidden randomEffect(const EffectInfo& effect, const Dive& dive, Random& random) {
  Hidden hidden;
  hidden.candidate.effect = effect.index;
  hidden.effects.on.set(effect.index);
  const std::vector<int>& ids = dive.resolution->markerIds();
  std::size_t scalar = effect.first_scalar;
  for (const Parameter& parameter : effect.parameters)
    for (int i = 0; i < parameter.size; ++i, ++scalar) {
      double& value = hidden.effects.values[scalar];
      if (isSize(parameter.kind) && isMade(effect.id, parameter.name))
        value = parameter.prior_sigma * random.normal();
      if (!isPossible(parameter, value)) value = -value;
      if (parameter.kind == ParameterKind::peak_time) value = dive.duration_s * random.uniform(0.25, 0.75);
      if (parameter.kind == ParameterKind::log_width)
        value = std::log(dive.duration_s * random.uniform(0.05, 0.15) / parameter.usual_width_s);
      if (parameter.kind == ParameterKind::marker_id)
        value = *(hidden.candidate.marker_id = ids[random.bits() % ids.size()]);
      if (parameter.kind == ParameterKind::time)
        value = *(hidden.candidate.time_s = dive.duration_s * random.uniform(0.25, 0.75));
    }
  if (effect.id == "flat-port-refraction")
    for (int i = 0; i < 2; ++i) {
      double& length = hidden.effects.values[effect.first_scalar + static_cast<std::size_t>(i)];
      length = std::abs(length);
    }
  if (hasPeak(effect)) hidden.candidate.peak = peakOf(hidden.effects, effect.index);
  if (effect.id == "water-current" && random.uniform() < 0.5) {
    hidden.candidate.active_s.from_s = dive.duration_s * random.uniform(0.1, 0.4);
    hidden.candidate.active_s.to_s =
        hidden.candidate.active_s.from_s + dive.duration_s * random.uniform(0.3, 0.5);
  }
  return hidden;
}

/// Nothing where it would have to be larger than anybody would hide.
std::optional<Hidden> effectOfSize(const EffectInfo& effect, const Dive& dive, double sqrt_lambda,
                                   Random& random) {
  const Hidden one = randomEffect(effect, dive, random);
  const double size = dive.resolution->sqrtLambda(one);
  if (!(size > 0)) return {};
  const Hidden hidden = scaled(one, sqrt_lambda / size);
  return isWithinLimits(hidden) ? std::optional(hidden) : std::nullopt;
}

nlohmann::json generatorEffect(const Hidden& hidden) {
  const EffectInfo& effect = allEffects()[hidden.candidate.effect];
  nlohmann::json parameters = parametersOf(hidden), made = nlohmann::json::object();
  for (const auto& [name, value] : parameters.items())
    if (isMade(effect.id, name)) made[name] = value;
  nlohmann::json active = nullptr;
  if (!(hidden.candidate.active_s == Interval{}))
    active = {hidden.candidate.active_s.from_s, hidden.candidate.active_s.to_s};
  return {{"id", effect.id}, {"parameters", made}, {"active_s", active}};
}

ProofCase::Effect describedEffect(const Hidden& hidden, const Resolution& resolution) {
  ProofCase::Effect described;
  described.id = allEffects()[hidden.candidate.effect].id;
  described.name = nameOf(hidden.candidate);
  described.sqrt_lambda = resolution.sqrtLambda(hidden);
  const std::vector<double> alignments = resolution.alignments(hidden);
  std::map<std::string, double> separations;  // by effect, the least
  for (std::size_t i = 0; i < alignments.size(); ++i) {
    const std::string id{allEffects()[resolution.rivals()[i].effect].id};
    if (id == described.id) continue;
    const double separation = std::pow(described.sqrt_lambda, 2) * (1 - alignments[i]);
    const auto [it, is_new] = separations.try_emplace(id, separation);
    it->second = std::min(it->second, separation);
  }
  described.nearest = std::numeric_limits<double>::infinity();
  for (const auto& [id, separation] : separations) {
    if (separation < kSeparable) described.inseparable.push_back(id);
    if (separation >= described.nearest) continue;
    described.nearest = separation;
    described.runner_up = id;
  }
  return described;
}

/// Lays the cases out, dive by dive in turn.
class Planner {
 public:
  Planner(const Extent& extent, const Programs& programs, fs::path folder)
      : extent_(extent), programs_(programs), folder_(std::move(folder)) {}

  std::vector<ProofCase> plan() {
    layOutDives();
    addEffects();
    addPairs();
    addNulls();
    addOutside();
    return std::move(cases_);
  }

 private:
  void layOutDives() {
    const auto add = [&](const auto& plans, std::size_t count, bool images) {
      for (std::size_t i = 0; i < count; ++i)
        dives_.push_back(diveOf(plans[i % plans.size()], images, extent_.first_seed + i));
    };
    add(kCornerDives, extent_.corner_dives, false);
    add(kImageDives, extent_.image_dives, true);
    forEachIndex(dives_.size(), "dives", [&](std::size_t i) {
      const std::string name = print("dive-%zu", i);
      dives_[i].resolution.emplace(
          inputOf(generatorCase(name, dives_[i], 1000 + i), programs_, folder_ / name));
    });
  }

  /// The next dive with images, or of corners.
  Dive& nextDive(bool images) {
    std::size_t& turn = turn_[images ? 1 : 0];
    const std::size_t count = images ? extent_.image_dives : extent_.corner_dives;
    return dives_[(images ? extent_.corner_dives : 0) + turn++ % count];
  }

  ProofCase& add(ProofCase::Kind kind, const std::string& name, const Dive& dive) {
    ProofCase c;
    c.kind = kind;
    c.name = name;
    c.generator = generatorCase(name, dive, extent_.first_seed * 100000 + cases_.size());
    cases_.push_back(c);
    return cases_.back();
  }

  void hide(const Hidden& hidden, const Dive& dive, ProofCase& c) {
    c.generator["effects"].push_back(generatorEffect(hidden));
    c.effects.push_back(describedEffect(hidden, *dive.resolution));
  }

  /// The first of the dives in turn on which the effect can have that size.
  std::optional<Hidden> sizedEffect(const EffectInfo& effect, double sqrt_lambda, Random& random,
                                    Dive*& dive) {
    const bool images = effect.text.channel == EffectChannel::image;
    for (std::size_t tries = 0; tries < 2 * dives_.size(); ++tries) {
      dive = &nextDive(images);
      if (!dive->resolution->canShow(effect.index)) continue;
      if (auto hidden = effectOfSize(effect, *dive, sqrt_lambda, random)) return hidden;
    }
    return {};
  }

  /// Of the Earth's rotation there is just one size.
  static bool hasSize(const EffectInfo& effect) { return effect.id != "earth-rotation"; }

  void addEffects() {
    for (const EffectInfo& effect : allEffects()) {
      if (!hasSize(effect) || effect.index % extent_.every != 0) continue;
      for (const double stratum : extent_.strata)
        for (std::size_t k = 0; k < extent_.each; ++k) {
          Random random =
              Random::stream(extent_.first_seed + k, 100 * effect.index + static_cast<std::size_t>(stratum));
          Dive* dive = nullptr;
          const std::optional<Hidden> hidden = sizedEffect(effect, stratum, random, dive);
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
      Dive& dive = nextDive(made % 2 == 1);
      std::vector<Hidden> both;
      for (int k = 0; k < 2; ++k) {
        const EffectInfo& effect = allEffects()[random.bits() % allEffects().size()];
        const bool again = !both.empty() && both[0].candidate.effect == effect.index;
        if (!hasSize(effect) || again || !dive.resolution->canShow(effect.index)) break;
        const auto hidden =
            effectOfSize(effect, dive, std::exp(random.uniform(std::log(10.0), std::log(32.0))), random);
        if (hidden) both.push_back(*hidden);
      }
      if (both.size() < 2) continue;
      ProofCase& c = add(ProofCase::Kind::pair, print("pair-%zu", made++), dive);
      c.stratum = 10;
      for (const Hidden& hidden : both) hide(hidden, dive, c);
    }
  }

  /// By a world richer than the model; three in five without images.
  void addNulls() {
    for (std::size_t i = 0; i < extent_.nulls; ++i) {
      ProofCase& c = add(ProofCase::Kind::null, print("null-%zu", i), nextDive(i % 5 >= 3));
      c.generator["rich"] = true;
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
                                         Outsider{"defocus", true, {0.25, 0.5, 1.0}},
                                         Outsider{"mount-shake", false, {0.02, 0.05, 0.2}},
                                         Outsider{"dvl-beam-bias", false, {0.005, 0.01, 0.03}}};

  void addOutside() {
    std::vector<const Dive*> dives;
    const std::size_t first = cases_.size();
    for (std::size_t i = 0; i < extent_.outside; ++i) {
      const Outsider& outsider = kOutsiders[i % kOutsiders.size()];
      const Dive& dive = nextDive(outsider.images);
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
          dives[i]->resolution->shownBy(inputOf(quiet, programs_, folder_ / c.name));
      c.lambda = shown.lambda;
      c.left = shown.left;
    });
  }

  const Extent& extent_;
  const Programs& programs_;
  fs::path folder_;
  std::vector<Dive> dives_;
  std::array<std::size_t, 2> turn_{};
  std::vector<ProofCase> cases_;
};

}  // namespace

Extent wholeProof() { return {}; }

Extent quickProof() {
  Extent quick;
  quick.corner_dives = 2;
  quick.image_dives = 1;
  quick.strata = {16};
  quick.every = 2;
  quick.pairs = 2;
  quick.nulls = 4;
  quick.outside = 2;
  return quick;
}

std::vector<ProofCase> planProof(const Extent& extent, const Programs& programs, const fs::path& folder) {
  return Planner(extent, programs, folder).plan();
}

}  // namespace fathom::proof
