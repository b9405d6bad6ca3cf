#include "advised.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "diagnosis/manoeuvre.h"
#include "recording/rawlog.h"
#include "recording/tum.h"

namespace fathom::proof {
namespace fs = std::filesystem;
namespace {

constexpr double kRest_s = 4, kAfterwards_s = 1, kPathRate_hz = 20;

const Manoeuvre& manoeuvreCalled(const std::string& text) {
  const auto found = std::find_if(manoeuvres().begin(), manoeuvres().end(),
                                  [&](const Manoeuvre& manoeuvre) { return manoeuvre.text == text; });
  if (found == manoeuvres().end()) throw Error("advice", text, "is no manoeuvre of the library");
  return *found;
}

/// The pose nearest in time.
Pose poseNearest(const std::vector<StampedPose>& path, Time time) {
  const auto off_s = [&](const StampedPose& pose) { return std::abs(secondsBetween(pose.time, time)); };
  return std::min_element(path.begin(), path.end(),
                          [&](const StampedPose& a, const StampedPose& b) { return off_s(a) < off_s(b); })
      ->T_odom_robot;
}

}  // namespace

std::optional<Advised> adviceIn(const Scored& scored, const nlohmann::json& answer) {
  const nlohmann::json& hidden = scored.proof_case.generator.at("effects");
  const bool is_set = scored.outcome == Outcome::right_set || scored.outcome == Outcome::needless_set;
  if (!is_set || hidden.size() != 1 || isTimed(hidden[0])) return {};
  for (const nlohmann::json& set : answer.at("diagnosis").at("alternatives"))
    if (const nlohmann::json& advice = set.at("advice"); !advice.is_null())
      return Advised{.manoeuvre = advice.at("manoeuvre"),
                     .minutes = advice.at("minutes"),
                     .from_s = advice.at("from_s")};
  return {};
}

nlohmann::json advisedCase(const ProofCase& proof_case, const Advised& advised, const fs::path& recording,
                           const fs::path& answer, const fs::path& path) {
  const Manoeuvre& manoeuvre = manoeuvreCalled(advised.manoeuvre);
  const Time start = RawlogReader(recording / "recording.rawlog").next()->time;
  const Pose station =
      stationAt(poseNearest(readTum(answer / "trajectory.tum"), after(start, advised.from_s)));
  std::vector<StampedPose> poses;
  const double manoeuvre_s = advised.minutes * Manoeuvre::kDuration_s, duration_s = kRest_s + manoeuvre_s;
  for (int i = 0; i <= (duration_s + kAfterwards_s) * kPathRate_hz; ++i) {
    const double t_s = i / kPathRate_hz;
    poses.push_back({fromUnixSeconds(t_s),
                     station * manoeuvre.T_station_robot(std::clamp(t_s - kRest_s, 0.0, manoeuvre_s))});
  }
  writeTum(path, poses);
  nlohmann::json other = proof_case.generator;
  other["dive"]["manoeuvre"] = "given";
  other["dive"]["path"] = path.filename().string();
  other["dive"]["duration_s"] = duration_s;
  other["seed"] = other["seed"].get<std::uint64_t>() + 2;
  return other;
}

}  // namespace fathom::proof
