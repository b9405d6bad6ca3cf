#include "localization/lost_monitor.h"

#include <cmath>

#include "core/text.h"

namespace fathom {
namespace {

using Tells = ChannelText::Tells;

/// A contradiction stays until such a sensor agrees again, even when it falls silent.
bool isAbsolute(Channel channel) { return textOf(channel).tells == Tells::position; }

bool tellsMotion(Channel channel) { return textOf(channel).tells != Tells::nothing; }

}  // namespace

void LostMonitor::start(double t_s) { last_seeing_s_ = t_s; }

void LostMonitor::reading(double t_s, Channel channel, bool fused, bool contradicts) {
  if (fused && tellsMotion(channel)) last_seeing_s_ = t_s;
  if (textOf(channel).is_indirect) return;
  Contradiction& c = channels_[indexOf(channel)];
  // From nothing the average reaches kMost in contradiction_s. Rare readings do not count for more than a
  // fifth of it, so that it takes several.
  const double dt = c.any ? std::min(t_s - c.last_s, options_.contradiction_s / 5.0) : 0.0;
  if (contradicts || c.share > 0.0)
    c.share +=
        (1.0 - std::pow(1.0 - kMost, dt / options_.contradiction_s)) * ((contradicts ? 1.0 : 0.0) - c.share);
  if (c.share < 1e-3 && !contradicts) c.share = 0.0;
  c.last_s = t_s;
  c.any = true;
  // What follows a contradiction is relied on again when most readings agree.
  c.lost = c.share > kMost || (c.lost && c.share > 1.0 - kMost);
}

void LostMonitor::corrected(double t_s) { corrections_s_.push_back(t_s); }

std::optional<std::string> LostMonitor::judge(double t_s, double position_sigma_m, double angle_sigma_rad,
                                              bool is_turned, bool is_in_doubt) {
  // Half the limit is asked for before the estimate counts again: no flicker.
  const double limit = unsure_ ? 0.5 : 1.0;
  unsure_ = !(position_sigma_m <= limit * options_.position_sigma_m) ||
            !(angle_sigma_rad <= limit * options_.angle_sigma_rad);
  while (!corrections_s_.empty() && t_s - corrections_s_.front() > kCorrected_s) corrections_s_.pop_front();

  if (is_turned) return "positions are told, but not the heading, and the path is too short to tell it";
  if (is_in_doubt) return "the first fixes contradict each other";
  if (unsure_)
    return print("the position's own sigma is %.2f m, the orientation's %.1f deg", position_sigma_m,
                 degrees(angle_sigma_rad));
  if (t_s - last_seeing_s_ > options_.blind_s)
    return print("neither DVL nor landmark nor USBL for %.1f s", t_s - last_seeing_s_);
  for (const Channel channel : kEveryChannel) {
    const Contradiction& c = channels_[indexOf(channel)];
    if (c.lost && (isAbsolute(channel) || t_s - c.last_s <= options_.blind_s))
      return print("%s has contradicted the filter for %.1f s or more", nameOf(channel).c_str(),
                   options_.contradiction_s);
  }
  if (corrections_s_.size() >= kCorrections)
    return print("landmarks had to correct the filter %zu times within %.0f s: another sensor is wrong",
                 corrections_s_.size(), kCorrected_s);
  return std::nullopt;
}

}  // namespace fathom
