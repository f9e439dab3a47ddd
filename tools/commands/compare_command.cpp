#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/results.hpp"
#include "src/evaluation/json.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/terminal/json_output.hpp"

namespace slalom::tools {
namespace {

using namespace evaluation;
namespace fs = std::filesystem;

struct CompareArguments {
  std::string first, second, json;
};

/// An experiment with its laps, in their order.
struct Side {
  Experiment experiment;
  std::vector<LapRow> rows;
};

Side side_of(const StoredEvaluation& stored, std::size_t experiment) {
  Side side{stored.experiments[experiment], {}};
  for (const LapRow& row : stored.rows)
    if (row.experiment == static_cast<int>(experiment)) side.rows.push_back(row);
  std::sort(side.rows.begin(), side.rows.end(),
            [](const LapRow& a, const LapRow& b) { return a.lap < b.lap; });
  return side;
}

/// An experiment of both evaluations.
struct Match {
  std::string place;  ///< the evaluation's name, where folders of several are compared
  std::string name;
  Side a, b;
  ExperimentResult result_a = {}, result_b = {};
  bool paired = false;  ///< lap k of both has the same seed: the same obstacles
  double ms_p = 1, success_p = 1, collision_p = 1;
};

ExperimentResult result_of(const Side& side) {
  std::vector<LapRow> rows = side.rows;
  for (LapRow& row : rows) row.experiment = 0;
  return summarise(rows, {side.experiment}).front();
}

Match match(const std::string& place, Side a, Side b, bool paired) {
  const std::string label = a.experiment.label(), other = b.experiment.label();
  Match m{.place = place,
          .name = label == other ? label : label + " | " + other,
          .a = std::move(a),
          .b = std::move(b),
          .paired = paired};
  m.result_a = result_of(m.a);
  m.result_b = result_of(m.b);
  if (m.paired) {
    std::vector<LapRow> both;
    for (int experiment = 0; const Side* side : {&m.a, &m.b}) {
      for (LapRow row : side->rows) {
        row.experiment = experiment;
        both.push_back(row);
      }
      ++experiment;
    }
    Experiment second = m.a.experiment;
    second.laps = m.b.experiment.laps;
    const PairedComparison c = compare_pairs(both, {m.a.experiment, second}).front();
    m.ms_p = c.ms_p;
    m.success_p = c.success_p;
    m.collision_p = c.collision_p;
    return m;
  }
  const auto costs = [](const Side& side) {
    std::vector<double> list;
    for (const LapRow& row : side.rows) list.push_back(row.mean_sequence_cost());
    return list;
  };
  const auto successes = [](const Side& side) {
    return std::count_if(side.rows.begin(), side.rows.end(), [](const LapRow& row) { return row.success; });
  };
  const auto obstacles = [](const Side& side, const ExperimentResult& result) {
    return std::int64_t{side.experiment.obstacles} * result.laps;
  };
  m.ms_p = bootstrap_difference_p(costs(m.a), costs(m.b));
  m.success_p = fisher_p(successes(m.a), m.result_a.laps, successes(m.b), m.result_b.laps);
  m.collision_p = fisher_p(m.result_a.collisions, obstacles(m.a, m.result_a), m.result_b.collisions,
                           obstacles(m.b, m.result_b));
  return m;
}

/// For each name and scenario, the comparison of the laps of all places where they are paired.
std::vector<Match> together(const std::vector<Match>& matches) {
  std::vector<Match> sums;
  std::vector<bool> taken(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (taken[i] || !matches[i].paired) continue;
    Side a{matches[i].a.experiment, {}}, b{matches[i].b.experiment, {}};
    int places = 0;
    for (std::size_t j = i; j < matches.size(); ++j) {
      const Match& other = matches[j];
      if (!other.paired || other.name != matches[i].name ||
          other.a.experiment.scenario != a.experiment.scenario ||
          other.a.experiment.obstacles != a.experiment.obstacles)
        continue;
      taken[j] = true;
      // The laps of each place get numbers of their own, so that pairs remain pairs.
      for (auto [from, to] : {std::pair{&other.a, &a}, std::pair{&other.b, &b}}) {
        for (LapRow row : from->rows) {
          row.lap += places * 1'000'000;
          to->rows.push_back(row);
        }
      }
      ++places;
    }
    a.experiment.laps = static_cast<int>(a.rows.size());
    b.experiment.laps = static_cast<int>(b.rows.size());
    if (places > 1) sums.push_back(match("all " + std::to_string(places), std::move(a), std::move(b), true));
  }
  return sums;
}

Json differing_settings(const Json& a, const Json& b) {
  Json list = Json::array();
  const auto fa = a.flatten(), fb = b.flatten();
  for (const auto& [key, value] : fa.items())
    if (key.rfind("/experiments", 0) != 0 && (!fb.contains(key) || fb[key] != value))
      list.push_back(
          {{"setting", key.substr(1)}, {"first", value}, {"second", fb.contains(key) ? fb[key] : Json()}});
  for (const auto& [key, value] : fb.items())
    if (key.rfind("/experiments", 0) != 0 && !fa.contains(key))
      list.push_back({{"setting", key.substr(1)}, {"first", nullptr}, {"second", value}});
  return list;
}

std::string p_text(double p) {
  if (!std::isfinite(p)) return "-";
  if (p < 0.001) return "< 0.001 *";
  char text[32];
  std::snprintf(text, sizeof text, "%.3f%s", p, p < 0.05 ? " *" : "");
  return text;
}

void print(const std::vector<Match>& matches, std::FILE* out) {
  std::size_t width = 10;
  const auto title = [](const Match& m) { return m.place.empty() ? m.name : m.place + ": " + m.name; };
  for (const Match& m : matches) width = std::max(width, title(m).size());
  std::fprintf(out, "%-*s     %11s %20s %20s %-10s %17s %-10s %17s %-10s %s\n", static_cast<int>(width), "",
               "laps", "MS", "MS", "p", "collisions", "p", "success, %", "p", "");
  for (const Match& m : matches) {
    const auto ms = [](const ExperimentResult& r) {
      char text[48];
      std::snprintf(text, sizeof text, "%.3f (%.3f-%.3f)", r.ms_mean, r.ms_ci.low, r.ms_ci.high);
      return std::string(text);
    };
    std::fprintf(out, "%-*s %-3s %5d %5d %20s %20s %-10s %8d %8d %-10s %8.1f %8.1f %-10s %s\n",
                 static_cast<int>(width), title(m).c_str(), m.a.experiment.scenario.c_str(), m.result_a.laps,
                 m.result_b.laps, ms(m.result_a).c_str(), ms(m.result_b).c_str(), p_text(m.ms_p).c_str(),
                 m.result_a.collisions, m.result_b.collisions, p_text(m.collision_p).c_str(),
                 100 * m.result_a.success_rate, 100 * m.result_b.success_rate, p_text(m.success_p).c_str(),
                 m.paired ? "paired" : "unpaired");
  }
}

std::vector<Match> match_all(const std::string& place, const StoredEvaluation& a, const StoredEvaluation& b,
                             bool paired) {
  std::vector<Match> matches;
  const auto with = [&](bool exactly) {
    for (std::size_t i = 0; i < a.experiments.size(); ++i) {
      for (std::size_t j = 0; j < b.experiments.size(); ++j) {
        const Experiment &ea = a.experiments[i], &eb = b.experiments[j];
        if (ea.scenario != eb.scenario || ea.obstacles != eb.obstacles) continue;
        if (!exactly || ea.label() == eb.label())
          matches.push_back(match(place, side_of(a, i), side_of(b, j), paired));
      }
    }
  };
  with(true);
  // Evaluations without a common experiment are compared experiment by experiment of the same scenario.
  if (matches.empty()) with(false);
  return matches;
}

/// The evaluations to be compared: the two folders, or those of the same name in both.
std::vector<std::string> places_of(const CompareArguments& arguments) {
  const auto is_evaluation = [](const fs::path& folder) { return fs::exists(folder / "settings.json"); };
  const fs::path first = arguments.first, second = arguments.second;
  if (is_evaluation(first) || is_evaluation(second) || !fs::is_directory(first)) return {""};
  std::vector<std::string> places;
  for (const fs::path& entry : list_folder(first))
    if (is_evaluation(entry) && is_evaluation(second / entry.filename()))
      places.push_back(entry.filename().string());
  if (places.empty())
    throw IoError(arguments.second, 0,
                  "must be an evaluation or a folder of evaluations, as " + arguments.first + " has");
  return places;
}

Json json_of(const Match& m) {
  const auto side = [](const ExperimentResult& r) {
    return Json{{"laps", r.laps},
                {"ms_mean", r.ms_mean},
                {"ms_ci", {r.ms_ci.low, r.ms_ci.high}},
                {"contacts", r.collisions},
                {"success_rate", r.success_rate}};
  };
  Json entry = Json::object();
  if (!m.place.empty()) entry["place"] = m.place;
  entry["name"] = m.name;
  entry["scenario"] = m.a.experiment.scenario;
  entry["paired"] = m.paired;
  entry["first"] = side(m.result_a);
  entry["second"] = side(m.result_b);
  entry["ms_p"] = std::isfinite(m.ms_p) ? Json(m.ms_p) : Json(nullptr);
  entry["contacts_p"] = m.collision_p;
  entry["success_p"] = m.success_p;
  return entry;
}

int compare(const CompareArguments& arguments) {
  std::FILE* words = arguments.json == "-" ? stderr : stdout;
  std::vector<Match> matches;
  Json settings = Json::array();
  for (const std::string& place : places_of(arguments)) {
    const StoredEvaluation a = load_evaluation(fs::path(arguments.first) / place),
                           b = load_evaluation(fs::path(arguments.second) / place);
    const Json sa = parse_json(a.settings), sb = parse_json(b.settings);
    const auto is_same = [&](const char* key) { return sa.value(key, Json()) == sb.value(key, Json()); };
    const bool same_world = is_same("course_hash") && is_same("evaluation") && is_same("seed0");
    auto found = match_all(place, a, b, same_world);
    if (found.empty())
      throw IoError(b.folder.string(), 0, "has no scenario that " + a.folder.string() + " has");
    for (const Match& m : found) {
      for (const auto& [side, stored] : {std::pair{&m.a, &a}, std::pair{&m.b, &b}})
        if (side->rows.empty())
          throw IoError(stored->folder.string(), 0,
                        "has no lap of " + side->experiment.label() + ", " + side->experiment.scenario +
                            "; both folders must have laps of the experiments that are compared");
    }
    matches.insert(matches.end(), found.begin(), found.end());
    for (const auto* e : {&a, &b})
      if (!e->complete) std::fprintf(words, "note: %s is not complete\n", e->folder.c_str());
    for (const auto& d : differing_settings(sa, sb))
      if (std::find(settings.begin(), settings.end(), d) == settings.end()) settings.push_back(d);
  }
  for (const auto& d : settings)
    std::fprintf(words, "%s: %s | %s\n", d["setting"].get<std::string>().c_str(),
                 json_text(d["first"]).c_str(), json_text(d["second"]).c_str());
  const auto sums = together(matches);
  matches.insert(matches.end(), sums.begin(), sums.end());
  print(matches, words);
  if (arguments.json.empty()) return 0;
  Json list = Json::array();
  for (const Match& m : matches) list.push_back(json_of(m));
  write_json(
      {{"first", arguments.first}, {"second", arguments.second}, {"settings", settings}, {"results", list}},
      arguments.json);
  return 0;
}

}  // namespace

void declare_compare(Subcommand& command) {
  command.summary("Compare two evaluations, with tests of significance");
  const auto arguments = std::make_shared<CompareArguments>();
  command.option("first", arguments->first, "Output folder of an evaluation, or a folder of several")
      .required();
  command
      .option("second", arguments->second,
              "Output folder of the other evaluation, or a folder of several; evaluations of equal name are "
              "compared")
      .required();
  command.json(arguments->json, "the comparison");
  command.action([arguments] { return compare(*arguments); });
}

}  // namespace slalom::tools
