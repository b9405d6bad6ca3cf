#include "video/video_frames.h"

extern "C" {
#include <libavutil/log.h>
}

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/videoio.hpp>
#include <utility>

#include "core/error.h"
#include "core/files.h"
#include "core/text.h"

namespace fathom {
namespace {

/// FFmpeg's complaints while it lives, in which OpenCV keeps quiet, too. OpenCV hands out damaged frames as
/// if they were whole: nothing else tells of them. Decoders complain from their own threads.
class DecoderLog {
 public:
  DecoderLog() : level_before_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {
    listen();
  }
  ~DecoderLog() {
    av_log_set_callback(av_log_default_callback);
    cv::utils::logging::setLogLevel(level_before_);
  }
  DecoderLog(const DecoderLog&) = delete;
  DecoderLog& operator=(const DecoderLog&) = delete;

  /// Again, after the first video was opened: where its environment variables ask for it, OpenCV then listens
  /// itself.
  void listen() {
    take();
    av_log_set_callback(note);
  }
  /// The first one since it was last asked; empty where there was none.
  std::string take() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(first_, {});
  }

 private:
  __attribute__((format(printf, 3, 0))) static void note(void* /*whose*/, int level, const char* format,
                                                         va_list arguments) {
    constexpr int kLevelBits = 0xff;  // above them is a colour
    if (level < 0 || (level & kLevelBits) > AV_LOG_ERROR) return;
    char text[256];
    std::vsnprintf(text, sizeof text, format, arguments);
    const std::scoped_lock lock(mutex_);
    if (first_.empty()) first_ = oneLine(text);
  }

  cv::utils::logging::LogLevel level_before_;
  static inline std::mutex mutex_;
  static inline std::string first_;
};

/// Some containers have numbers in their place, or nothing.
std::string fourCharacters(double code) {
  const auto bits = static_cast<std::uint32_t>(std::clamp(code, 0.0, 4294967295.0));
  std::string text;
  for (unsigned shift = 0; shift < 32; shift += 8) text += static_cast<char>(bits >> shift & 0xffU);
  return std::all_of(text.begin(), text.end(), [](char c) { return c > ' ' && c <= '~'; }) ? text : "";
}

}  // namespace

struct VideoFrames::Impl {
  explicit Impl(std::filesystem::path path) : file(std::move(path)) {}

  void open();
  Error errorAt(std::int64_t frame, const std::string& why) const {
    return {file.string(), print("frame %lld", static_cast<long long>(frame)), why};
  }

  std::filesystem::path file;
  DecoderLog log;  // before the capture, whose threads write to it to their end
  cv::VideoCapture capture;
  VideoHeader header;
  std::int64_t decoded = 0;
};

void VideoFrames::Impl::open() {
  if (!isFile(file)) throw Error(file.string(), "", "cannot be read");
  // Absolute: "http:x" and the like are names of files here, not addresses.
  if (!capture.open(std::filesystem::absolute(file).string(), cv::CAP_FFMPEG)) {
    const std::string complaint = log.take();
    throw Error(file.string(), "",
                "no video that can be decoded, or cut off" + (complaint.empty() ? "" : ": " + complaint));
  }
  log.listen();  // what it took to open it is told again when it is read
  capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0);
  const auto whole = [this](int property) {
    return static_cast<int>(std::clamp(capture.get(property), 0.0, 1e9));
  };
  header.width_px = whole(cv::CAP_PROP_FRAME_WIDTH);
  header.height_px = whole(cv::CAP_PROP_FRAME_HEIGHT);
  header.codec = fourCharacters(capture.get(cv::CAP_PROP_FOURCC));
  header.rate_hz = std::max(0.0, capture.get(cv::CAP_PROP_FPS));
  header.frames = whole(cv::CAP_PROP_FRAME_COUNT);
  header.rotation_deg = whole(cv::CAP_PROP_ORIENTATION_META);
}

VideoFrames::VideoFrames(std::filesystem::path file) : impl_(std::make_unique<Impl>(std::move(file))) {
  impl_->open();
}
VideoFrames::~VideoFrames() = default;

const VideoHeader& VideoFrames::header() const { return impl_->header; }
std::int64_t VideoFrames::frame() const { return impl_->decoded - 1; }

bool VideoFrames::next() {
  const bool there = impl_->capture.grab();
  if (const std::string complaint = impl_->log.take(); !complaint.empty())
    throw impl_->errorAt(impl_->decoded, "cut off or damaged here or within a few frames: " + complaint);
  if (there) ++impl_->decoded;
  return there;
}

cv::Mat VideoFrames::image() {
  cv::Mat image;
  try {
    impl_->capture.retrieve(image);
  } catch (const cv::Exception& fault) {
    throw impl_->errorAt(frame(), "cannot be decoded: " + fault.err);
  }
  if (image.type() != CV_8UC3) throw impl_->errorAt(frame(), "cannot be decoded");
  return image;
}

}  // namespace fathom
