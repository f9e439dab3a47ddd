#include <algorithm>
#include <utility>

#include "json/json.hpp"
#include "view/problem/problem_session.hpp"
#include "view/protocol/page_json.hpp"

namespace slalom::view {
void ProblemSession::join(std::uint64_t client) {
  if (std::exchange(waiting_, false)) {
    pace_.due = Clock::now();
    tick();
  }
  audience_.tell(client, hello());
  if (const auto& map = drives_->subject->facts().map) {
    FrameWriter scene;
    scene.put_grid(*map);
    server_.send(client, {shared(scene.take()), true});
  }
  audience_.tell(client, options());
  audience_.tell(client, state());
  if (!timeline_.empty()) server_.publish(client, timeline_.frame(shown_tick()));
}

void ProblemSession::tell() {
  audience_.tell(0, state());
  std::string now = json_text(options());
  if (now != std::exchange(told_options_, now)) audience_.tell_text(0, std::move(now));
}

Json ProblemSession::hello() const {
  const SubjectFacts& facts = drives_->subject->facts();
  Json can = Json::array();
  if (facts.can_place) can.push_back("place");
  if (facts.can_move) can.push_back("move");
  return {{"type", "hello"},
          {"protocol", 2},
          {"title", facts.title.empty() ? "your problem" : facts.title},
          {"scalars", problem_scalars(facts)},
          {"statuses", facts.statuses.empty() ? names_json(Status::invalid_time) : Json(facts.statuses)},
          {"symptoms", symptoms_json()},
          {"courses", Json::array()},
          {"methods", methods_},
          {"configurations", Json::array()},
          {"terms", facts.terms},
          {"states", facts.states},
          {"inputs", facts.inputs},
          {"body", body_json(facts.length, facts.width)},
          {"can", can},
          {"history_seconds", stored_seconds},
          {"control_period", drives_->period}};
}

Json ProblemSession::state() {
  const SolverOptions* options = shown().options();
  return {{"type", "state"},
          {"course", ""},
          {"description", ""},
          {"length", 0},
          {"method", options ? options->method() : ""},
          {"config", ""},
          {"evaluation", ""},
          {"seed", "0"},
          {"obstacles", 0},
          {"opponents", 0},
          {"paused", paused_},
          {"real_time", false},
          {"rate", rate_},
          {"pace", measured_rate_},
          {"tick", shown_tick()},
          {"newest", timeline_.newest()},
          {"oldest", timeline_.oldest()},
          {"time", drives_->steps * drives_->period},
          {"control_period", drives_->period},
          {"laps", Json::array()},
          {"ghost", ""},
          {"ghost_label", ""},
          {"generation", generation_},
          {"edited", edited_},
          {"introduction", false},
          {"bounds", bounds_json(bounds_)}};
}

Json ProblemSession::options() {
  const Subject& subject = shown();
  Json sections = Json::array(), changed = Json::array();
  std::string yaml, section_yaml;
  const auto add = [&](const std::string& name, const std::vector<OptionEntry>& now, const auto& loaded) {
    Json options = Json::array();
    section_yaml.clear();
    for (const OptionEntry& each : now) {
      const std::string option = each.declaration.name, value = to_text(each.value);
      options.push_back(option_json(each, loaded(option)));
      if (value == loaded(option)) continue;
      changed.push_back(name + "." + option + "=" + value);
      section_yaml += "  " + option + ": " + value + "\n";
    }
    if (!options.empty()) sections.push_back({{"name", name}, {"options", options}});
    if (!section_yaml.empty()) yaml += name + ":\n" + section_yaml;
  };
  if (const SolverOptions* now = subject.options()) {
    const auto before = list_options(loaded_.at(now->method()));
    add(now->method(), list_options(*now), [&](const std::string& option) {
      const auto found = std::find_if(before.begin(), before.end(),
                                      [&](const OptionEntry& e) { return option == e.declaration.name; });
      return to_text(found->value);
    });
  }
  add("problem", subject.parameters(), [&](const std::string& option) { return parameters_.at(option); });
  return {{"type", "options"},  {"sections", sections}, {"changed", changed},
          {"command_line", ""}, {"yaml", yaml},         {"undo", 0},
          {"redo", 0}};
}

}  // namespace slalom::view
