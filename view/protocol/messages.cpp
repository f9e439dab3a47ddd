#include "view/protocol/messages.hpp"

#include "json/json.hpp"
#include "slalom/solvers/symptom.hpp"

namespace slalom::view {
namespace {

/// Whether the page shows an option. In a scenario, a lap's seed and the program's threads take their place.
bool is_shown(const OptionsFacts& facts, const std::string& section, const std::string& option) {
  if (!facts.fixes_seed || section == "vehicle" || section == "planner") return true;
  return section == facts.names.method && option != "seed" && option != "threads";
}

/// The declaration of an option, its value, and the value that was loaded.
Json option_json(const OptionEntry& entry, const std::string& loaded) {
  const Declaration& d = entry.declaration;
  Json json = {{"name", d.name},   {"symbol", d.symbol},       {"unit", d.unit},
               {"help", d.help},   {"type", type_name(entry)}, {"value", to_text(entry.value)},
               {"default", loaded}};
  if (std::isfinite(d.min)) json["min"] = d.min;
  if (std::isfinite(d.max)) json["max"] = d.max;
  if (!entry.choices.empty()) json["choices"] = entry.choices;
  return json;
}

std::string loaded_text(const OptionsFacts& facts, const std::string& key, const OptionEntry& entry) {
  const auto found = facts.loaded.find(key);
  return found == facts.loaded.end() ? to_text(entry.value) : found->second;
}

/// "section.option=value" of all that differs from what was loaded.
std::vector<std::string> changed_options(const OptionsFacts& facts) {
  std::vector<std::string> changed;
  for (const OptionSection& section : facts.sections)
    for (const OptionEntry& entry : section.options) {
      const std::string key = section.name + "." + entry.declaration.name, now = to_text(entry.value);
      if (now != loaded_text(facts, key, entry)) changed.push_back(key + "=" + now);
    }
  return changed;
}

std::string changed_yaml(const OptionsFacts& facts, const std::vector<std::string>& changed) {
  std::string yaml = facts.names.config.empty() ? "" : "base: " + facts.names.config + "\n", section;
  for (const std::string& each : changed) {
    const auto dot = each.find('.'), equals = each.find('=');
    if (each.substr(0, dot) != section) {
      section = each.substr(0, dot);
      yaml += section + ":\n";
    }
    yaml += "  " + each.substr(dot + 1, equals - dot - 1) + ": " + each.substr(equals + 1) + "\n";
  }
  return yaml;
}

Json statuses_json(const SubjectFacts& facts) {
  if (!facts.statuses.empty()) return facts.statuses;
  Json names = Json::array();
  for (int i = 0; i <= static_cast<int>(Status::invalid_time); ++i)
    names.push_back(name(static_cast<Status>(i)));
  return names;
}

/// The names of all symptoms of a solve and what they mean, by their values.
Json symptoms_json() {
  Json symptoms = Json::array();
  for (int i = 0; i <= static_cast<int>(Symptom::no_progress); ++i) {
    const auto symptom = static_cast<Symptom>(i);
    symptoms.push_back({{"name", name(symptom)}, {"explanation", explanation(symptom)}});
  }
  return symptoms;
}

}  // namespace

int Choices::method_index(const std::string& method) const {
  return static_cast<int>(std::find(methods.begin(), methods.end(), method) - methods.begin());
}

std::string hello_message(const SubjectFacts& facts, const Choices& choices, double history,
                          double control_period, const std::vector<std::string>& can) {
  Json hello = {
      {"type", "hello"},
      {"protocol", 2},
      {"title", facts.title.empty() ? "your problem" : facts.title},
      {"scalars", scalar_names(facts)},
      {"statuses", statuses_json(facts)},
      {"symptoms", symptoms_json()},
      {"courses", choices.courses},
      {"methods", choices.methods},
      {"configurations", choices.configurations},
      {"terms", facts.terms},
      {"states", facts.states},
      {"inputs", facts.inputs},
      {"body",
       {{"length", facts.length}, {"width", facts.width}, {"front", facts.front}, {"rear", facts.rear}}},
      {"can", can},
      {"history_seconds", history},
      {"control_period", control_period}};
  if (const auto& scanner = facts.scanner)
    hello["lidar"] = {{"angle_min", scanner->angle_min},
                      {"angle_increment", scanner->angle_increment},
                      {"range_max", scanner->range_max}};
  return json_text(hello);
}

void add_texts(OptionTexts& to, const std::vector<OptionSection>& sections) {
  for (const OptionSection& section : sections)
    for (const OptionEntry& entry : section.options)
      to.emplace(section.name + "." + entry.declaration.name, to_text(entry.value));
}

std::string options_message(const OptionsFacts& facts) {
  Json sections = Json::array();
  for (const OptionSection& section : facts.sections) {
    Json options = Json::array();
    for (const OptionEntry& entry : section.options) {
      const std::string option = entry.declaration.name;
      if (is_shown(facts, section.name, option))
        options.push_back(option_json(entry, loaded_text(facts, section.name + "." + option, entry)));
    }
    if (!options.empty()) sections.push_back({{"name", section.name}, {"options", options}});
  }
  const std::vector<std::string> changed = changed_options(facts);
  return json_text({{"type", "options"},
                    {"sections", sections},
                    {"changed", changed},
                    {"command_line", command_line(facts)},
                    {"yaml", changed_yaml(facts, changed)},
                    {"undo", facts.undo},
                    {"redo", facts.redo}});
}

std::string command_line(const OptionsFacts& facts) {
  const ScenarioNames& names = facts.names;
  if (names.course.empty()) return "";
  std::string line = "slalom drive --course " + names.course + " --method " + names.method + " --config " +
                     names.config + " --seed " + std::to_string(names.seed) + " --obstacles " +
                     std::to_string(names.obstacles) +
                     (names.opponents > 0 ? " --opponents " + std::to_string(names.opponents) : "") +
                     facts.further_arguments;
  for (const std::string& each : changed_options(facts)) line += " --set '" + each + "'";
  return line;
}

std::string state_message(const DriveState& facts) {
  Json laps = Json::array();
  for (const DrivenLap& lap : facts.laps)
    laps.push_back({{"lap", lap.lap},
                    {"time", lap.time},
                    {"contacts", lap.contacts},
                    {"method", lap.method},
                    {"ghost", lap.ghost}});
  const ScenarioNames& names = facts.names;
  const Bounds& b = facts.bounds;
  return json_text({{"type", "state"},
                    {"course", names.course},
                    {"description", names.description},
                    {"length", names.length},
                    {"method", names.method},
                    {"config", names.config},
                    {"evaluation", names.evaluation},
                    {"seed", std::to_string(names.seed)},
                    {"obstacles", names.obstacles},
                    {"opponents", names.opponents},
                    {"paused", facts.paused},
                    {"real_time", facts.real_time},
                    {"rate", facts.rate},
                    {"pace", facts.pace},
                    {"tick", facts.tick},
                    {"newest", facts.newest},
                    {"oldest", facts.oldest},
                    {"time", facts.time},
                    {"control_period", facts.control_period},
                    {"laps", laps},
                    {"ghost", facts.ghost},
                    {"ghost_label", facts.ghost_label},
                    {"generation", facts.generation},
                    {"edited", facts.edited},
                    {"bounds", {b.x0, b.y0, b.x1, b.y1}}});
}

}  // namespace slalom::view
