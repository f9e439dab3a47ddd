#include <cstdio>
#include <memory>

#include "slalom/core/files/write_file.hpp"
#include "tools/commands/commands.hpp"
#include "tools/recording/replay_page.hpp"
#include "tools/video/drive_video.hpp"
#include "tools/video/video_file.hpp"

namespace slalom::tools {
namespace {

struct ExportArguments {
  std::string recording, file;
  VideoSpan span;
};

int export_recording(const ExportArguments& arguments, bool has_span) {
  const std::filesystem::path file = arguments.file;
  if (file.extension() == ".html") {
    if (has_span) throw CommandLineError("--from, --to, --speed", "are for videos");
    write_file(file, page_of_recording(arguments.recording));
    std::printf("page: %s, opens in any browser\n", file.c_str());
    return 0;
  }
  if (!VideoFile::knows(file))
    throw CommandLineError("file", arguments.file, "must end with .html, .gif, .webm, .mp4 or .webp");
  if (arguments.span.to <= arguments.span.from) throw CommandLineError("--to", "must be larger than --from");
  const int pictures = write_video(RecordedDrive(arguments.recording), arguments.span, file);
  std::printf("video: %s, %d pictures, %.1f s\n", file.c_str(), pictures, pictures / 25.0);
  return 0;
}

}  // namespace

void declare_export(Subcommand& command) {
  command.summary("Write a recording as one HTML file, or as a video from above");
  const auto arguments = std::make_shared<ExportArguments>();
  command.option("recording", arguments->recording, "Recording in MCAP", {.required = true});
  command.option(
      "file", arguments->file,
      "File to write: .html, which opens in any browser; or .gif, .webm, .mp4 or .webp, for which the "
      "program ffmpeg must be installed",
      {.required = true});
  command.option("--from", arguments->span.from, "Video: first second of the recording", {0, 1e6});
  command.option("--to", arguments->span.to, "Video: last second of the recording", {0, 1e6});
  command.option("--speed", arguments->span.speed, "Video: speed; 0.5 is slow motion", {0.01, 100});
  command.examples({"export lap.mcap lap.html", "export lap.mcap lap.webm --from 4 --to 8 --speed 0.5"});
  command.action([arguments, &command] {
    return export_recording(*arguments, !command.given_only({"recording", "file"}));
  });
}

}  // namespace slalom::tools
