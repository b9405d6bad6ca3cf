#include "audit/audit.h"

#include <algorithm>

#include "audit/checks.h"
#include "audit/corrected_samples.h"
#include "core/error.h"

namespace fathom {

std::string toText(const Finding& finding) {
  std::string text = finding.label + ": " + finding.what;
  text += finding.certainty == Finding::Certainty::sure ? " (sure: " : " (likely: ";
  text += finding.name + ")";
  if (!finding.correction.empty())
    text += "; --correct " + finding.correction + " makes it " + finding.corrected;
  return text;
}

Finding finding(const std::string& name, std::string_view label, const Instance& instance,
                Finding::Certainty certainty, std::string what) {
  return {instance.label(name), instance.label(label), certainty, std::move(what), {}, {}};
}

Finding correctable(Finding found, std::string corrected, const std::string& axes) {
  found.corrected = std::move(corrected);
  found.correction = axes.empty() ? found.name : found.name + ":" + axes;
  return found;
}

bool hasFinding(const std::vector<Finding>& findings, std::string_view label, const Instance& instance) {
  return std::any_of(findings.begin(), findings.end(),
                     [&](const Finding& f) { return f.label == instance.label(label); });
}

bool isFound(const std::vector<Finding>& findings, std::string_view name, const Instance& instance) {
  return std::any_of(findings.begin(), findings.end(),
                     [&](const Finding& f) { return f.name == instance.label(name); });
}

std::vector<Finding> audit(const Streams& streams, const Vehicle& vehicle,
                           const std::filesystem::path& image_folder) {
  std::vector<Finding> findings;
  checkClocks(streams, vehicle, findings);
  const bool clocks_agree = std::none_of(findings.begin(), findings.end(), [](const Finding& f) {
    return f.certainty == Finding::Certainty::sure || f.name.starts_with("clock-offset");
  });
  if (clocks_agree) {  // else nothing can be compared
    std::vector<Finding> compared;
    checkFrozen(streams, compared);
    checkIns(streams, vehicle, compared);
    checkDepth(streams, vehicle, compared);
    checkAgreement(streams, vehicle, findings.empty(), compared);
    checkLimits(streams, vehicle, compared);
    findings.insert(findings.begin(), compared.begin(), compared.end());
  }
  if (!image_folder.empty()) checkImages(streams, image_folder, findings);
  return findings;
}

std::vector<Finding> audit(SampleSource& source, const Vehicle& vehicle) {
  Streams streams;
  while (const auto sample = source.next()) streams.add(*sample);
  return audit(streams, vehicle, source.imageFolder());
}

std::unique_ptr<SampleSource> corrected(std::unique_ptr<SampleSource> source, const AuditChoice& choice,
                                        const Vehicle& vehicle) {
  if (choice.correct.empty()) return source;
  return std::make_unique<CorrectedSource>(std::move(source), correctionsNamed(choice.correct), vehicle);
}

namespace {

/// What else was found, by name.
std::string others(const std::vector<Finding>& findings, const Finding& told) {
  std::string text;
  for (const Finding& f : findings)
    if (f.name != told.name) text += (text.empty() ? " (found too: " : ", ") + f.name;
  return text.empty() ? text : text + ")";
}

}  // namespace

Plausibility requirePlausible(const std::vector<Finding>& findings, const AuditChoice& choice,
                              const std::filesystem::path& recording) {
  for (const std::string& name : choice.accept) {
    if (std::any_of(findings.begin(), findings.end(), [&](const Finding& f) { return f.name == name; }))
      continue;
    std::string there;
    for (const Finding& f : findings) there += (there.empty() ? "" : ", ") + f.name;
    throw Error("--accept", name,
                "nothing of that name was found in " + recording.string() +
                    "; found: " + (there.empty() ? "nothing" : there));
  }
  Plausibility plausibility;
  for (const Finding& f : findings) {
    const bool sure = f.certainty == Finding::Certainty::sure;
    const bool accepted =
        std::find(choice.accept.begin(), choice.accept.end(), f.name) != choice.accept.end();
    if (sure && !accepted)
      throw Error(recording.string(), "",
                  toText(f) + "; --accept " + f.name + " takes it as it is" + others(findings, f));
    plausibility.remarks.push_back(toText(f) + (accepted ? "; accepted" : ""));
    if (sure) plausibility.accepted.push_back(f.name);
  }
  for (const std::string& correction : choice.correct)
    plausibility.remarks.push_back("corrected, as asked: " + correction);
  return plausibility;
}

}  // namespace fathom
