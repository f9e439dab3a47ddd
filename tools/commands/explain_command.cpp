#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "slalom/core/option_access.hpp"
#include "src/evaluation/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/explanation/explain_picture.hpp"
#include "tools/explanation/explanation.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

struct ExplainArguments {
  std::vector<std::string> methods{"svg_mppi"}, set;
  std::string plot, json, figure;
  std::uint64_t seed = 0;
  int solves = 10;
};

/// The methods of these names in this order; `all` stands for all methods.
std::vector<ExplainedMethod> chosen(const std::vector<std::string>& names) {
  const std::vector<ExplainedMethod> known = explained_methods();
  if (names == std::vector<std::string>{"all"}) return known;
  std::vector<ExplainedMethod> result;
  for (const std::string& name : names) {
    const auto at =
        std::find_if(known.begin(), known.end(), [&](const ExplainedMethod& m) { return m.name == name; });
    if (at == known.end()) {
      std::string all = "all";
      for (const ExplainedMethod& m : known) all += ", " + m.name;
      if (name == "all") throw CommandLineError("--method", name, "cannot be combined with other methods");
      throw CommandLineError("--method", name, "must be one of " + all);
    }
    if (std::count(names.begin(), names.end(), name) > 1)
      throw CommandLineError("--method", name, "is given twice");
    result.push_back(*at);
  }
  return result;
}

/// `key=value` for every method shown that has such an option, `problem.key=value` for the problem.
void apply(const std::string& word, std::vector<ExplainedMethod>& methods, problems::PassingPoint& point) {
  const auto equals = word.find('=');
  if (equals == std::string::npos) throw CommandLineError("--set", word, "must be key=value");
  std::string key = word.substr(0, equals);
  const std::string value = word.substr(equals + 1);
  bool found = false;
  std::vector<std::string> names;
  const auto try_on = [&](auto& options, const std::string& section) {
    for (const OptionEntry& entry : list_options(options)) names.push_back(section + entry.declaration.name);
    found = set_option(options, std::string_view(key).substr(section.size()), value) || found;
  };
  try {
    if (key.rfind("problem.", 0) == 0) {
      try_on(point, "problem.");
    } else {
      for (ExplainedMethod& method : methods) try_on(method.options, "");
    }
  } catch (const std::invalid_argument& error) {
    throw CommandLineError("--set", "key " + key + ": " + error.what());
  }
  if (found) return;
  const std::string near = nearest_name(key, names);
  throw CommandLineError(
      "--set", key,
      "must be an option of one of the methods shown" + (near.empty() ? "" : "; did you mean " + near + "?"));
}

Json to_json(const Explanation& e) {
  Json samples = Json::array(), guides = Json::array();
  const auto beside = static_cast<std::size_t>(e.beside);
  for (const ExplainedSample& s : e.samples)
    samples.push_back(
        {{"beside", s.way[beside]}, {"cost", s.cost}, {"weight", s.weight}, {"collided", s.collided}});
  for (const auto& steps : e.guides) {
    Json ways = Json::array();
    for (const Way& way : steps) ways.push_back(way);
    guides.push_back(std::move(ways));
  }
  return {{"method", e.method},
          {"status", e.status},
          {"symptom", name(e.symptom)},
          {"inputs", e.inputs},
          {"plan", e.plan},
          {"cost", e.plan_cost},
          {"collided", e.plan_collides},
          {"mean", e.mean},
          {"deviation", e.deviation},
          {"beside_state", e.beside},
          {"effective_samples", e.effective_samples},
          {"guide_ways", std::move(guides)},
          {"samples", std::move(samples)},
          {"optimal", {{"temperature", e.temperature}, {"place", e.places}, {"density", e.density}}}};
}

void explain(const ExplainArguments& arguments) {
  std::vector<ExplainedMethod> methods = chosen(arguments.methods);
  problems::PassingPoint point;
  for (const std::string& word : arguments.set) apply(word, methods, point);
  if (!arguments.figure.empty()) {
    save(draw_paper_figure(std::stoi(arguments.figure), point, arguments.seed), arguments.plot);
    return;
  }
  std::vector<Explanation> explanations;
  Json json{{"seed", arguments.seed}, {"solves", arguments.solves}, {"methods", Json::array()}};
  for (const ExplainedMethod& method : methods) {
    explanations.push_back(explain(method, point, arguments.solves, arguments.seed));
    const Explanation& e = explanations.back();
    const auto beside = static_cast<std::size_t>(e.beside);
    if (arguments.json != "-") {
      std::printf(
          "%-20s the plan %s, %.2f m %s of the disc's centre, cost %.2f; distribution there %.2f +- %.2f m\n",
          e.method.c_str(), e.plan_collides ? "hits the disc" : "passes",
          std::abs(e.plan[beside] - point.disc_y), e.plan[beside] > point.disc_y ? "left" : "right",
          e.plan_cost, e.mean[beside], e.deviation[beside]);
      if (e.symptom != Symptom::none)
        std::printf("%-20s %s: %s\n", "", name(e.symptom), explanation(e.symptom));
    }
    if (!arguments.json.empty()) json["methods"].push_back(to_json(e));
  }
  if (!arguments.json.empty()) write_json(json, arguments.json);
  if (!arguments.plot.empty())
    save(draw_explanations(explanations), arguments.plot, explanations.size() > 4 ? 1 : 2);
}

}  // namespace

void declare_explain(Subcommand& command) {
  command.summary(
      "Show how methods solve a problem with two equally good ways: samples, guides, plan, distribution");
  const auto arguments = std::make_shared<ExplainArguments>();
  command
      .option("--method", arguments->methods,
              "Methods, separated by commas: mppi, svg_mppi, svg_mppi_nominal, svg_mppi_covariance, "
              "reverse_mppi, sv_mpc, cem, icem, dial_mpc; or all")
      .comma_separated();
  command
      .option("--set", arguments->set,
              "option=value of the methods, or problem.option=value; may be repeated")
      .repeatable();
  command.option("--solves", arguments->solves, "Number of solves from the same state; the last is shown",
                 {1, 100000});
  command.option("--seed", arguments->seed, "Seed of the random numbers");
  command.option("--plot", arguments->plot,
                 "Write a picture of the methods side by side to this PNG, SVG or PDF");
  command.json(arguments->json, "everything");
  command.option(
      "--figure", arguments->figure,
      "Write this figure of the SVG-MPPI paper, computed for the same problem, to --plot: 1, 3 or 4");
  command.examples(
      {"explain --method svg_mppi,mppi --plot explained.png", "explain --method mppi --set temperature=0.1"});
  command.action([arguments, &command] {
    if (!arguments->figure.empty()) {
      if (arguments->figure != "1" && arguments->figure != "3" && arguments->figure != "4")
        throw CommandLineError("--figure", arguments->figure, "must be 1, 3 or 4");
      if (arguments->plot.empty()) throw CommandLineError("--figure", "needs --plot");
      for (const char* other : {"--method", "--solves", "--json"})
        if (command.given(other)) throw CommandLineError(other, "has no effect with --figure");
    }
    explain(*arguments);
    return 0;
  });
}

}  // namespace slalom::tools
