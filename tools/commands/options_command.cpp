#include <iostream>
#include <memory>

#include "json/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/scenario/scenario.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

struct OptionsArguments {
  ScenarioArguments scenario;
  std::string method, json;
  bool yaml = false;
};

std::string range_text(const OptionEntry& entry) {
  if (!entry.choices.empty()) {
    std::string all;
    for (const auto& choice : entry.choices) all += (all.empty() ? "" : " | ") + choice;
    return all;
  }
  const Declaration& d = entry.declaration;
  if (std::isinf(d.min) && std::isinf(d.max)) return "";
  if (std::isinf(d.max)) return ">= " + to_text(d.min);
  if (std::isinf(d.min)) return "<= " + to_text(d.max);
  return to_text(d.min) + " .. " + to_text(d.max);
}

Json entry_json(const OptionEntry& entry, const OptionEntry& standard) {
  const Declaration& d = entry.declaration;
  Json json = {{"name", d.name},
               {"type", type_name(entry)},
               {"value", to_text(entry.value)},
               {"default", to_text(standard.value)},
               {"unit", d.unit},
               {"symbol", d.symbol},
               {"help", d.help},
               {"min", d.min},
               {"max", d.max}};
  if (!entry.choices.empty()) json["choices"] = entry.choices;
  return json;
}

void print_section(const vehicle::Section& section) {
  std::printf("%s\n", section.name.c_str());
  for (const OptionEntry& entry : section.options) {
    const Declaration& d = entry.declaration;
    std::string what = d.help;
    if (*d.symbol) what += std::string(what.empty() ? "" : " ") + "(" + d.symbol + ")";
    std::printf("  %-26s %12s %-8s %-22s %s\n", d.name, to_text(entry.value).c_str(), d.unit,
                range_text(entry).c_str(), what.c_str());
  }
}

void options(const OptionsArguments& arguments) {
  const std::string method = arguments.method.empty() ? solver_names().front() : arguments.method;
  const auto configuration = load_configuration(arguments.scenario, method);
  if (arguments.yaml) {
    std::cout << vehicle::to_yaml(configuration);
    return;
  }
  auto standard = vehicle::list_sections(vehicle::Configuration{});
  auto sections = vehicle::list_sections(configuration);
  // Options of the simulated world belong to an evaluation, not to a configuration.
  for (auto* list : {&standard, &sections})
    list->push_back({"world", list_options(evaluation::LapSettings{})});
  Json json;
  for (std::size_t s = 0; s < sections.size(); ++s) {
    const auto& section = sections[s];
    const bool wanted = arguments.method.empty() || section.name == arguments.method ||
                        section.name == "vehicle" || section.name == "planner" || section.name == "world";
    if (!wanted) continue;
    Json entries = Json::array();
    for (std::size_t i = 0; i < section.options.size(); ++i)
      entries.push_back(entry_json(section.options[i], standard[s].options[i]));
    json[section.name] = std::move(entries);
    if (arguments.json.empty()) print_section(section);
  }
  if (!arguments.json.empty()) write_json(json, arguments.json);
}

struct ExplainArguments {
  int figure = 0;  ///< 0: not given
  std::string plot;
  std::uint64_t seed = 0;
};

}  // namespace

void declare_options(Subcommand& command) {
  command.summary("List all options with values, units and ranges");
  const auto arguments = std::make_shared<OptionsArguments>();
  command.option("--config", arguments->scenario.config, config_help);
  command.option("--set", arguments->scenario.set, "section.option=value; may be repeated");
  command.option("--method", arguments->method,
                 "Only the options of this method, vehicle, planner and world");
  command.json(arguments->json, "the options");
  command.flag("--yaml", arguments->yaml, "Print the complete configuration as YAML",
               {.excludes = {"--method", "--json"}});
  command.examples({"options --method svg_mppi", "options --config race --yaml"});
  command.action([arguments] {
    options(*arguments);
    return 0;
  });
}

void declare_explain(Subcommand& command) {
  command.summary(
      "Draw a figure of the SVG-MPPI paper: how methods solve a problem with two equally good ways, by the "
      "Python package and matplotlib");
  const auto arguments = std::make_shared<ExplainArguments>();
  command.option("--figure", arguments->figure, "Figure of the paper: 1, 3 or 4",
                 {.least = 1, .most = 4, .required = true});
  command.option("--plot", arguments->plot, "Write the figure to this PNG, SVG or PDF", {.required = true});
  command.option("--seed", arguments->seed, "Seed of the random numbers");
  command.examples({"explain --figure 4 --plot figure.png"});
  command.action([arguments] {
    if (arguments->figure == 2) throw CommandLineError("--figure", "'2' must be 1, 3 or 4");
    become_python("paper_figures");
    return 0;
  });
}

}  // namespace slalom::tools
