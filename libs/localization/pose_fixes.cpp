#include "localization/pose_fixes.h"

#include <cmath>

#include "localization/seen.h"
#include "recording/instrument_entries.h"

namespace fathom {
namespace {

constexpr FrameCoordinates kWholePose{true, true, true};

void addPanels(const LocalizationSetup& setup, const PanelSample& sample, double t_s,
               std::vector<PoseFix>& fixes) {
  for (const SeenPanel& seen : sample.panels) {
    if (seen.panel < 0 || static_cast<std::size_t>(seen.panel) >= setup.panels.size()) continue;
    const PanelPrior& panel = setup.panels[static_cast<std::size_t>(seen.panel)];
    if (!panel.isKnown()) continue;
    Vector6d sigma;
    sigma << Vector3d::Constant(panel.position_sigma_m), Vector3d::Constant(panel.angle_sigma_rad);
    const UncertainPose T_panel_robot = (sample.T_robot_camera * seen.T_camera_panel).inverse();
    const auto [pose, by_panel, by_sighting] = composed(panel.T_odom_panel, T_panel_robot.pose);
    const Matrix6d covariance = by_panel * sigma.cwiseAbs2().asDiagonal() * by_panel.transpose() +
                                by_sighting * T_panel_robot.covariance * by_sighting.transpose();
    fixes.push_back({t_s, "panel " + panel.name, kChannel<Landmark>, kWholePose, {pose, covariance}});
  }
}

/// Of any of an instrument's channels.
template <class Predicate>
bool anyStart(const Sample& sample, Predicate&& predicate) {
  bool any = false;
  withInstrument(sample, [&]<class Instrument>(const auto&, const Instance&) {
    [&]<class... Channels>(std::tuple<Channels...>*) {
      any = (predicate(Channels::channel.start) || ...);
    }(static_cast<typename Instrument::Channels*>(nullptr));
  });
  return any;
}

bool tellsPose(ChannelText::Start start) {
  return start == ChannelText::Start::position || start == ChannelText::Start::height;
}

/// The filter's own pose where the reading tells nothing.
void addReadings(const LocalizationSetup& setup, const Sample& sample, double t_s,
                 const KinematicState<double>& state, std::vector<PoseFix>& fixes) {
  constexpr double kHeight_m = 0.1;  // a pressure's: the air's, which changes by that much
  forEachSeen(setup, {sample}, state, [&](const Seen& seen) {
    const auto start = textOf(seen.channel).start;
    if (!tellsPose(start)) return;
    UncertainPose T_odom_robot{{state.R_odom_robot, state.position_odom}};
    const bool whole = start == ChannelText::Start::position;
    const Vector3d position =
        seen.where([](Inputs<double>& in, const Vector3d& p) { in.state.position_odom = p; }, whole ? 0 : 2);
    if (whole) {
      T_odom_robot.pose.position = position;
      T_odom_robot.covariance.topLeftCorner<3, 3>() = seen.observation.covariance;
    } else {
      T_odom_robot.pose.position.z() = position.z();
      T_odom_robot.covariance(2, 2) = kHeight_m * kHeight_m;
    }
    fixes.push_back(
        {t_s, std::string(textOf(seen.channel).label), seen.channel, {whole, true, false}, T_odom_robot});
  });
}

}  // namespace

bool tellsPosition(const Sample& sample) {
  return std::holds_alternative<PanelSample>(sample.reading) || baseOf(sample.label) == labels::kMarkers ||
         anyStart(sample, [](ChannelText::Start start) { return start == ChannelText::Start::position; });
}

UncertainPose markersPose(const LocalizationSetup& setup, const PoseSample& markers) {
  const LandmarkOptions& options = setup.options.landmarks;
  Vector6d sigma;
  sigma << Vector3d::Constant(options.position_sigma_m), Vector3d::Constant(options.angle_sigma_rad);
  return {markers.T_odom_robot.mean, sigma.cwiseAbs2().asDiagonal()};
}

std::vector<PoseFix> poseFixes(const LocalizationSetup& setup, const Sample& sample, double t_s,
                               const KinematicState<double>& state) {
  std::vector<PoseFix> fixes;
  if (const auto* panels = std::get_if<PanelSample>(&sample.reading))
    addPanels(setup, *panels, t_s, fixes);
  else if (const auto* pose = std::get_if<PoseSample>(&sample.reading);
           pose && baseOf(sample.label) == labels::kMarkers)
    fixes.push_back({t_s, "markers", kChannel<Landmark>, kWholePose, markersPose(setup, *pose)});
  else if (anyStart(sample, tellsPose))  // few readings do
    addReadings(setup, sample, t_s, state, fixes);
  return fixes;
}

}  // namespace fathom
