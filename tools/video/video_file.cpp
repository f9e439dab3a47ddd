#include "tools/video/video_file.hpp"

#include <sys/wait.h>

#include <csignal>
#include <cstring>
#include <utility>

#include "slalom/core/error.hpp"
#include "tools/command_line/words.hpp"

namespace slalom::tools {
namespace {

/// The options of ffmpeg for each format.
constexpr std::pair<const char*, const char*> formats[] = {
    // A few flat colours: dithering would make the file several times as large.
    {".gif", "-filter_complex 'split[a][b];[a]palettegen=max_colors=48[p];[b][p]paletteuse=dither=none'"},
    {".webm", "-c:v libvpx-vp9 -crf 34 -b:v 0 -pix_fmt yuv420p"},
    {".mp4", "-c:v libx264 -crf 23 -pix_fmt yuv420p -movflags +faststart"},
    {".webp", "-c:v libwebp_anim -quality 70 -loop 0"}};
constexpr int not_found = 127;  // status of a shell without the program

const char* format_of(const std::filesystem::path& file) {
  for (const auto& [ending, options] : formats)
    if (file.extension() == ending) return options;
  return nullptr;
}

}  // namespace

bool VideoFile::knows(const std::filesystem::path& file) {
  return format_of(file) != nullptr;
}

VideoFile::VideoFile(const std::filesystem::path& file, int width, int height, int rate) : file_(file) {
  std::signal(SIGPIPE, SIG_IGN);  // so that `add` can report that ffmpeg has ended
  const std::string command =
      formatted(
          "command -v ffmpeg >/dev/null || exit %d; exec ffmpeg -loglevel error -nostdin -y -f rawvideo "
          "-pix_fmt bgr0 -s %dx%d -framerate %d -i pipe:0 %s ",
          not_found, width, height, rate, format_of(file)) +
      shell_word("file:" + file.string());  // a name is a file, whatever it begins with
  ffmpeg_ = popen(command.c_str(), "we");
  if (!ffmpeg_) throw IoError(file.string(), 0, std::strerror(errno));
}

VideoFile::~VideoFile() {
  if (!ffmpeg_) return;
  pclose(ffmpeg_);  // it takes what it has got for the whole video
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

void VideoFile::add(std::string_view pixels) {
  if (std::fwrite(pixels.data(), 1, pixels.size(), ffmpeg_) < pixels.size()) finish();  // it says why
}

void VideoFile::finish() {
  const int status = pclose(std::exchange(ffmpeg_, nullptr)),
            code = WIFEXITED(status) ? WEXITSTATUS(status) : 1;
  if (code == not_found)
    throw IoError(file_.string(), 0,
                  "cannot be written: the program ffmpeg is not installed (Debian: apt-get install ffmpeg)");
  if (code != 0)
    throw IoError(file_.string(), 0, "cannot be written: ffmpeg ended with status " + std::to_string(code));
}

}  // namespace slalom::tools
