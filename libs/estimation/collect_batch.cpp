#include "estimation/collect_batch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/linear_algebra.h"
#include "core/stable_sort.h"
#include "estimation/tie_point_gate.h"
#include "landmarks/image_entry.h"
#include "localization/input_watch.h"
#include "recording/instrument_entries.h"

namespace fathom {
namespace {

using Readings = std::vector<BatchReading>;

BatchReading meanOf(Readings::const_iterator begin, Readings::const_iterator end) {
  BatchReading bin = *begin;
  bin.samples = static_cast<int>(end - begin);
  bin.seen.about = (begin + bin.samples / 2)->seen.about;
  bin.seen.value.setZero();
  double mean_s = 0, variance_s2 = 0;
  for (auto it = begin; it != end; ++it) {
    mean_s += it->t_s() / bin.samples;
    const Vector3d turned = logSO3<double>(bin.seen.about.transpose() * it->seen.about);
    bin.seen.value += (it->seen.value + turned) / bin.samples;
  }
  for (auto it = begin; it != end; ++it) variance_s2 += std::pow(it->t_s() - mean_s, 2) / bin.samples;
  const double sigma_s = std::sqrt(variance_s2);
  bin.node_s = {mean_s - sigma_s, mean_s + sigma_s};
  bin.seen.covariance /= bin.samples;
  return bin;
}

/// Means over knot intervals, of each instance.
Readings averaged(Readings readings, double knot_s) {
  const auto intervalOf = [&](const BatchReading& r) {
    return std::pair(std::floor(r.t_s() / knot_s + 1e-6), r.seen.instance);
  };
  stableSort(readings, [&](const BatchReading& a, const BatchReading& b) {
    return std::pair(intervalOf(a), a.t_s()) < std::pair(intervalOf(b), b.t_s());
  });
  Readings result;
  for (auto begin = readings.cbegin(); begin != readings.cend();) {
    const auto end = std::find_if(begin, readings.cend(),
                                  [&](const BatchReading& r) { return intervalOf(r) != intervalOf(*begin); });
    result.push_back(meanOf(begin, end));
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
    if (isImage(sample)) return addImage(*imageEntry(sample, image_folder_, data_.vehicle));
    if (!watch_.accept(sample, t_s_)) return;
    withInstrument(sample, [&]<class Instrument>(const auto& entry, const Instance& instance) {
      addEntry<Instrument>(entry, instance);
    });
  }

  void finish() {
    double first_s = std::numeric_limits<double>::infinity(), last_s = -first_s;
    const auto reach = [&](double t_s) {
      first_s = std::min(first_s, t_s);
      last_s = std::max(last_s, t_s);
    };
    for (const Channel channel : kEveryChannel) {
      if (indexOf(channel) >= kInstrumentChannelCount) break;
      Readings& readings = data_.readings[indexOf(channel)];
      if (textOf(channel).shows_motion || data_.hasMotion())
        for (const BatchReading& r : readings) reach(r.t_s());
    }
    for (const BatchMarker& m : data_.markers) reach(m.t_s);
    for (const BatchTiePoint& p : data_.tie_points) reach(p.t_s);
    for (const Channel channel : kEveryChannel)
      if (indexOf(channel) < kInstrumentChannelCount && textOf(channel).is_averaged)
        data_.readings[indexOf(channel)] =
            averaged(std::move(data_.readings[indexOf(channel)]), data_.knot_s);
    data_.first_s = first_s;
    data_.last_s = last_s;
  }

 private:
  void leaveOut(const std::string& why) { ++data_.left_out[why]; }

  template <class Instrument>
  void addEntry(const typename Instrument::Sample& entry, const Instance& instance) {
    if (!detail::isOnBoard<Instrument>(data_.vehicle, instance)) return;
    [&]<class... Channels>(std::tuple<Channels...>*) {
      (addChannel<Channels>(entry, instance), ...);
    }(static_cast<typename Instrument::Channels*>(nullptr));
  }

  template <class C>
  void addChannel(const auto& entry, const Instance& instance) {
    if (!C::channel.is_estimated) return;
    std::vector<BatchReading>& readings = data_.of<C>();
    const std::size_t before = readings.size();
    C::observe(entry, sheetOf<C>(data_.vehicle, instance), [&](const Observation& seen) {
      readings.push_back({kChannel<C>, {t_s_, t_s_}, 1, seen});
      readings.back().seen.instance = instance;
    });
    if constexpr (requires { C::lacking; })
      if (readings.size() == before) leaveOut(C::lacking);
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
      seen.instance = entry.instance;
      seen.camera = cameraOf(view, entry.instance, eye);
      seen.T_robot_camera = entry.T_robot_camera;
      seen.T_left_right = view.T_first_camera;
      for (const Detection& detection : *found) {
        seen.detection = detection;
        addMarker(detection, seen);
      }
    }
  }

  CameraModel cameraOf(const ImageEntry::Eye& view, const Instance& instance, std::size_t eye) const {
    CameraModel camera = view.image.camera;
    if (const auto& sheet = data_.vehicle.sensors(instance).camera) {
      camera.window = eye == 0 ? sheet->model.window : sheet->right_window;
      camera.above_water = sheet->model.above_water;
    }
    return camera;
  }

  void addTiePoints(const ImageEntry& entry, std::size_t number) {
    if (entry.eyes.size() != 2) return;
    const auto found = tie_points_.find(entry.eyes[0].image.file.filename().string());
    if (found == tie_points_.end()) return;
    for (const TiePoint& point : found->second)
      data_.tie_points.push_back(
          {t_s_,
           number,
           point,
           {cameraOf(entry.eyes[0], entry.instance, 0), cameraOf(entry.eyes[1], entry.instance, 1)},
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
  bool any_ = false;
  double t_s_ = 0;
  std::size_t image_ = 0;
};

}  // namespace

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
