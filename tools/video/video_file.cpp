#include "tools/video/video_file.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

#include "slalom/core/error.hpp"

namespace slalom::tools {
namespace {

using Words = std::vector<std::string>;

/// The options of ffmpeg for each format.
const std::pair<const char*, Words> formats[] = {
    // A few flat colours: dithering would make the file several times as large.
    {".gif", {"-filter_complex", "split[a][b];[a]palettegen=max_colors=48[p];[b][p]paletteuse=dither=none"}},
    {".webm", {"-c:v", "libvpx-vp9", "-crf", "34", "-b:v", "0", "-pix_fmt", "yuv420p"}},
    {".mp4", {"-c:v", "libx264", "-crf", "23", "-pix_fmt", "yuv420p", "-movflags", "+faststart"}},
    {".webp", {"-c:v", "libwebp_anim", "-quality", "70", "-loop", "0"}}};

const Words* format_of(const std::filesystem::path& file) {
  for (const auto& [ending, options] : formats)
    if (file.extension() == ending) return &options;
  return nullptr;
}

}  // namespace

bool VideoFile::knows(const std::filesystem::path& file) {
  return format_of(file) != nullptr;
}

VideoFile::VideoFile(const std::filesystem::path& file, int width, int height, int rate) : file_(file) {
  Words words = {"ffmpeg", "-loglevel", "error", "-nostdin", "-y", "-f", "rawvideo", "-pix_fmt", "bgr0"};
  const Words input = {"-s",         std::to_string(width) + "x" + std::to_string(height),
                       "-framerate", std::to_string(rate),
                       "-i",         "pipe:0"};
  words.insert(words.end(), input.begin(), input.end());
  if (const Words* options = format_of(file)) words.insert(words.end(), options->begin(), options->end());
  words.push_back("file:" + file.string());  // a name is a file, whatever it begins with
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);

  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) throw IoError(file.string(), 0, std::strerror(errno));
  pipe_ = ends[1];
  std::signal(SIGPIPE, SIG_IGN);  // so that `add` can report that ffmpeg has ended
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  const int failed = posix_spawnp(&ffmpeg_, "ffmpeg", &actions, nullptr, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  if (failed == 0) return;
  close(pipe_);
  const std::string reason = failed == ENOENT ? "is not installed (Debian: apt-get install ffmpeg)"
                                              : std::string("cannot be started: ") + std::strerror(failed);
  throw IoError(file.string(), 0, "cannot be written: the program ffmpeg " + reason);
}

VideoFile::~VideoFile() {
  if (pipe_ < 0) return;
  kill(ffmpeg_, SIGKILL);  // it would take what it has got for the whole video
  wait();
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

void VideoFile::add(std::string_view pixels) {
  while (!pixels.empty()) {
    const ssize_t count = write(pipe_, pixels.data(), pixels.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return finish();  // which says why
    pixels.remove_prefix(static_cast<std::size_t>(count));
  }
}

void VideoFile::finish() {
  if (const int status = wait(); status != 0)
    throw IoError(file_.string(), 0, "cannot be written: ffmpeg ended with status " + std::to_string(status));
}

int VideoFile::wait() {
  close(std::exchange(pipe_, -1));
  int status = 0;
  while (waitpid(ffmpeg_, &status, 0) < 0 && errno == EINTR) continue;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

}  // namespace slalom::tools
