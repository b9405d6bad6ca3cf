#include "estimation/batch_data.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "estimation/tie_point_gate.h"
#include "landmarks/image_entry.h"
#include "localization/input_watch.h"

namespace fathom {
namespace {

/// A vector or an attitude at a time, before it is averaged.
struct InsReading {
  double t_s = 0;
  Vector3d vector = Vector3d::Zero();
  Matrix3d R_odom_ins = Matrix3d::Identity();
  Pose T_robot_ins;
};
using InsReadings = std::vector<InsReading>;

InsBin binOf(InsReadings::const_iterator begin, InsReadings::const_iterator end) {
  InsBin bin;
  bin.samples = static_cast<int>(end - begin);
  bin.about = (begin + bin.samples / 2)->R_odom_ins;
  bin.T_robot_ins = begin->T_robot_ins;
  double mean_s = 0, variance_s2 = 0;
  for (auto it = begin; it != end; ++it) {
    mean_s += it->t_s / bin.samples;
    bin.mean += (it->vector + logSO3<double>(bin.about.transpose() * it->R_odom_ins)) / bin.samples;
  }
  for (auto it = begin; it != end; ++it) variance_s2 += std::pow(it->t_s - mean_s, 2) / bin.samples;
  const double sigma_s = std::sqrt(variance_s2);
  bin.node_s = {mean_s - sigma_s, mean_s + sigma_s};
  return bin;
}

std::vector<InsBin> bins(InsReadings& readings, double knot_s) {
  std::stable_sort(readings.begin(), readings.end(),
                   [](const InsReading& a, const InsReading& b) { return a.t_s < b.t_s; });
  const auto intervalOf = [&](const InsReading& r) { return std::floor(r.t_s / knot_s + 1e-6); };
  std::vector<InsBin> result;
  for (auto begin = readings.cbegin(); begin != readings.cend();) {
    const auto end = std::find_if(begin, readings.cend(),
                                  [&](const InsReading& r) { return intervalOf(r) != intervalOf(*begin); });
    result.push_back(binOf(begin, end));
    begin = end;
  }
  return result;
}

class Collector {
 public:
  Collector(BatchData& data, const Detections& detections, const TiePoints& tie_points,
            const std::filesystem::path& image_folder)
      : data_(data), detections_(detections), tie_points_(tie_points), image_folder_(image_folder) {}

  void add(const Sample& sample) {
    if (!any_) data_.time_zero = sample.time;
    any_ = true;
    t_s_ = secondsBetween(data_.time_zero, sample.time);
    if (isImage(sample)) return addImage(*imageEntry(sample, image_folder_));
    if (!watch_.accept(sample, t_s_)) return;
    if (const auto* ins = std::get_if<InsSample>(&sample.reading)) addIns(*ins);
    if (const auto* dvl = std::get_if<DvlSample>(&sample.reading)) addDvl(*dvl);
    if (const auto* depth = std::get_if<DepthSample>(&sample.reading); depth && data_.vehicle.depth)
      data_.pressure.push_back({t_s_, depth->pressure_pa, depth->T_robot_depth});
    if (const auto* pose = std::get_if<PoseSample>(&sample.reading); pose && sample.label == labels::kUsbl)
      addUsbl(*pose);
  }

  void finish() {
    data_.gyro = bins(gyro_, data_.knot_s);
    data_.force = bins(force_, data_.knot_s);
    data_.attitude = bins(attitude_, data_.knot_s);
    double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s;
    const auto reach = [&](double t_s) {
      first_s = std::min(first_s, t_s);
      last_s = std::max(last_s, t_s);
    };
    for (const auto* readings : {&gyro_, &force_, &attitude_})
      for (const InsReading& r : *readings) reach(r.t_s);
    for (const BatchDvl& d : data_.dvl) reach(d.t_s);
    for (const BatchMarker& m : data_.markers) reach(m.t_s);
    for (const BatchTiePoint& p : data_.tie_points) reach(p.t_s);
    if (data_.hasMotion()) {
      for (const BatchPressure& p : data_.pressure) reach(p.t_s);
      for (const BatchUsbl& u : data_.usbl) reach(u.t_s);
    }
    data_.first_s = first_s;
    data_.last_s = last_s;
  }

 private:
  void leaveOut(const std::string& why) { ++data_.left_out[why]; }

  void addIns(const InsSample& ins) {
    if (!data_.vehicle.ins) return;
    if (ins.angular_velocity_ins)
      gyro_.push_back({t_s_, *ins.angular_velocity_ins, Matrix3d::Identity(), ins.T_robot_ins});
    if (ins.specific_force_ins)
      force_.push_back({t_s_, *ins.specific_force_ins, Matrix3d::Identity(), ins.T_robot_ins});
    if (ins.R_odom_ins && data_.vehicle.ins->attitude_sigma_rad)
      attitude_.push_back({t_s_, Vector3d::Zero(), *ins.R_odom_ins, ins.T_robot_ins});
  }

  void addDvl(const DvlSample& dvl) {
    if (!data_.vehicle.dvl) return;
    if (dvl.velocity_dvl)
      data_.dvl.push_back({t_s_, *dvl.velocity_dvl, dvl.T_robot_dvl});
    else
      leaveOut("DVL without bottom lock");
  }

  void addUsbl(const PoseSample& pose) {
    const Matrix3d covariance = pose.T_odom_robot.covariance.topLeftCorner<3, 3>();
    if (!isPositiveDefinite(covariance)) return leaveOut("USBL with a covariance that is none");
    data_.usbl.push_back({t_s_, pose.T_odom_robot.mean.position, covariance});
  }

  void addImage(const ImageEntry& entry) {
    const std::size_t number = image_++;
    addTiePoints(entry, number);
    if (data_.panels.empty()) return;
    for (std::size_t eye = 0; eye < entry.eyes.size(); ++eye) {
      const ImageEntry::Eye& view = entry.eyes[eye];
      const auto* found = detections_.find(view.image.file);
      if (found == nullptr) {
        leaveOut("image that could not be read");
        continue;
      }
      BatchMarker seen;
      seen.t_s = t_s_;
      seen.image = number;
      seen.eye = eye;
      seen.camera = cameraOf(view, eye);
      seen.T_robot_camera = entry.T_robot_camera;
      seen.T_left_right = view.T_first_camera;
      for (const Detection& detection : *found) {
        seen.detection = detection;
        addMarker(detection, seen);
      }
    }
  }

  CameraModel cameraOf(const ImageEntry::Eye& view, std::size_t eye) const {
    CameraModel camera = view.image.camera;
    if (const auto& sheet = data_.vehicle.camera)
      camera.window = eye == 0 ? sheet->model.window : sheet->right_window;
    return camera;
  }

  void addTiePoints(const ImageEntry& entry, std::size_t number) {
    if (entry.eyes.size() != 2) return;
    const auto found = tie_points_.find(entry.eyes[0].image.file.filename().string());
    if (found == tie_points_.end()) return;
    for (const TiePoint& point : found->second)
      data_.tie_points.push_back({t_s_,
                                  number,
                                  point,
                                  {cameraOf(entry.eyes[0], 0), cameraOf(entry.eyes[1], 1)},
                                  entry.eyes[1].T_first_camera});
  }

  void addMarker(const Detection& detection, BatchMarker& seen) {
    const bool finite = std::all_of(detection.corners_px.begin(), detection.corners_px.end(),
                                    [](const Vector2d& corner) { return corner.allFinite(); });
    if (!finite || !isPositiveDefinite(detection.covariance_px2))
      return leaveOut("marker with corners or a covariance that are none");
    for (std::size_t panel = 0; panel < data_.panels.size(); ++panel)
      for (const Marker& marker : data_.panels[panel].markers) {
        if (marker.id != detection.id || marker.family != detection.family) continue;
        seen.panel = panel;
        seen.marker = marker;
        data_.markers.push_back(seen);
        return;
      }
    leaveOut("marker that no map has");
  }

  BatchData& data_;
  const Detections& detections_;
  const TiePoints& tie_points_;
  std::filesystem::path image_folder_;
  LocalizationOptions watch_options_;
  InputWatch watch_{watch_options_, [this](double, const char* kind, const std::string&) {
                      const std::string what = kind;
                      if (what == "not-a-number" || what == "impossible" || what == "duplicate")
                        leaveOut(what);
                    }};
  InsReadings gyro_, force_, attitude_;
  bool any_ = false;
  double t_s_ = 0;
  std::size_t image_ = 0;
};

}  // namespace

std::string nameOf(BatchChannel channel) {
  static const std::array<const char*, kBatchChannels.size()> names{
      "gyro",    "accelerometer", "attitude", "dvl",   "depth",  "usbl",
      "markers", "tie points",    "pixels",   "edges", "specks", "prior"};
  return names[static_cast<std::size_t>(channel)];
}

BatchData collectBatch(SampleSource& source, const Detections& detections, const Vehicle& vehicle,
                       const std::vector<PanelMap>& panels, const BatchDataOptions& options) {
  BatchData data;
  data.knot_s = options.knot_s;
  data.vehicle = vehicle;
  data.panels = panels;
  Collector collector(data, detections, options.tie_points, source.imageFolder());
  while (const auto sample = source.next())
    if (!std::holds_alternative<RecordingHeader>(sample->reading)) collector.add(*sample);
  collector.finish();
  leaveOutMismatches(data);
  if (!data.hasMotion() && data.markers.empty() && data.tie_points.empty())
    throw Error("recording", "",
                "has neither navigation readings nor markers of the map nor tie points to estimate from");
  return data;
}

}  // namespace fathom
