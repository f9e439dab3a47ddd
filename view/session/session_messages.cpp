
#include "view/session/session.hpp"

#include <algorithm>
#include <string_view>

#include "src/evaluation/json.hpp"
#include "view/protocol/frame_writer.hpp"

namespace slalom::view {
namespace {

constexpr int max_ticks_per_message = 800;  // ticks in one message

/// The values of the scalars of a frame, as they stand in it.
std::string_view scalars_of(const std::string& frame) {
  return std::string_view(frame).substr(FrameWriter::head_bytes, 8 * scalar_names().size());
}

}  // namespace

void Session::greet(std::uint64_t client) {
  server_.send(client, {std::make_shared<const std::string>(hello()), false});
  server_.send(client, {scene_, true});
  server_.send(client, {std::make_shared<const std::string>(options()), false});
  server_.send(client, {std::make_shared<const std::string>(state()), false});
  if (!options_.evaluation.empty())
    server_.send(client, {std::make_shared<const std::string>(options_.evaluation), false});
  if (waiting_) {
    waiting_ = false;
    due_ = Clock::now();
  }
  if (!history_.empty()) {
    const auto at =
        viewed_ >= 0 ? static_cast<std::size_t>(viewed_ - history_.front().tick) : history_.size() - 1;
    server_.publish(client, history_[at].frame);
  }
  state_changed_ = true;
}

void Session::refuse(std::uint64_t client, const std::string& why, const Json& id) {
  Json message = {{"type", "error"}, {"message", why}};
  if (!id.is_null()) message["id"] = id;
  server_.send(client, {std::make_shared<const std::string>(message.dump()), false});
}

/// Answers a command that has an `id`.
void Session::tell_done(std::uint64_t client, const Json& id) {
  const Json message = {{"type", "done"}, {"id", id}};
  server_.send(client, {std::make_shared<const std::string>(message.dump()), false});
}

/// Sends the scalars of past ticks, of as many as a message holds and as are still known.
void Session::tell_past(std::uint64_t client, int from, int to) {
  FrameWriter past;
  past.begin(Block::past);
  if (!history_.empty()) {
    const int oldest = history_.front().tick;
    to = std::min(to, history_.back().tick);
    from = std::max({from, oldest, to - max_ticks_per_message + 1});
    for (int tick = from; tick <= to; ++tick)
      past.append(scalars_of(history_[static_cast<std::size_t>(tick - oldest)].without_bodies));
  }
  past.end();
  server_.send(client, {std::make_shared<const std::string>(past.take()), true});
}

void Session::note(const std::string& what) {
  const Json json = {{"type", "note"}, {"message", what}};
  server_.broadcast({std::make_shared<const std::string>(json.dump()), false});
}

void Session::tell_state() {
  state_changed_ = false;
  server_.broadcast({std::make_shared<const std::string>(state()), false});
}

void Session::tell_options() {
  server_.broadcast({std::make_shared<const std::string>(options()), false});
}

std::string Session::hello() const {
  return hello_message(*scenario_.environment, options_.choices,
                       {.session = number_,
                        .history = options_.history,
                        .control_period = simulation_->loop().setup().control_period()});
}

std::string Session::state() const {
  const int newest = history_.empty() ? -1 : history_.back().tick;
  return state_message({.names = names_,
                        .environment = *scenario_.environment,
                        .laps = laps_,
                        .time = simulation_->loop().world().time(),
                        .control_period = simulation_->loop().setup().control_period(),
                        .tick = viewed_ >= 0 ? viewed_ : newest,
                        .newest = newest,
                        .oldest = history_.empty() ? -1 : history_.front().tick,
                        .paused = paused_,
                        .real_time = real_time_,
                        .edited = simulation_->edited(),
                        .introduction = introduces_,
                        .rate = rate_,
                        .ghost = ghost_method_,
                        .ghost_label = ghost_label_,
                        .generation = generation_,
                        .clients = server_.clients(),
                        .refused = refused_,
                        .contact = contact_});
}

OptionsFacts Session::options_facts() const {
  return {.names = names_,
          .now = configuration_,
          .loaded = scenario_.configuration,
          .further_arguments = options_.further_arguments,
          .undo = undo_.undos(),
          .redo = undo_.redos()};
}

std::string Session::options() const {
  return options_message(options_facts());
}

std::string Session::command_line() const {
  return view::command_line(options_facts());
}

}  // namespace slalom::view
