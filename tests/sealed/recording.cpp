#include "recording.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/files.h"
#include "corners.h"
#include "depth_gauge.h"
#include "dive.h"
#include "doppler.h"
#include "images.h"
#include "inertial.h"
#include "panel_design.h"
#include "recording/rawlog.h"
#include "truth.h"
#include "vehicle.h"

namespace fathom::sealed {
namespace fs = std::filesystem;
namespace {

constexpr double kStart_s = 1710235800;  // 2024-03-12 09:30 UTC, of every recording
// Sensors do not tick together.
constexpr double kDvlPhase_s = 0.013, kDepthPhase_s = 0.037, kCameraPhase_s = 0.021;

/// A folder that is filled aside and renamed when whole.
class PendingFolder {
 public:
  explicit PendingFolder(fs::path target) : target_(std::move(target)), part_(target_) {
    part_ += ".part";
    std::error_code problem;
    if (fs::exists(target_)) throw Error(target_.string(), "", "is there already");
    fs::remove_all(part_, problem);
    fs::create_directories(part_, problem);
    if (problem) throw Error(target_.string(), "", "cannot be created: " + problem.message());
  }
  ~PendingFolder() {
    std::error_code ignored;
    fs::remove_all(part_, ignored);
  }
  PendingFolder(const PendingFolder&) = delete;
  PendingFolder& operator=(const PendingFolder&) = delete;

  const fs::path& path() const { return part_; }
  void commit() const {
    std::error_code problem;
    fs::rename(part_, target_, problem);
    if (problem) throw Error(target_.string(), "", "cannot be written: " + problem.message());
  }

 private:
  fs::path target_, part_;
};

std::vector<double> ticks_s(double rate_hz, double phase_s, double duration_s) {
  std::vector<double> times_s;
  for (int i = 0; phase_s + i / rate_hz <= duration_s; ++i) times_s.push_back(phase_s + i / rate_hz);
  return times_s;
}

CameraModel nominalCamera(const Camera& c) {
  return {c.width_px, c.height_px, c.fx_px, c.fy_px, c.cx_px, c.cy_px, c.k1, c.k2, c.p1, c.p2, c.k3};
}

std::vector<Sample> navigationSamples(const Vehicle& vehicle, const SealedCase& sealed, const Dive& dive,
                                      Time start) {
  std::vector<Sample> samples;
  const double duration_s = sealed.dive.duration_s;
  InertialUnit ins(vehicle, sealed, dive);
  for (const double t_s : ticks_s(vehicle.ins.rate_hz, 0, duration_s))
    samples.push_back({after(start, t_s), labels::kIns, ins.read(t_s)});
  DopplerLog dvl(vehicle, sealed, dive, kFloorDepth_m);
  for (const double t_s : ticks_s(vehicle.dvl.rate_hz, kDvlPhase_s, duration_s))
    samples.push_back({after(start, t_s), labels::kDvl, dvl.read(t_s)});
  PressureSensor depth(vehicle, sealed, dive);
  for (const double t_s : ticks_s(vehicle.depth.rate_hz, kDepthPhase_s, duration_s))
    samples.push_back({after(start, t_s), labels::kDepth, depth.read(t_s)});
  return samples;
}

void writeRawlog(const fs::path& file, const Vehicle& vehicle, std::vector<Sample> samples,
                 const std::vector<double>& image_stamps_s, Time start) {
  for (std::size_t i = 0; i < image_stamps_s.size(); ++i)
    samples.push_back({after(start, image_stamps_s[i]), labels::kCamera,
                       ImageSample{vehicle.camera.pose.pose(), recordedCamera(nominalCamera(vehicle.camera)),
                                   imageName(i)}});
  std::stable_sort(samples.begin(), samples.end(),
                   [](const Sample& a, const Sample& b) { return a.time < b.time; });
  RawlogWriter writer(file, {"panel.yaml", "vehicle.yaml", ""}, start);
  for (const Sample& sample : samples) writer.write(sample);
  writer.finish();
}

void requireMarker(const SealedCase& sealed, const PanelMap& map) {
  for (const HiddenEffect& effect : sealed.effects) {
    if (!effect.parameters.contains("marker_id")) continue;
    const double id = effect.parameters.find("marker_id")->second.front();
    if (std::none_of(map.markers.begin(), map.markers.end(), [&](const Marker& m) { return m.id == id; }))
      throw Error(sealed.name, "effects." + effect.id + ".marker_id", "no such marker on the panel");
  }
}

}  // namespace

void sealRecording(const SealedCase& sealed, const fs::path& out, const fs::path& truth) {
  const PendingFolder recording(out), answer(truth);
  Vehicle vehicle;
  vehicle.camera.rate_hz = sealed.dive.image_rate_hz;
  writeTextFile(recording.path() / "vehicle.yaml", vehicleYaml(vehicle));
  writePanel(recording.path(), sealed.dive.panel_with_squares);
  const TruePanel panel(readPanelMap(recording.path() / "panel.yaml"), sealed);
  requireMarker(sealed, panel.map());

  const Dive dive = makeDive(sealed.dive, panel.map().T_odom_panel.position);
  const Viewpoint viewpoint(vehicle, sealed, dive);
  const Time start = fromUnixSeconds(kStart_s);
  const auto stamps_s = ticks_s(vehicle.camera.rate_hz, kCameraPhase_s, sealed.dive.duration_s);
  writeRawlog(recording.path() / "recording.rawlog", vehicle, navigationSamples(vehicle, sealed, dive, start),
              stamps_s, start);
  if (sealed.dive.images)
    writeImages(recording.path() / "recording_Images", ImageMaker(vehicle, sealed, panel, viewpoint),
                stamps_s);
  else
    writeTextFile(recording.path() / "recording_corners.csv",
                  cornersTable(vehicle, sealed, panel, viewpoint, stamps_s));
  writeTruth(answer.path(), recording.path(), sealed, dive, start);
  recording.commit();
  answer.commit();
}

}  // namespace fathom::sealed
