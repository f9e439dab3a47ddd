#include "view/session/saving.hpp"

#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "view/embedded.hpp"
#include "view/protocol/frame_writer.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/replay.hpp"

namespace slalom::view {
namespace {

template <class To>
void tell(To& to, const SavedDrive& drive) {
  to.add_text(drive.hello);
  to.add_course(*drive.course);
  to.add_text(drive.options);
  to.add_text(drive.state);
  for (const auto& frame : drive.frames) to.add_frame(*frame);
  to.finish();
}

std::string content_of(FileSaver::Kind kind, const SavedDrive& drive, RecorderOptions options) {
  if (kind == FileSaver::Kind::recording) {
    std::ostringstream stream;
    Recorder recorder(stream, std::move(options));
    tell(recorder, drive);
    return std::move(stream).str();
  }
  std::vector<std::string> segments;
  ReplaySegments replay([&](std::string segment) { segments.push_back(std::move(segment)); });
  tell(replay, drive);
  return replay_page(gunzip(page_gzip()), segments);
}

std::string file_message(const std::string& name, const std::string& content) {
  FrameWriter to;
  to.begin(Block::file);
  to.put(static_cast<std::uint32_t>(name.size()));
  to.append(name);
  to.pad();
  to.append(content);
  to.end();
  return to.take();
}

}  // namespace

void FileSaver::save(Kind kind, const std::string& name, SavedDrive drive, RecorderOptions options,
                     std::function<void(std::string)> done, std::function<void(std::string)> failed) {
  if (is_busy_.exchange(true)) throw std::invalid_argument("the previous file is still being written");
  try {
    thread_ = std::jthread([this, kind, name, drive = std::move(drive), options = std::move(options),
                            done = std::move(done), failed = std::move(failed)] {
      try {
        done(file_message(name, content_of(kind, drive, options)));
      } catch (const std::exception& error) {
        failed(error.what());
      }
      is_busy_ = false;
    });
  } catch (const std::system_error& error) {
    is_busy_ = false;
    throw std::runtime_error("save: the system cannot start a thread: " + error.code().message());
  }
}

}  // namespace slalom::view
