#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <vector>

#include "estimation/batch_data.h"
#include "estimation/motion.h"
#include "estimation/readings.h"

/// What a batch estimate finds, as numbers, and where it starts from.
namespace fathom {

/// What is drawn of an effect's spread for one image.
struct Draw {
  std::size_t scalar = 0;  ///< in EffectParameters::values
  std::size_t image = 0;   ///< see ImagePatch
  friend auto operator<=>(const Draw&, const Draw&) = default;
};

/// What a channel of one instrument is off by (Drift), own unit.
struct DriftTrack {
  Channel channel{};
  Instance instance{};
  /// At path.begin_s + k drift_interval_s, linear between; of what is constant, one.
  std::vector<Observation::Value> knots;
};

/// By what a patch's light differs from the model's for no effect's sake, as something else has found: ln of
/// a factor for each colour.
struct PatchLight {
  Vector3d reflected = Vector3d::Zero();  ///< of its albedo under daylight
  Vector3d level = Vector3d::Zero();      ///< of all that it reads
  Vector3d moved = Vector3d::Zero();      ///< no factor: what poses are elsewhere for changes, radiance

  Eigen::Array3d ofAlbedo() const { return reflected.array().exp(); }
  Eigen::Array3d ofReading() const { return level.array().exp(); }
};

/// What is estimated, as numbers.
struct BatchState {
  PosePath path;
  std::vector<std::size_t> images;  ///< of poses by themselves: number of each one's image
  std::vector<DriftTrack> drifts;   ///< by channel, then by instance
  double drift_interval_s = 10.0;
  std::vector<Pose> T_odom_panel;
  Pose T_left_right;                  ///< of a pair of cameras that sees tie points
  Vector9d water = Vector9d::Zero();  ///< waterParameters(), where there are patches
  Flaws flaws = Flaws::Zero();        ///< of images, see ImageFlaw
  double sea_floor_z_m = 0.0;         ///< odom, where a sensor ranges it
  EffectParameters<double> effects;   ///< all that are on, estimated or not
  std::map<Draw, double> draws;       ///< of effects that are drawn anew for each image; missing: 0
  /// Of each of the data's patches; empty: nothing. Predictions have it, and linearize() puts it back into
  /// residuals: these are the nominal light's, but linear about what the light is.
  std::vector<PatchLight> light;

  /// In `drifts`; nothing of what does not drift.
  std::optional<std::size_t> driftOf(Channel channel, const Instance& instance) const;
  double drawn(const Draw& draw) const {
    const auto found = draws.find(draw);
    return found == draws.end() ? 0.0 : found->second;
  }
};

/// An effect's continuous scalars, by their place in EffectParameters::values: those that are estimated.
std::vector<std::size_t> continuousScalars(std::size_t effect);

/// Of the knot interval in which the recording begins: from when to when the INS is averaged, by its stamps.
double gridBegin_s(const BatchData& data);

/// The effect that knots follow: the INS's latency, where all of its readings have it as long as they last. A
/// path's knots are where these begin and end, whatever their latency: what of their noise a path can follow
/// depends on where its knots are, and two explanations that differ by a shift of the INS alone would be told
/// apart by noise. Null: none.
std::optional<std::size_t> knotEffect(const EffectParameters<double>& effects);
/// By how much knots are earlier than the INS's stamps; 0 where they follow none.
double knotLatency_s(const EffectParameters<double>& effects);
/// Has the whole path follow the effects, of which knots followed these before: what it is by the INS's clock
/// stays.
void moveKnots(const EffectParameters<double>& before, BatchState& state);

/// The first state of a problem: a spline near a path, or a pose an image. Images without one are left out.
BatchState startState(const BatchData& data, const std::vector<double>& times_s,
                      const std::vector<Pose>& T_odom_robot, const EffectParameters<double>& effects,
                      double drift_interval_s);

}  // namespace fathom
