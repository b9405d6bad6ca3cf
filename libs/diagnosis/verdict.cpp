#include "diagnosis/verdict.h"

#include <algorithm>
#include <cmath>

#include "core/text.h"
#include "effects/catalogue.h"

namespace fathom {
namespace {

constexpr double kUnexplained_p = 0.01;
constexpr double kDetectable = 18;   // information times prior variance: 5 % over the catalogue, power 90 %
constexpr double kLeastShare = 0.2;  // of the catalogue to be within reach, for "none" to mean something
// Seen at usual angles either shifts corners alike.
constexpr MarkerScatter kMaterialScatter{.in_face_m = 0.001, .off_face_m = 0.00175, .tilted_m = 0.002};
constexpr double kNoisier = 1.5, kQuieter = 0.5;  // than stated, worth a remark
constexpr std::size_t kToldFailures = 3;

/// "dvl-scale (DVL scale): scale = 0.01 ± 0.0004; its size is …".
std::string sentence(const FoundEffect& found) {
  const EffectInfo& effect = allEffects()[found.candidate.effect];
  std::string text = nameOf(found.candidate) + " (" + std::string(effect.text.title) + "): ";
  std::size_t scalar = effect.first_scalar;
  std::string separator;
  for (const Parameter& p : effect.parameters) {
    for (int i = 0; i < p.size; ++i, ++scalar)
      for (const EffectEstimate& estimate : found.estimates)
        if (estimate.scalar == scalar) {
          const std::string axis = p.size > 1 ? print("[%d]", i) : "";
          text +=
              separator + print("%s%s = %.4g ± %.2g", std::string(p.name).c_str(), axis.c_str(),
                                asNamed(p, estimate.value), sigmaAsNamed(p, estimate.value, estimate.sigma));
          separator = ", ";
        }
  }
  return text + print("; its size is %.1f times what the recording can resolve", found.sqrt_lambda);
}

void remarkOnNoise(Diagnosis& diagnosis) {
  for (const Channel channel : kEveryChannel)
    if (const ChannelNoise& noise = diagnosis.noise.of(channel);
        noise.rows > 0 && channel != kChannel<Prior> && (noise.scale > kNoisier || noise.scale < kQuieter))
      diagnosis.remarks.push_back(
          print("%s: %.2f times the noise stated", nameOf(channel).c_str(), noise.scale));
}

/// Everything by which the model with the effects found is still not adequate.
std::vector<std::string> failuresOf(const Diagnosis& diagnosis) {
  std::vector<std::string> failures;
  for (const Mismatch& map : diagnosis.remaining)
    if (map.material && map.log_p < std::log(kUnexplained_p))
      failures.push_back(print("%s of %s against %s (%s: %.1f sigma, %.2g %s in all)", map.statistic.c_str(),
                               nameOf(map.channel).c_str(), map.against.c_str(), map.where.c_str(),
                               map.size_sigma, map.size_raw, map.raw_unit.c_str()));
  for (const FoundEffect& found : diagnosis.effects)
    for (const InteractionTest& test : found.interactions)
      if (test.failed)
        failures.push_back(
            print("%s would have to change with %s, by %.0f %% over one standard deviation of it",
                  nameOf(found.candidate).c_str(), test.against.c_str(), 100 * test.relative_change));
  const MarkerScatter& scatter = diagnosis.noise.markers;
  if (scatter.in_face_m > kMaterialScatter.in_face_m || scatter.off_face_m > kMaterialScatter.off_face_m)
    failures.push_back(print("markers lie %.1f mm off the map, one by one", 1e3 * scatter.largest_m()));
  return failures;
}

void judgeUnexplained(Diagnosis& diagnosis, const std::vector<std::string>& failures,
                      const EffectParameters<double>& known) {
  diagnosis.verdict = Verdict::unexplained;
  diagnosis.why =
      "Something is missing that no effect of the catalogue describes. It shows as " + failures[0];
  for (std::size_t i = 1; i < std::min(kToldFailures, failures.size()); ++i)
    diagnosis.why += "; " + failures[i];
  diagnosis.why += ".";
  if (diagnosis.effects.empty()) return;
  diagnosis.why += " What comes nearest is " + sentence(diagnosis.effects[0]) + ".";
  diagnosis.nearest = std::move(diagnosis.effects);
  diagnosis.effects.clear();
  diagnosis.calibration = known;
}

void judgeExplained(Diagnosis& diagnosis) {
  diagnosis.verdict = Verdict::explained;
  diagnosis.why = "The model leaves out ";
  for (std::size_t i = 0; i < diagnosis.effects.size(); ++i)
    diagnosis.why += (i > 0 ? "; and " : "") + sentence(diagnosis.effects[i]);
  diagnosis.why += ".";
  for (const Alternatives& set : diagnosis.alternatives) {
    diagnosis.why += " As good in place of " + nameOf(set.candidates[0]) + ":";
    for (std::size_t i = 1; i < set.candidates.size(); ++i)
      diagnosis.why += (i > 1 ? ", " : " ") + nameOf(set.candidates[i]);
    diagnosis.why += ". This recording cannot choose among them.";
    if (!set.advice.manoeuvre.empty()) diagnosis.why += " To tell them apart: " + textOf(set.advice) + ".";
  }
}

/// Whether a usual size of a candidate, its prior sigma, would have shown in the recording.
bool isWithinReach(const TestedCandidate& tested, const Linearization& nominal) {
  return std::any_of(tested.one_step.begin(), tested.one_step.end(), [&](const EffectEstimate& one) {
    for (const EffectColumn& column : nominal.columns)
      if (column.scalar == one.scalar)
        return one.sigma > 0 && std::pow(column.prior_sigma / one.sigma, 2) > kDetectable;
    return false;
  });
}

void judgeNothingFound(Diagnosis& diagnosis, const Linearization& nominal) {
  const auto within_reach = static_cast<std::size_t>(
      std::count_if(diagnosis.tested.begin(), diagnosis.tested.end(),
                    [&](const TestedCandidate& tested) { return isWithinReach(tested, nominal); }));
  if (static_cast<double>(within_reach) < kLeastShare * static_cast<double>(diagnosis.tested.size())) {
    diagnosis.verdict = Verdict::insufficient;
    diagnosis.why = print("Nothing shows, but of %zu things tried only %zu would have shown at a usual size.",
                          diagnosis.tested.size(), within_reach);
    return;
  }
  diagnosis.verdict = Verdict::none;
  diagnosis.why = print("Nothing material is missing: of %zu things tried the most telling, %s, would ",
                        diagnosis.tested.size(), diagnosis.most_improbable.c_str());
  diagnosis.why += diagnosis.is_within_bias
                       ? "move readings by less than they are off in any recording."
                       : print("be seen by chance with probability %.2g.", diagnosis.alarm_p);
}

}  // namespace

void judge(Diagnosis& diagnosis, const Linearization& nominal, const EffectParameters<double>& known) {
  remarkOnNoise(diagnosis);
  const std::vector<std::string> failures = failuresOf(diagnosis);
  if (!failures.empty())
    judgeUnexplained(diagnosis, failures, known);
  else if (!diagnosis.effects.empty())
    judgeExplained(diagnosis);
  else
    judgeNothingFound(diagnosis, nominal);
}

}  // namespace fathom
