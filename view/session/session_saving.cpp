#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "src/evaluation/json.hpp"
#include "view/protocol/frame_writer.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/recorder.hpp"
#include "view/recording/replay.hpp"
#include "view/server/page_data.hpp"
#include "view/session/session.hpp"

namespace slalom::view {
namespace {

using Frames = std::vector<std::shared_ptr<const std::string>>;

/// The opening messages of a recording or replay.
struct Opening {
  std::string hello, options, state;
  std::shared_ptr<const std::string> course;
};

template <class To>
void tell(To& to, const Opening& opening, const Frames& frames) {
  to.add_text(opening.hello);
  to.add_course(*opening.course);
  to.add_text(opening.options);
  to.add_text(opening.state);
  for (const auto& frame : frames) to.add_frame(*frame);
  to.finish();
}

std::string recording_of(const Opening& opening, const Frames& frames, RecorderOptions options) {
  std::ostringstream stream;
  Recorder recorder(stream, std::move(options));
  tell(recorder, opening, frames);
  return std::move(stream).str();
}

std::string replay_of(const Opening& opening, const Frames& frames) {
  std::vector<std::string> segments;
  ReplaySegments replay([&](std::string segment) { segments.push_back(std::move(segment)); });
  tell(replay, opening, frames);
  return replay_page(gunzip(page_gzip()), segments);
}

/// A file as a message: its name and its content.
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

/// Sends the last minute to a client as a file. It is created in its own thread while the drive continues.
void Session::save(std::uint64_t client, const std::string& what) {
  if (what != "recording" && what != "replay")
    throw std::invalid_argument("what: must be recording or replay");
  if (history_.empty()) throw std::invalid_argument("nothing has been driven yet");
  if (saving_) throw std::invalid_argument("the previous file is still being written");
  Frames frames;
  for (const Step& step : history_) frames.push_back(step.frame);
  const sim::WorldOptions world = scenario_.environment->world_options();
  RecorderOptions recorder{.program = options_.program,
                           .settings = {{"settings", Json{{"command_line", command_line()}}.dump()}},
                           .lidar_angle_min = world.lidar.angle_min(),
                           .lidar_angle_increment = world.lidar.angle_increment(),
                           .wall_clock = options_.record_times};
  const std::string name = "slalom-" + scenario_.environment->course.name + "-" + names_.method + "-" +
                           std::to_string(history_.back().tick) + (what == "replay" ? ".html" : ".mcap");
  auto write = [this, client, what, name, frames = std::move(frames), recorder = std::move(recorder),
                opening = Opening{hello(), options(), state(), scene_}] {
    try {
      const std::string content =
          what == "replay" ? replay_of(opening, frames) : recording_of(opening, frames, recorder);
      server_.send(client, {std::make_shared<const std::string>(file_message(name, content)), true});
    } catch (const std::exception& error) {
      try {
        refuse(client, error.what());
      } catch (const std::exception&) {
        // No memory for the answer either; the drive continues.
      }
    }
    saving_ = false;
  };
  saving_ = true;
  try {
    saver_ = std::jthread(std::move(write));
  } catch (const std::system_error& error) {
    saving_ = false;
    throw std::runtime_error("save: the system cannot start a thread to write the file (" +
                             error.code().message() + ")");
  } catch (...) {
    saving_ = false;
    throw;
  }
}

}  // namespace slalom::view
