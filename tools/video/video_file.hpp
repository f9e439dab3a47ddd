#pragma once

#include <cstdio>
#include <filesystem>
#include <string_view>

namespace slalom::tools {

/// A video that the program ffmpeg writes from pictures: GIF, WebM, MP4 or WebP, by the ending of the file.
class VideoFile {
 public:
  /// Whether the name of a file ends with one of these formats.
  static bool knows(const std::filesystem::path& file);

  /// Begins a video of this size (pixels, even) and number of pictures a second. Throws IoError if no program
  /// can be started.
  VideoFile(const std::filesystem::path& file, int width, int height, int rate);
  VideoFile(const VideoFile&) = delete;
  VideoFile& operator=(const VideoFile&) = delete;
  ~VideoFile();

  /// Adds a picture: pixels 0xXXRRGGBB, row by row. Throws IoError if ffmpeg has ended or is not installed.
  void add(std::string_view pixels);
  /// Ends the video. Throws IoError if ffmpeg could not write it.
  void finish();

 private:
  std::filesystem::path file_;
  std::FILE* ffmpeg_ = nullptr;
};

}  // namespace slalom::tools
