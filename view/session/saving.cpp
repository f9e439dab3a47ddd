#include "view/session/saving.hpp"

#include <sstream>
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

std::string replay_message(const std::string& name, const SavedDrive& drive) {
  std::vector<std::string> segments;
  ReplaySegments replay([&](std::string segment) { segments.push_back(std::move(segment)); });
  tell(replay, drive);
  return file_message(name, replay_page(gunzip(page_gzip()), segments));
}

std::string recording_message(const std::string& name, const SavedDrive& drive, RecorderOptions options) {
  std::ostringstream stream;
  Recorder recorder(stream, std::move(options));
  tell(recorder, drive);
  return file_message(name, std::move(stream).str());
}

}  // namespace slalom::view
