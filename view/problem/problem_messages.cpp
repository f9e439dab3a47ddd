#include <utility>

#include "json/json.hpp"
#include "view/problem/problem_session.hpp"

namespace slalom::view {

void ProblemSession::join(std::uint64_t client) {
  if (std::exchange(waiting_, false)) {
    pace_.due = Clock::now();
    tick();
  }
  audience_.tell_text(client, hello());
  std::string scene = encode_scene(drives_->subject->facts());
  if (!scene.empty()) server_.send(client, {shared(std::move(scene)), true});
  audience_.tell_text(client, options());
  audience_.tell_text(client, state());
  if (!timeline_.empty()) server_.publish(client, timeline_.frame(shown_tick()));
}

void ProblemSession::tell() {
  audience_.tell_text(0, state());
  std::string now = options();
  if (now != std::exchange(told_options_, now)) audience_.tell_text(0, std::move(now));
}

std::string ProblemSession::hello() const {
  return hello_message(drives_->subject->facts(), choices_, stored_seconds, drives_->period);
}

std::string ProblemSession::state() {
  const SolverOptions* options = shown().options();
  return state_message({.names = {.method = options ? options->method() : ""},
                        .time = drives_->steps * drives_->period,
                        .rate = rate_,
                        .pace = measured_rate_,
                        .control_period = drives_->period,
                        .tick = shown_tick(),
                        .newest = timeline_.newest(),
                        .oldest = timeline_.oldest(),
                        .paused = paused_,
                        .edited = edited_,
                        .generation = generation_,
                        .bounds = bounds_});
}

std::string ProblemSession::options() {
  const Subject& subject = shown();
  OptionsFacts facts;
  if (const SolverOptions* now = subject.options()) {
    facts.names.method = now->method();
    facts.sections.push_back({now->method(), list_options(*now)});
    add_texts(facts.loaded, {{now->method(), list_options(loaded_.at(now->method()))}});
  }
  facts.sections.push_back({"problem", subject.parameters()});
  for (const auto& [name, text] : parameters_) facts.loaded.emplace("problem." + name, text);
  return options_message(facts);
}

}  // namespace slalom::view
