
#include "view/session/session.hpp"

#include "tools/json/json.hpp"

namespace slalom::view {

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

void Session::refuse(std::uint64_t client, const std::string& why) {
  server_.send(
      client, {std::make_shared<const std::string>(Json{{"type", "error"}, {"message", why}}.dump()), false});
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
  return hello_message(*scenario_.environment, options_.choices, options_.history,
                       simulation_->loop().runner().control_period());
}

std::string Session::state() const {
  const int newest = history_.empty() ? -1 : history_.back().tick;
  return state_message({.names = names_,
                        .environment = *scenario_.environment,
                        .laps = laps_,
                        .time = simulation_->loop().world().time(),
                        .control_period = simulation_->loop().runner().control_period(),
                        .tick = viewed_ >= 0 ? viewed_ : newest,
                        .newest = newest,
                        .oldest = history_.empty() ? -1 : history_.front().tick,
                        .paused = paused_,
                        .real_time = real_time_,
                        .edited = simulation_->edited(),
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
          .undo = undo_.size(),
          .redo = redo_.size()};
}

std::string Session::options() const {
  return options_message(options_facts());
}

std::string Session::command_line() const {
  return view::command_line(options_facts());
}

}  // namespace slalom::view
