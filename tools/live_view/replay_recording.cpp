#include "tools/live_view/replay_recording.hpp"

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "slalom/core/error.hpp"
#include "tools/json_lines/json_repair.hpp"
#include "tools/live_view/view_setup.hpp"
#include "tools/terminal/interrupt.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/mcap_repair.hpp"
#include "view/recording/replay.hpp"
#include "view/server/page_data.hpp"
#include "view/server/server.hpp"

namespace slalom::tools {

namespace {

/// The file of --repair while it is written. It has its name only once it is whole: after an error, or a
/// kill, the command can be repeated.
class RepairedFile {
 public:
  explicit RepairedFile(const std::string& file)
      : file_(file), partial_(file + ".new"), stream_(partial_, std::ios::binary) {
    if (!stream_) throw IoError(file_, 0, "cannot be written");
  }
  ~RepairedFile() {
    std::error_code ignored;
    if (!complete_) std::filesystem::remove(partial_, ignored);
  }
  RepairedFile(const RepairedFile&) = delete;
  RepairedFile& operator=(const RepairedFile&) = delete;

  std::ostream& stream() { return stream_; }
  void finish() {
    stream_.close();
    if (!stream_) throw IoError(file_, 0, "cannot be written completely; the disk may be full");
    std::error_code error;
    std::filesystem::rename(partial_, file_, error);
    if (error) throw IoError(file_, 0, "cannot be written: " + error.message());
    complete_ = true;
  }

 private:
  std::string file_, partial_;
  std::ofstream stream_;
  bool complete_ = false;
};

int repair_recording(const ReplayArguments& arguments) {
  if (std::filesystem::exists(arguments.repair))
    throw IoError(arguments.repair, 0, "exists; --repair writes a new file");
  RepairedFile repaired(arguments.repair);
  if (is_json_recording(arguments.file)) {
    const RepairedLines done = repair_json_recording(arguments.file, repaired.stream());
    repaired.finish();
    std::printf("%s: %llu records; %llu bytes of %s were lost\n", arguments.repair.c_str(),
                static_cast<unsigned long long>(done.records), static_cast<unsigned long long>(done.lost),
                arguments.file.c_str());
    return 0;
  }
  const auto done = view::mcap::repair(arguments.file, repaired.stream());
  repaired.finish();
  std::printf("%s: %llu messages and %llu segments of the page; %llu bytes of %s were lost\n",
              arguments.repair.c_str(), static_cast<unsigned long long>(done.messages),
              static_cast<unsigned long long>(done.attachments), static_cast<unsigned long long>(done.lost),
              arguments.file.c_str());
  return 0;
}

}  // namespace

int replay_recording(const ReplayArguments& arguments) {
  if (!arguments.repair.empty()) return repair_recording(arguments);
  std::uint64_t lost = 0;
  const std::string page =
      view::replay_page(view::gunzip(view::page_gzip()), view::load_replay(arguments.file, &lost));
  if (lost > 0)
    std::fprintf(stderr,
                 "note: %s was cut: its last %llu bytes cannot be read; --repair FILE writes the rest out\n",
                 arguments.file.c_str(), static_cast<unsigned long long>(lost));
  if (!arguments.html.empty()) {
    std::ofstream stream(arguments.html, std::ios::binary);
    stream << page;
    stream.close();
    if (!stream) throw IoError(arguments.html, 0, "cannot be written");
    std::printf("replay: %s, opens in any browser\n", arguments.html.c_str());
    return 0;
  }
  view::ServerOptions options = server_options(arguments.host, arguments.port, "");
  view::Server server(options, {{"/", {"text/html; charset=utf-8", page}}});
  const InterruptFlag interrupt;
  print_address(server, options);
  while (!interrupt.raised()) {
    server.wait(std::chrono::milliseconds(100));
    server.take();
  }
  return 0;
}

}  // namespace slalom::tools
