
#include "json/json.hpp"
#include "view/session/session.hpp"

namespace slalom::view {

void Session::join(std::uint64_t client) {
  if (std::exchange(waiting_, false)) {
    pace_.due = Clock::now();
    tick();
  }
  audience_.tell_text(client, hello());
  if (scene_) server_.send(client, {scene_, true});
  audience_.tell_text(client, options_message(options_facts()));
  audience_.tell_text(client, state());
  if (!timeline_.empty()) server_.publish(client, timeline_.frame(shown_tick()));
}

void Session::tell() {
  std::string now = options_message(options_facts());
  if (now != std::exchange(told_options_, now)) audience_.tell_text(0, std::move(now));
  audience_.tell_text(0, state());
}

std::string Session::hello() const {
  std::vector<std::string> can;
  for (const auto& [word, holds] : {std::pair("place", facts().can_place),
                                    {"move", facts().can_move},
                                    {"add", facts().can_add},
                                    {"scenario", bool(options_.load)},
                                    {"real_time", facts().can_delay},
                                    {"save", bool(options_.save)},
                                    {"ghost", !settings().method.empty()},
                                    {"introduction", options_.introduction}})
    if (holds) can.emplace_back(word);
  return hello_message(facts(), options_.choices, stored_seconds, control_period(), can);
}

std::string Session::state() const {
  DriveState now = state_;
  now.laps = drives_->laps();
  now.names.method = settings().method;
  now.time = drives_->ticks() * control_period();
  now.tick = shown_tick();
  now.newest = timeline_.newest();
  now.oldest = timeline_.oldest();
  now.edited = drives_->edited;
  if (drives_->ghost) now.ghost = drives_->ghost->settings->method;
  now.ghost_label = drives_->ghost_label;
  now.control_period = control_period();
  return state_message(now);
}

OptionsFacts Session::options_facts() const {
  ScenarioNames names = state_.names;
  names.method = settings().method;
  return {.names = names,
          .sections = settings().sections,
          .fixes_seed = facts().fixes_seed,
          .loaded = loaded_,
          .further_arguments = options_.further_arguments,
          .undo = undo_.size(),
          .redo = redo_.size()};
}

/// Sends the last minute to a client as a file.
void Session::save(std::uint64_t client, const std::string& what) {
  if (what != "replay" && what != "recording")
    throw std::invalid_argument("what: must be recording or replay");
  if (timeline_.empty()) throw std::invalid_argument("nothing has been driven yet");
  options_.save(what, stored(),
                [&server = server_, client](Message message) { server.send(client, std::move(message)); });
}

/// Returns the last minute.
StoredDrive Session::stored() const {
  const OptionsFacts options = options_facts();
  return {.hello = hello(),
          .options = options_message(options),
          .state = state(),
          .scene = scene_,
          .ticks = timeline_.stored(),
          .name = "slalom-" + facts().title + "-" + options.names.method + "-" +
                  std::to_string(timeline_.newest()),
          .command_line = command_line(options),
          .scanner = facts().scanner};
}

}  // namespace slalom::view
