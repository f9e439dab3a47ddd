#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "json/json.hpp"
#include "view/embedded.hpp"
#include "view/protocol/frame_writer.hpp"
#include "view/recording/encodings.hpp"
#include "view/recording/recorder.hpp"
#include "view/session/session.hpp"

namespace slalom::view {
namespace {

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

void Session::join(std::uint64_t client) {
  audience_.tell_text(client, hello());
  server_.send(client, {scene_, true});
  audience_.tell_text(client, options_message(options_facts()));
  audience_.tell_text(client, state());
  if (std::exchange(waiting_, false)) pace_.due = Clock::now();
  if (!timeline_.empty()) server_.publish(client, timeline_.frame(shown_tick()));
}

void Session::tell() {
  if (std::exchange(are_options_changed_, false)) audience_.tell_text(0, options_message(options_facts()));
  audience_.tell_text(0, state());
}

std::string Session::hello() const {
  return hello_message(*facts_, options_.choices, stored_seconds, control_period());
}

std::string Session::state() const {
  DriveState now = state_;
  now.names.method = driver().method;
  now.rate = rate_;
  now.pace = measured_rate_;
  now.paused = paused_;
  now.generation = generation_;
  now.time = drives_->world().time();
  now.tick = shown_tick();
  now.newest = timeline_.newest();
  now.oldest = timeline_.oldest();
  now.edited = drives_->edited;
  now.ghost = drives_->ghost ? drives_->ghost->setup().driver.method : "";
  now.ghost_label = drives_->ghost_label;
  now.control_period = control_period();
  return state_message(now);
}

OptionsFacts Session::options_facts() const {
  ScenarioNames names = state_.names;
  names.method = driver().method;
  return {.names = names,
          .sections = sections_of(driver().configuration, names.method),
          .fixes_seed = true,
          .loaded = loaded_texts_,
          .further_arguments = options_.further_arguments,
          .undo = undo_.size(),
          .redo = redo_.size()};
}

/// Sends the last minute to a client as a file, which a thread makes while the drive continues.
void Session::save(std::uint64_t client, const std::string& what) {
  const bool is_replay = what == "replay";
  if (!is_replay && what != "recording") throw std::invalid_argument("what: must be recording or replay");
  if (timeline_.empty()) throw std::invalid_argument("nothing has been driven yet");
  if (saving_.valid() && saving_.wait_for(std::chrono::seconds(0)) != std::future_status::ready)
    throw std::invalid_argument("the previous file is still being written");
  const auto tell_drive = [hello = hello(), course = scene_, options = options_message(options_facts()),
                           state = state(), ticks = timeline_.stored(), packing = packing()](auto& to) {
    to.add_text(hello);
    to.add_course(*course);
    to.add_text(options);
    to.add_text(state);
    for (const DrivenTick& tick : ticks) to.add_frame(*tick.message(packing));
    to.finish();
  };
  const sim::WorldOptions world = setup().environment->world_options();
  const Json settings = {{"command_line", command_line(options_facts())}};
  const RecorderOptions recorder_options{.program = options_.program,
                                         .settings = {{"settings", json_text(settings)}},
                                         .lidar_angle_min = world.lidar.angle_min(),
                                         .lidar_angle_increment = world.lidar.angle_increment(),
                                         .everything = options_.record_all,
                                         .wall_clock = options_.record_times};
  const std::string name = "slalom-" + setup().environment->course.name + "-" + driver().method + "-" +
                           std::to_string(timeline_.newest()) + (is_replay ? ".html" : ".mcap");
  saving_ = std::async(std::launch::async, [=, this] {
    try {
      std::string file;
      if (is_replay) {
        std::vector<std::string> segments;
        ReplaySegments replay([&](std::string segment) { segments.push_back(std::move(segment)); },
                              options_.record_all);
        tell_drive(replay);
        file = replay_page(gunzip(page_gzip()), segments);
      } else {
        std::ostringstream stream;
        Recorder recorder(stream, recorder_options);
        tell_drive(recorder);
        file = std::move(stream).str();
      }
      server_.send(client, {shared(file_message(name, file)), true});
    } catch (const std::exception& error) {
      audience_.tell(client, {{"type", "error"}, {"message", error.what()}});
    }
  });
}

}  // namespace slalom::view
