// Recordings whose images came from a linear sensor, as they would have come from cameras that people have:
// behind a mosaic of colours, sharpened, compressed, balanced. For `diagnosis_worlds --sample`, which asks
// what is said of them.
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "core/error.h"
#include "core/text.h"

namespace fathom {
namespace {
namespace fs = std::filesystem;

using Images = std::vector<cv::Mat>;  // CV_8UC3, blue, green, red, in the order of time
using Step = std::function<void(Images&)>;

Step each(const std::function<cv::Mat(const cv::Mat&)>& change) {
  return [change](Images& images) {
    for (cv::Mat& image : images) image = change(image);
  };
}

/// A sensor that has red, green, green, blue in each square of four; what is missing is its neighbours' mean.
cv::Mat mosaicked(const cv::Mat& image) {
  cv::Mat raw(image.size(), CV_8UC1), full;
  for (int v = 0; v < image.rows; ++v)
    for (int u = 0; u < image.cols; ++u) {
      const int colour = v % 2 == 0 ? (u % 2 == 0 ? 2 : 1) : (u % 2 == 0 ? 1 : 0);
      raw.at<std::uint8_t>(v, u) = image.at<cv::Vec3b>(v, u)[colour];
    }
  cv::demosaicing(raw, full, cv::COLOR_BayerRGGB2BGR);
  return full;
}

cv::Mat sharpened(const cv::Mat& image, double amount, double radius_px) {
  cv::Mat soft, sharp;
  cv::GaussianBlur(image, soft, {}, radius_px);
  cv::addWeighted(image, 1 + amount, soft, -amount, 0, sharp);
  return sharp;
}

cv::Mat compressed(const cv::Mat& image, int quality) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return cv::imdecode(bytes, cv::IMREAD_COLOR);
}

/// So that all colours' means are green's.
cv::Mat grayWorld(const cv::Mat& image) {
  const cv::Scalar mean = cv::mean(image);
  cv::Mat balanced;
  cv::multiply(image, cv::Scalar(mean[1] / mean[0], 1, mean[1] / mean[2]), balanced);
  return balanced;
}

/// So that green's mean is a share of full scale.
cv::Mat exposedTo(const cv::Mat& image, double share) {
  cv::Mat exposed;
  image.convertTo(exposed, -1, share * 255 / cv::mean(image)[1]);
  return exposed;
}

cv::Mat gray(const cv::Mat& image) {
  cv::Mat one, three;
  cv::cvtColor(image, one, cv::COLOR_BGR2GRAY);
  cv::cvtColor(one, three, cv::COLOR_GRAY2BGR);
  return three;
}

/// Through a video file of so many bits a second, at one frame an image.
Step video(int bits_per_s, double frames_per_s) {
  return [=](Images& images) {
    const fs::path file = fs::temp_directory_path() / print("pipeline-%d.mp4", static_cast<int>(::getpid()));
    ::setenv("OPENCV_FFMPEG_WRITER_OPTIONS", print("b;%d", bits_per_s).c_str(), 1);
    cv::VideoWriter writer(file.string(), cv::CAP_FFMPEG, cv::VideoWriter::fourcc('a', 'v', 'c', '1'),
                           frames_per_s, images.front().size());
    if (!writer.isOpened()) throw Error(file.string(), "", "OpenCV cannot write H.264 here");
    for (const cv::Mat& image : images) writer.write(image);
    writer.release();
    cv::VideoCapture reader(file.string());
    for (cv::Mat& image : images)
      if (cv::Mat frame; reader.read(frame)) image = frame.clone();
    fs::remove(file);
  };
}

struct Pipeline {
  std::string name;
  std::vector<Step> steps;
};

std::vector<Pipeline> pipelines() {
  const Step bayer = each(mosaicked);
  const Step sharpen = each([](const cv::Mat& image) { return sharpened(image, 0.5, 1.0); });
  const auto jpeg = [](int quality) {
    return each([quality](const cv::Mat& image) { return compressed(image, quality); });
  };
  return {{"bayer", {bayer}},
          {"bayer-sharp", {bayer, sharpen}},
          {"bayer-sharp-jpeg95", {bayer, sharpen, jpeg(95)}},
          {"bayer-sharp-jpeg85", {bayer, sharpen, jpeg(85)}},
          {"bayer-sharp-jpeg75", {bayer, sharpen, jpeg(75)}},
          {"jpeg90", {jpeg(90)}},
          {"h264", {video(5000000, 30)}},
          {"white-balance", {each(grayWorld)}},
          {"auto-exposure", {each([](const cv::Mat& image) { return exposedTo(image, 0.25); })}},
          {"gray", {each(gray)}},
          {"ordinary", {bayer, each(grayWorld), sharpen, jpeg(90)}}};
}

std::vector<fs::path> imagesOf(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder / "recording_Images"))
    if (entry.path().extension() == ".png") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.empty()) throw Error(folder.string(), "recording_Images", "has no PNG image");
  return files;
}

void process(const fs::path& recording, const Pipeline& pipeline, const fs::path& target) {
  fs::create_directories(target.parent_path());
  fs::copy(recording, target, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  const std::vector<fs::path> files = imagesOf(target);
  Images images;
  for (const fs::path& file : files) images.push_back(cv::imread(file.string(), cv::IMREAD_COLOR));
  for (const Step& step : pipeline.steps) step(images);
  for (std::size_t i = 0; i < files.size(); ++i)
    cv::imwrite(files[i].string(), images[i], {cv::IMWRITE_PNG_COMPRESSION, 1});
}

int run(int argc, char** argv) {
  CLI::App app("Recordings as other cameras would have made them");
  std::vector<std::string> recordings, only;
  std::string out = "out/pipelines";
  app.add_option("RECORDING", recordings, "Folders with recording.rawlog and recording_Images")->required();
  app.add_option("--only", only, "Pipelines by name");
  app.add_option("--out", out, "Folder of the copies, RECORDING-PIPELINE")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  for (const fs::path recording : recordings)
    for (const Pipeline& pipeline : pipelines()) {
      if (!only.empty() && std::find(only.begin(), only.end(), pipeline.name) == only.end()) continue;
      const fs::path target = fs::path(out) / (recording.filename().string() + "-" + pipeline.name);
      process(recording, pipeline, target);
      std::cout << target.string() << "\n";
    }
  return 0;
}

}  // namespace
}  // namespace fathom

int main(int argc, char** argv) {
  try {
    return fathom::run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << e.what() << "\n";
    return 2;
  }
}
