#include "audit/checks.h"
#include "core/text.h"

namespace fathom {
namespace {
using enum Finding::Certainty;

// Readings that are equal to the last bit for so long, where those before and behind hardly ever are, are no
// measurements.
constexpr std::size_t kFewestRepeated = 20;
constexpr double kShortest_s = 5, kUsuallyRepeated = 0.05;

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// A pressure is of coarse steps and may be the same for long; an attitude that is constant is told by the
/// gyro. Nothing that moves is the same all the time.
double mostRepeated(const std::string& what) {
  if (what == "attitude") return 1;
  return what == "velocity" || what == "gyro" || what == "accelerometer" ? 0.5 : 0.999;
}

}  // namespace

void checkFrozen(const Streams& streams, std::vector<Finding>& findings) {
  for (const auto& [key, repeats] : streams.repeats) {
    const auto& [label, what] = key;
    const Instance instance = Instance::of(label);
    const std::string first_label = label.substr(0, label.find('.'));
    const Repeats::Run& run = repeats.longest;
    const std::size_t others = repeats.readings - run.repeated,
                      others_repeated = repeats.repeated - run.repeated;
    const double run_s = run.to_s - run.from_s;
    if (run.repeated >= kFewestRepeated && run_s > kShortest_s && others > kFewestRepeated &&
        share(others_repeated, others) < kUsuallyRepeated) {
      findings.push_back(finding(what + "-frozen", first_label, instance, sure,
                                 print("its %s is exactly the same for %.1f s from %.1f s on, %zu readings; "
                                       "elsewhere hardly two are alike",
                                       what.c_str(), run_s, run.from_s, run.repeated + 1)));
    } else if (repeats.readings > kFewestRepeated &&
               share(repeats.repeated, repeats.readings) > mostRepeated(what)) {
      findings.push_back(finding(what + "-repeated", first_label, instance, likely,
                                 print("%.0f %% of its readings of %s are exactly the one before",
                                       100 * share(repeats.repeated, repeats.readings), what.c_str())));
    }
  }
}

}  // namespace fathom
