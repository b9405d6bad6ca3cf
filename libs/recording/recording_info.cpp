#include "recording/recording_info.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "core/median.h"
#include "core/text.h"
#include "recording/fields.h"
#include "recording/time_text.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

constexpr double kPoseTolerance = 1e-9;

struct Kind {
  template <class Entry>
  std::string operator()(const Entry&) const {
    return std::string(InstrumentOf<Entry>::kind);
  }
  std::string operator()(const ImageSample&) const { return "image"; }
  std::string operator()(const StereoSample&) const { return "stereo image"; }
  std::string operator()(const PanelSample&) const { return "panels"; }
  std::string operator()(const MarkersSample&) const { return "markers"; }
  std::string operator()(const RecordingHeader&) const { return "comment"; }
  std::string operator()(const UnknownSample& unknown) const {
    return unknown.mrpt_class + (unknown.unreadable.empty() ? "" : " (" + unknown.unreadable + ")");
  }
};

bool same(const std::vector<Pose>& a, const std::vector<Pose>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Pose& p, const Pose& q) {
    return (p.position - q.position).norm() < kPoseTolerance &&
           (p.rotation - q.rotation).norm() < kPoseTolerance;
  });
}

/// Gathers one label's entries; finish() turns the times into rates and gaps.
class LabelAccumulator {
 public:
  explicit LabelAccumulator(const Sample& first) {
    info_.label = first.label;
    info_.kind = kindOf(first.reading);
    info_.mountings = last_mountings_ = fathom::mountings(first.reading);
    info_.intrinsics = last_intrinsics_ = fathom::intrinsics(first.reading);
  }

  void add(const Sample& sample, const fs::path& image_folder) {
    ++info_.count;
    if (sample.time == Time{})
      ++info_.without_time;
    else
      times_.push_back(sample.time.time_since_epoch().count());
    checkValues(sample.reading);
    checkChanges(sample.reading);
    for (const std::string& image : imageFiles(sample.reading))
      if (!isFile(image_folder / image)) info_.missing_images.push_back(image);
  }

  LabelInfo finish(double gap_periods) {
    if (!times_.empty()) {
      const auto [first, last] = std::minmax_element(times_.begin(), times_.end());
      info_.first_time = Time(Time::duration(*first));
      info_.last_time = Time(Time::duration(*last));
    }
    std::vector<std::int64_t> periods;
    for (std::size_t i = 1; i < times_.size(); ++i) {
      const auto period = times_[i] - times_[i - 1];
      if (period > 0) periods.push_back(period);
      if (period == 0) ++info_.duplicates;
      if (period < 0) ++info_.steps_back;
    }
    if (!periods.empty()) summarize(periods, gap_periods);
    return std::move(info_);
  }

 private:
  void checkValues(const Reading& reading) {
    fieldValues(reading, values_);
    const auto is_bad = [](const std::optional<double>& value) { return value && !std::isfinite(*value); };
    if (std::any_of(values_.begin(), values_.end(), is_bad)) ++info_.not_finite;
    for (const std::string& part : absentParts(reading)) ++info_.absent[part];
  }

  void checkChanges(const Reading& reading) {
    auto mountings = fathom::mountings(reading);
    if (!same(mountings, last_mountings_)) {
      ++info_.mounting_changes;
      last_mountings_ = std::move(mountings);
    }
    auto intrinsics = fathom::intrinsics(reading);
    if (intrinsics != last_intrinsics_) {
      ++info_.intrinsics_changes;
      last_intrinsics_ = std::move(intrinsics);
    }
  }

  void summarize(std::vector<std::int64_t>& periods, double gap_periods) {
    const std::int64_t middle = upperMedian(periods);
    info_.median_period_s = 1e-7 * static_cast<double>(middle);
    const double gap_ticks = gap_periods * static_cast<double>(middle);

    double sum = 0.0, regular_sum = 0.0, regular_squares = 0.0, regular = 0.0;
    for (const auto ticks : periods) {
      sum += 1e-7 * static_cast<double>(ticks);
      if (static_cast<double>(ticks) > gap_ticks) continue;
      const double deviation = 1e-7 * static_cast<double>(ticks - middle);
      regular += 1.0;
      regular_sum += deviation;
      regular_squares += deviation * deviation;
    }
    info_.rate_hz = static_cast<double>(periods.size()) / sum;
    const double mean = regular_sum / regular;  // the median is regular: never 0/0
    info_.jitter_s = std::sqrt(std::max(0.0, regular_squares / regular - mean * mean));

    for (std::size_t i = 1; i < times_.size(); ++i) {
      const auto period = times_[i] - times_[i - 1];
      if (static_cast<double>(period) > gap_ticks)
        info_.gaps.push_back({Time(Time::duration(times_[i - 1])), 1e-7 * static_cast<double>(period)});
    }
  }

  LabelInfo info_;
  std::vector<Pose> last_mountings_;
  std::vector<RecordedCamera> last_intrinsics_;
  std::vector<std::int64_t> times_;
  std::vector<std::optional<double>> values_;
};

std::string entries(std::uint64_t count) {
  return std::to_string(count) + (count == 1 ? " entry" : " entries");
}

std::string poseText(const Pose& pose) {
  const Vector3d ypr = yawPitchRollFromRotation(pose.rotation);
  return print("x %.3f y %.3f z %.3f m, yaw %.2f pitch %.2f roll %.2f deg", pose.position.x(),
               pose.position.y(), pose.position.z(), degrees(ypr[0]), degrees(ypr[1]), degrees(ypr[2]));
}

std::string name(const LabelInfo& label) {
  return label.label.empty() ? "(" + label.kind + ")" : label.label;
}

void addRemarks(const RecordingInfo& info, const LabelInfo& label, std::vector<std::string>& lines) {
  const std::string who = name(label) + ": ";
  const auto add = [&](std::uint64_t count, const std::string& text) {
    if (count > 0) lines.push_back(who + text);
  };
  add(label.without_time, entries(label.without_time) + " without a time stamp");
  add(label.duplicates, entries(label.duplicates) + " at the same time as the one before");
  add(label.steps_back, entries(label.steps_back) + " earlier than the one before");
  add(label.not_finite, entries(label.not_finite) + " with a NaN or infinite value");
  add(label.mounting_changes,
      print("the mounting changes %llu times", static_cast<unsigned long long>(label.mounting_changes)));
  add(label.intrinsics_changes,
      print("the intrinsics change %llu times", static_cast<unsigned long long>(label.intrinsics_changes)));
  add(label.missing_images.size(), std::to_string(label.missing_images.size()) +
                                       " image files missing, the first is " +
                                       (label.missing_images.empty() ? "" : label.missing_images.front()));
  if (label.gaps.empty()) return;
  const auto longest = std::max_element(label.gaps.begin(), label.gaps.end(),
                                        [](const auto& a, const auto& b) { return a.seconds < b.seconds; });
  lines.push_back(who + std::to_string(label.gaps.size()) +
                  print(" gaps, the longest %.3f s at %.3f s", longest->seconds,
                        secondsBetween(info.first_time, longest->begin)));
}

void describeLabel(const RecordingInfo& info, const LabelInfo& label, std::string& text) {
  text += print("  %-10s %-12s %9llu", printable(label.label).c_str(), printable(label.kind).c_str(),
                static_cast<unsigned long long>(label.count));
  if (label.rate_hz > 0.0)
    text += print("  %8.3f Hz, period %.4f s (median), jitter %.4f s, from %.2f to %.2f s", label.rate_hz,
                  label.median_period_s, label.jitter_s, secondsBetween(info.first_time, label.first_time),
                  secondsBetween(info.first_time, label.last_time));
  text += "\n";
  for (const auto& [part, count] : label.absent)
    text += "             without " + part + ": " + std::to_string(count) + "\n";
  for (const Pose& mounting : label.mountings) text += "             at " + poseText(mounting) + "\n";
  for (const RecordedCamera& camera : label.intrinsics) {
    const CameraModel& m = camera.model;
    text += print("             %d x %d px, fx %.3f fy %.3f cx %.3f cy %.3f px", m.width_px, m.height_px,
                  m.fx_px, m.fy_px, m.cx_px, m.cy_px);
    if (m.lens != LensModel::plumb_bob) text.append(", ").append(nameOf(m.lens));
    text += ",";
    for (const LensCoefficient& c : coefficientsOf(m.lens)) text += print(" %s %.6f", c.name, m.*c.value);
    text += "\n";
  }
}

nlohmann::json toJson(const Pose& pose) {
  const Vector3d ypr = yawPitchRollFromRotation(pose.rotation);
  return {{"x_m", pose.position.x()},   {"y_m", pose.position.y()},     {"z_m", pose.position.z()},
          {"yaw_deg", degrees(ypr[0])}, {"pitch_deg", degrees(ypr[1])}, {"roll_deg", degrees(ypr[2])}};
}

nlohmann::json toJson(const CameraModel& m) {
  nlohmann::json json{{"width_px", m.width_px}, {"height_px", m.height_px}, {"fx_px", m.fx_px},
                      {"fy_px", m.fy_px},       {"cx_px", m.cx_px},         {"cy_px", m.cy_px}};
  for (const LensCoefficient& c : coefficientsOf(m.lens)) json[c.name] = m.*c.value;
  if (m.lens != LensModel::plumb_bob) json["model"] = nameOf(m.lens);
  return json;
}

nlohmann::json toJson(const RecordingInfo& info, const LabelInfo& label) {
  nlohmann::json json{{"label", label.label},
                      {"kind", label.kind},
                      {"count", label.count},
                      {"first_s", secondsBetween(info.first_time, label.first_time)},
                      {"last_s", secondsBetween(info.first_time, label.last_time)},
                      {"rate_hz", label.rate_hz},
                      {"median_period_s", label.median_period_s},
                      {"jitter_s", label.jitter_s},
                      {"duplicates", label.duplicates},
                      {"steps_back", label.steps_back},
                      {"without_time", label.without_time},
                      {"not_finite", label.not_finite},
                      {"absent", label.absent},
                      {"mounting_changes", label.mounting_changes},
                      {"intrinsics_changes", label.intrinsics_changes},
                      {"missing_images", label.missing_images}};
  json["gaps"] = nlohmann::json::array();
  for (const RecordingGap& gap : label.gaps)
    json["gaps"].push_back(
        {{"begin_s", secondsBetween(info.first_time, gap.begin)}, {"length_s", gap.seconds}});
  json["mountings"] = nlohmann::json::array();
  for (const Pose& mounting : label.mountings) json["mountings"].push_back(toJson(mounting));
  json["intrinsics"] = nlohmann::json::array();
  for (const auto& camera : label.intrinsics) json["intrinsics"].push_back(toJson(camera.model));
  return json;
}

}  // namespace

std::string kindOf(const Reading& reading) { return std::visit(Kind{}, reading); }

RecordingInfo inspectRecording(const fs::path& rawlog, const InspectOptions& options,
                               const std::function<void(double)>& progress) {
  RawlogReader reader(rawlog);
  RecordingInfo info;
  info.file = rawlog;
  info.file_bytes = fs::file_size(rawlog);
  info.header = reader.header();

  std::map<std::pair<std::string, std::string>, LabelAccumulator> labels;
  Time before{};
  while (const auto sample = reader.next()) {
    ++info.entries;
    if (progress && info.entries % kEntriesPerProgress == 0) progress(reader.fraction());
    const auto key = std::pair(sample->label, kindOf(sample->reading));
    labels.try_emplace(key, *sample).first->second.add(*sample, reader.imageFolder());
    if (sample->time == Time{}) continue;
    if (sample->time < before) ++info.steps_back;
    before = sample->time;
    if (info.first_time == Time{} || sample->time < info.first_time) info.first_time = sample->time;
    info.last_time = std::max(info.last_time, sample->time);
  }
  info.duration_s = secondsBetween(info.first_time, info.last_time);
  for (auto& [key, label] : labels) info.labels.push_back(label.finish(options.gap_periods));
  info.loss = reader.loss();
  return info;
}

std::vector<std::string> remarks(const RecordingInfo& info) {
  std::vector<std::string> lines;
  if (info.loss) lines.push_back(describe(*info.loss));
  if (info.steps_back > 0) lines.push_back(entries(info.steps_back) + " out of time order");
  for (const LabelInfo& label : info.labels) addRemarks(info, label, lines);
  std::transform(lines.begin(), lines.end(), lines.begin(), printable);
  return lines;
}

std::string describe(const RecordingInfo& info) {
  std::string text = info.file.string() + ": " + std::to_string(info.file_bytes) + " bytes, " +
                     std::to_string(info.entries) + " entries, " + print("%.3f s", info.duration_s) +
                     " from " + secondsText(unixTicks(info.first_time)) + " s since 1970\n";
  const auto addNamed = [&text](const char* name, const std::string& value) {
    if (!value.empty()) text += name + printable(value) + "\n";
  };
  addNamed("  description: ", info.header.description);
  addNamed("  panel map:   ", info.header.panel_map);
  addNamed("  vehicle:     ", info.header.vehicle);
  for (const LabelInfo& label : info.labels) describeLabel(info, label, text);
  const auto lines = remarks(info);
  text += lines.empty() ? "  nothing to remark\n" : "";
  for (const std::string& line : lines) text += "  ! " + line + "\n";
  return text;
}

nlohmann::json toJson(const RecordingInfo& info) {
  nlohmann::json json{{"file", info.file.string()},
                      {"file_bytes", info.file_bytes},
                      {"panel_map", info.header.panel_map},
                      {"vehicle", info.header.vehicle},
                      {"description", info.header.description},
                      {"entries", info.entries},
                      {"start_unix_s", toUnixSeconds(info.first_time)},
                      {"duration_s", info.duration_s},
                      {"steps_back", info.steps_back},
                      {"remarks", remarks(info)},
                      {"loss", nullptr}};
  if (info.loss)
    json["loss"] = {{"at_byte", info.loss->at_byte},
                    {"lost_bytes", info.loss->lost_bytes},
                    {"lost_s", info.loss->lost_seconds},
                    {"estimated", info.loss->estimated},
                    {"reason", info.loss->reason}};
  json["labels"] = nlohmann::json::array();
  for (const LabelInfo& label : info.labels) json["labels"].push_back(toJson(info, label));
  return json;
}

}  // namespace fathom
