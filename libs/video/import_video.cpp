#include "video/import_video.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/error.h"
#include "core/files.h"
#include "core/progress.h"
#include "core/text.h"
#include "image_files/encode_image.h"
#include "recording/fields.h"
#include "recording/rawlog.h"
#include "recording/reorder_buffer.h"
#include "sensors/vehicle.h"
#include "video/frame_stamps.h"
#include "video/pending_images.h"
#include "video/video_frames.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

CameraSheet cameraOf(const fs::path& vehicle_file) {
  const Vehicle vehicle = readVehicle(vehicle_file);
  if (!vehicle.camera) throw Error(vehicle_file.string(), "camera", "missing: whose frames are these?");
  return *vehicle.camera;
}

/// The samples of a recording, handed to a buffer as far as they can be written again.
class JoinedRecording {
 public:
  JoinedRecording(const fs::path& file, ReorderBuffer& order) : reader_(file), order_(order) { advance(); }

  /// Throws Error where the recording has no time in common with these.
  void requireOverlap(Time first, Time last) {
    const auto apart = [&](const std::string& where) {
      return Error(reader_.file().string(), "",
                   print("%s the frames that are asked for, which are from %.3f to %.3f Unix seconds: of "
                         "another dive, or on another clock",
                         where.c_str(), toUnixSeconds(first), toUnixSeconds(last)));
    };
    if (next_ && next_->time > last) throw apart("begins after");
    pushUpTo(first);
    if (!next_ && !reaches(first)) throw apart("ends before");
  }

  void pushUpTo(Time time) {
    for (; next_ && next_->time <= time; advance()) push();
  }
  void pushRest() {
    for (; next_; advance()) push();
  }

  std::vector<std::string> remarks() const {
    std::vector<std::string> lines;
    const auto say = [&](const std::string& what) {
      lines.push_back(reader_.file().filename().string() + what);
    };
    if (without_time_ > 0) say(print(": %zu entries without a stamp are left out", without_time_));
    if (unknown_ > 0) say(print(": %zu entries of kinds that are not known are left out", unknown_));
    if (reader_.loss()) say(": " + describe(*reader_.loss()));
    return lines;
  }

 private:
  bool reaches(Time time) const { return newest_ && *newest_ >= time; }

  /// To the next entry that can be written.
  void advance() {
    while ((next_ = reader_.next())) {
      ++entries_;
      if (std::holds_alternative<RecordingHeader>(next_->reading)) continue;
      if (std::holds_alternative<UnknownSample>(next_->reading))
        ++unknown_;
      else if (next_->time == Time{})
        ++without_time_;
      else
        return;
    }
  }

  void push() {
    if (!imageFiles(next_->reading).empty())
      throw error("has images: only a recording without can be joined with a video");
    if (!order_.fits(next_->time))
      throw error(print("is more than %g s older than entries before it: a clock was set back", kReorder_s));
    newest_ = newest_ ? std::max(*newest_, next_->time) : next_->time;
    order_.push(std::move(*next_));
  }

  Error error(const std::string& why) const {
    return {reader_.file().string(), print("entry %zu (", entries_) + printable(next_->label) + ")", why};
  }

  RawlogReader reader_;
  ReorderBuffer& order_;
  std::optional<Sample> next_;
  std::optional<Time> newest_;
  std::size_t entries_ = 0, unknown_ = 0, without_time_ = 0;
};

class VideoImporter {
 public:
  VideoImporter(const VideoImport& source, const fs::path& image_folder, const SampleSink& sink)
      : source_(source),
        camera_(cameraOf(source.vehicle)),
        table_(readFrameStamps(source.stamps)),
        frames_(source.video),
        order_(kReorder_s, sink),
        images_(image_folder) {
    if (!source.recording.empty()) joined_.emplace(source.recording, order_);
    from_ = after(table_.stamps.front().time, source.from_s.value_or(0));
    to_ = source.to_s ? after(table_.stamps.front().time, *source.to_s) : table_.stamps.back().time;
  }

  ImportedRecording run() {
    requireSize({frames_.header().width_px, frames_.header().height_px});
    requireWanted();
    readFrames();
    if (joined_) joined_->pushRest();
    order_.flush();
    images_.commit();
    ImportedRecording recording;
    recording.start = *order_.first();
    recording.vehicle_yaml = readTextFile(source_.vehicle);
    recording.remarks = remarks();
    return recording;
  }

 private:
  bool isWanted(const FrameStamp& stamp) const { return stamp.time >= from_ && stamp.time <= to_; }

  /// Before hours are spent on the video.
  void requireWanted() {
    const auto wanted = [this](const FrameStamp& stamp) { return isWanted(stamp); };
    const auto first = std::find_if(table_.stamps.begin(), table_.stamps.end(), wanted);
    const auto last = std::find_if(table_.stamps.rbegin(), table_.stamps.rend(), wanted);
    if (first == table_.stamps.end())
      throw Error(table_.file.string(), "",
                  print("has no stamp from --from to --to; it has %.3f s",
                        secondsBetween(table_.stamps.front().time, table_.stamps.back().time)));
    if (joined_) joined_->requireOverlap(first->time, last->time);
  }

  void requireSize(cv::Size size) const {
    const CameraModel& model = camera_.model;
    if (size != cv::Size(model.width_px, model.height_px))
      throw Error(source_.video.string(), "",
                  print("its frames are of %d x %d px, the camera of %s of %d x %d", size.width, size.height,
                        source_.vehicle.filename().string().c_str(), model.width_px, model.height_px));
  }

  void readFrames() {
    Progress progress("reading " + source_.video.filename().string());
    const auto expected = std::max(frames_.header().frames, table_.stamps.back().frame + 1);
    auto stamp = table_.stamps.begin();
    while (frames_.next()) {
      progress.update(std::min(1.0, static_cast<double>(frames_.frame()) / static_cast<double>(expected)));
      if (stamp == table_.stamps.end() && !table_.names_frames) throw tooFewStamps();
      if (stamp == table_.stamps.end() || stamp->frame != frames_.frame()) continue;
      if (isWanted(*stamp) && wanted_++ % static_cast<std::size_t>(source_.every) == 0) take(*stamp);
      ++stamp;
    }
    if (stamp != table_.stamps.end()) throw tooFewFrames(*stamp);
  }

  Error tooFewStamps() const {
    return table_.error(table_.stamps.back(),
                        print("is the last, of frame %zu; the video goes on (%lld frames by its header)",
                              table_.stamps.size() - 1, static_cast<long long>(frames_.header().frames)));
  }

  /// The video is to blame where its own header says that there were more.
  Error tooFewFrames(const FrameStamp& stamp) const {
    const auto count = static_cast<long long>(frames_.frame() + 1);
    const auto claimed = static_cast<long long>(frames_.header().frames);
    if (claimed > stamp.frame)
      return {source_.video.string(), print("frame %lld", count),
              print("the video ends here, cut off or damaged: it has about %lld frames by its header, and %s "
                    "has frame %lld",
                    claimed, table_.file.filename().string().c_str(), static_cast<long long>(stamp.frame))};
    return table_.error(stamp, print("is of frame %lld, counted from 0; the video has only %lld frames",
                                     static_cast<long long>(stamp.frame), count));
  }

  void take(const FrameStamp& stamp) {
    cv::Mat image = frames_.image();
    requireSize(image.size());
    if (source_.grey) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
    if (joined_) joined_->pushUpTo(stamp.time);
    const std::string name = PendingImages::nameOf(stamp.frame);
    order_.push({stamp.time, labels::kCamera,
                 ImageSample{camera_.T_robot_camera, recordedCamera(camera_.model), name}});
    images_.write(name, pngBytes(image));
    ++taken_;
  }

  std::string countDiffers(std::int64_t count) const {
    const auto claimed = frames_.header().frames;
    return print("video: %lld frames were decoded, its header says %lld", static_cast<long long>(count),
                 static_cast<long long>(claimed)) +
           (claimed > count && table_.names_frames ? ": where that is counted, not estimated from its "
                                                     "length, frames are lost, and those behind them "
                                                     "have the stamps of others"
                                                   : "");
  }

  std::vector<std::string> remarks() const {
    const VideoHeader& header = frames_.header();
    const auto count = frames_.frame() + 1;
    std::vector<std::string> lines{
        print("video: codec %s, %d x %d px, %.5g frames a second by its header; %lld frames, of which %zu "
              "became images",
              header.codec.empty() ? "of no name" : header.codec.c_str(), header.width_px, header.height_px,
              header.rate_hz, static_cast<long long>(count), taken_)};
    if (header.frames > 0 && header.frames != count) lines.push_back(countDiffers(count));
    if (const auto without = count - std::ssize(table_.stamps); without > 0)
      lines.push_back(print("%s: %lld of the video's frames have no stamp and are left out",
                            table_.file.filename().string().c_str(), static_cast<long long>(without)));
    if (header.rotation_deg != 0)
      lines.push_back(print(
          "video: its header asks players to turn frames (%d degrees, as OpenCV reads it); they are left "
          "as stored, which the camera's calibration must be for",
          header.rotation_deg));
    if (camera_.pipeline == CameraPipeline::linear)
      lines.push_back(
          source_.vehicle.filename().string() +
          ": its camera has `pipeline: linear`; a video is compressed, for which `processed` is right");
    for (const std::string& line : table_.remarks)
      lines.push_back(table_.file.filename().string() + ": " + line);
    for (const std::string& line : describePace(table_.stamps, header.rate_hz))
      lines.push_back("video: " + line);
    if (joined_)
      for (const std::string& line : joined_->remarks()) lines.push_back(line);
    return lines;
  }

  const VideoImport& source_;
  CameraSheet camera_;
  StampTable table_;
  VideoFrames frames_;
  ReorderBuffer order_;
  PendingImages images_;
  std::optional<JoinedRecording> joined_;
  Time from_, to_;
  std::size_t wanted_ = 0, taken_ = 0;
};

}  // namespace

RecordingHeader headerOf(const VideoImport& source, const fs::path& target) {
  RecordingHeader header{"", "", "video " + source.video.filename().string()};
  if (source.recording.empty()) return header;
  header.description += " with " + source.recording.filename().string();
  const RecordingHeader joined = RawlogReader(source.recording).header();
  if (!joined.panel_map.empty())
    header.panel_map =
        fs::relative(source.recording.parent_path() / joined.panel_map, target).generic_string();
  return header;
}

ImportedRecording streamVideo(const VideoImport& source, const fs::path& image_folder,
                              const SampleSink& sink) {
  return VideoImporter(source, image_folder, sink).run();
}

}  // namespace fathom
