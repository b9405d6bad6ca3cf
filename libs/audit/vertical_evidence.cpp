#include "audit/vertical_evidence.h"

#include <algorithm>
#include <cmath>

#include "audit/water_column.h"

namespace fathom {
namespace {

/// Up in robot axes at one time: the mean specific force over a second or so about it.
class UpAt {
 public:
  UpAt(const InsStream& ins, const Matrix3d& axes)
      : ins_(ins), R_robot_ins_(ins.T_robot_ins.rotation * axes) {}

  /// Times must not decrease.
  Vector3d operator()(double t_s) {
    const auto& w = ins_.windows;
    while (next_ + 1 < w.size() && w[next_ + 1].t_s <= t_s) ++next_;
    Vector3d force = Vector3d::Zero();
    const std::size_t from = next_ >= kHalf ? next_ - kHalf : 0, to = std::min(w.size(), next_ + kHalf + 1);
    for (std::size_t i = from; i < to; ++i) force += w[i].force;
    return R_robot_ins_ * force.normalized();
  }

 private:
  static constexpr std::size_t kHalf = 8;
  const InsStream& ins_;
  const Matrix3d R_robot_ins_;
  std::size_t next_ = 0;
};

/// A way up, integrated, with the gaps on it so far: across one nothing is known.
struct WayUp {
  double m = 0;
  int gaps = 0;
};

std::vector<Timed<WayUp>> wayUpByDvl(const DvlStream& dvl, const InsStream& ins, const Matrix3d& dvl_axes,
                                     const Matrix3d& ins_axes) {
  const Matrix3d R_robot_dvl = dvl.T_robot_dvl.rotation * dvl_axes;
  constexpr double kGap_s = 1;
  std::vector<Timed<WayUp>> way;
  UpAt up(ins, ins_axes);
  WayUp now;
  for (const auto& [t_s, velocity] : dvl.velocities) {
    const double seconds = way.empty() ? 0 : t_s - way.back().t_s;
    if (seconds > kGap_s)
      ++now.gaps;
    else
      now.m += up(t_s).dot(R_robot_dvl * velocity) * seconds;
    way.push_back({t_s, now});
  }
  return way;
}

}  // namespace

Regression verticalEvidence(const Streams& streams, const DepthStream& depth, const Vehicle& vehicle,
                            const std::vector<Finding>& findings) {
  if (streams.dvl.empty() || streams.ins.empty() ||
      hasFinding(findings, Ins::label, streams.ins.begin()->first) ||
      hasFinding(findings, Dvl::label, streams.dvl.begin()->first))
    return {};
  return verticalEvidence(streams.dvl.begin()->second, streams.ins.begin()->second, depth, vehicle);
}

Regression verticalEvidence(const DvlStream& dvl, const InsStream& ins, const DepthStream& depth,
                            const Vehicle& vehicle, const Matrix3d& dvl_axes, const Matrix3d& ins_axes) {
  Regression evidence;
  if (ins.windows.empty()) return evidence;
  const auto way = wayUpByDvl(dvl, ins, dvl_axes, ins_axes);
  const auto firstFrom = [&](double t_s) {
    return std::lower_bound(way.begin(), way.end(), t_s, [](const auto& a, double t) { return a.t_s < t; });
  };
  const auto& p = depth.pressures;
  std::size_t from = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (p[i].t_s - p[from].t_s < kVerticalStep_s) continue;
    const auto before = firstFrom(p[from].t_s), behind = firstFrom(p[i].t_s);
    if (behind != way.end() && p[i].t_s - p[from].t_s < 2 * kVerticalStep_s &&
        before->value.gaps == behind->value.gaps)
      evidence.add(behind->value.m - before->value.m,
                   depthOf(p[from].value, vehicle, {}) - depthOf(p[i].value, vehicle, {}));
    from = i;
  }
  return evidence;
}

}  // namespace fathom
