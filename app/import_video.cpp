#include "import_video.h"

#include <memory>

#include "core/error.h"
#include "import_target.h"
#include "import_writer.h"
#include "video/import_video.h"

namespace fathom {
namespace fs = std::filesystem;
namespace {

struct VideoOptions {
  VideoImport source;
  std::vector<std::string> correct;
  ImportTarget target;
};

/// The recording is read while the rawlog is written, which then takes the place of what has its name.
void refuseRecordingOverItself(const VideoOptions& options) {
  const fs::path& recording = options.source.recording;
  std::error_code not_there;
  if (!recording.empty() && fs::equivalent(recording, options.target.file(".rawlog"), not_there))
    throw Error("--recording", recording.string(), "would be written over; give another --name or --out");
}

void importVideoTo(VideoOptions options, const RunContext& context) {
  if (options.target.name.empty()) options.target.name = options.source.video.stem().string();
  refuseRecordingOverItself(options);
  ImportWriter writer(options.target, headerOf(options.source, options.target.folder), options.correct,
                      readVehicle(options.source.vehicle));
  const ImportedRecording imported = streamVideo(options.source, options.target.file("_Images"),
                                                 [&](Sample&& sample) { writer.write(std::move(sample)); });
  writer.finish(imported, context);
}

}  // namespace

void addImportVideo(CLI::App& parent, const RunContext& context) {
  auto* command = parent.add_subcommand("video", "From a video and the stamps of its frames");
  command->footer(
      "Reads whatever FFmpeg decodes (H.264, H.265, MPEG-4, Motion JPEG, ...). Frames become PNG files and\n"
      "entries CAMERA, of the camera that VEHICLE.yaml has; they must be of its size.\n"
      "STAMPS.csv has the stamp of each frame, a row a frame; or frame,stamp, where some frames have none.\n"
      "The columns' names may stand in its first line. Stamps: Unix time in s, ms, us or ns, or ISO 8601 "
      "(UTC\n"
      "where no zone is said); which, is found out and said. Frames count from 0, or from 1 where the first\n"
      "row's is 1.\n"
      "With --recording, the samples of a rawlog of the same dive go into the recording, too, in order of\n"
      "time: all of them, whatever --from and --to are.\n"
      "A video that is cut off or damaged, or has not as many frames as there are stamps, is refused: "
      "frames\n"
      "behind the damage would get the stamps of others. `ffmpeg -i` makes a new video of what can be "
      "decoded;\n"
      "its frames need stamps of their own.\n"
      "\n"
      "Examples:\n"
      "  fathom import video dive.mp4 --stamps frames.csv --vehicle rov.yaml --out out/dive\n"
      "  fathom import video dive.mp4 --stamps frames.csv --vehicle rov.yaml --every 15 --grey \\\n"
      "    --recording out/navigation/dive.rawlog --out out/dive\n"
      "  fathom diagnose out/dive/dive.rawlog --map panel.yaml --out out/dive/diagnosis");
  const auto options = std::make_shared<VideoOptions>();
  VideoImport& source = options->source;
  command->add_option("VIDEO", source.video, "The video")->required()->type_name(values::kFile);
  command->add_option("--stamps", source.stamps, "When each frame was taken")
      ->required()
      ->type_name(values::kCsv);
  command->add_option("--vehicle", source.vehicle, "The vehicle file, with the camera")
      ->required()
      ->type_name(values::kYaml);
  command->add_option("--recording", source.recording, "A rawlog of the same dive, without images")
      ->type_name(values::kRawlog);
  command->add_option("--every", source.every, "Only every so many-th frame")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N")
      ->capture_default_str();
  command->add_flag("--grey", source.grey, "Images of one channel");
  command->add_option("--from", source.from_s,
                      "Only frames from so many seconds behind the first one's stamp on");
  command->add_option("--to", source.to_s, "Only frames up to so many seconds behind the first one's stamp");
  addCorrect(*command, options->correct);
  addImportTarget(*command, options->target, "the video's");
  command->callback([options, &context] { importVideoTo(*options, context); });
}

}  // namespace fathom
