#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/results.hpp"
#include "src/evaluation/json.hpp"
#include "tools/command_line/words.hpp"
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

/// An experiment of both evaluations, and its laps in both: the row's experiment is 0 or 1.
struct Match {
  std::string place;  ///< name of the evaluation, where folders of several are compared
  std::vector<Experiment> experiments;
  std::vector<LapRow> rows;
  bool is_paired;  ///< lap k of both has the same seed: the same obstacles
  std::vector<ExperimentResult> results = {};
  double ms_p = 1, success_p = 1, collision_p = 1;

  std::string name() const {
    const std::string first = experiments[0].label(), second = experiments[1].label();
    return first == second ? first : first + " | " + second;
  }
};

/// Compares the laps of a match.
void evaluate(Match& m) {
  std::stable_sort(m.rows.begin(), m.rows.end(),
                   [](const LapRow& a, const LapRow& b) { return a.lap < b.lap; });
  m.results = summarise(m.rows, m.experiments);
  if (m.is_paired) {
    Experiment second = m.experiments[0];
    second.laps = m.experiments[1].laps;
    const PairedComparison c = compare_pairs(m.rows, {m.experiments[0], second}).front();
    m.ms_p = c.ms_p;
    m.success_p = c.success_p;
    m.collision_p = c.collision_p;
    return;
  }
  std::array<std::vector<double>, 2> costs;
  std::array<std::int64_t, 2> successes{}, obstacles{};
  for (const LapRow& row : m.rows) {
    const auto side = static_cast<std::size_t>(row.experiment);
    costs[side].push_back(row.mean_sequence_cost());
    successes[side] += row.success;
    obstacles[side] += m.experiments[side].obstacles;
  }
  const auto &a = m.results[0], &b = m.results[1];
  m.ms_p = bootstrap_difference_p(costs[0], costs[1]);
  m.success_p = fisher_p(successes[0], a.laps, successes[1], b.laps);
  m.collision_p = fisher_p(a.collisions, obstacles[0], b.collisions, obstacles[1]);
}

/// For each name and scenario, the comparison of the laps of all places where they are paired.
std::vector<Match> together(const std::vector<Match>& matches) {
  std::vector<Match> sums;
  std::vector<bool> taken(matches.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (taken[i] || !matches[i].is_paired) continue;
    Match sum{"", matches[i].experiments, {}, true};
    const Experiment& first = sum.experiments[0];
    int places = 0;
    for (std::size_t j = i; j < matches.size(); ++j) {
      const Match& other = matches[j];
      const Experiment& own = other.experiments[0];
      if (!other.is_paired || other.name() != matches[i].name() || own.scenario != first.scenario ||
          own.obstacles != first.obstacles)
        continue;
      taken[j] = true;
      // The laps of each place get numbers of their own, so that pairs remain pairs.
      for (LapRow row : other.rows) {
        row.lap += places * 1'000'000;
        sum.rows.push_back(row);
      }
      ++places;
    }
    if (places < 2) continue;
    for (Experiment& experiment : sum.experiments) experiment.laps = 0;
    for (const LapRow& row : sum.rows) ++sum.experiments[static_cast<std::size_t>(row.experiment)].laps;
    sum.place = "all " + std::to_string(places);
    evaluate(sum);
    sums.push_back(std::move(sum));
  }
  return sums;
}

Json differing_settings(const Json& a, const Json& b) {
  Json list = Json::array();
  const Json first = a.flatten(), second = b.flatten();
  Json all = first;
  all.update(second);
  for (const auto& each : all.items()) {
    const std::string& key = each.key();
    const Json ours = first.value(key, Json()), theirs = second.value(key, Json());
    if (key.rfind("/experiments", 0) != 0 && ours != theirs)
      list.push_back({{"setting", key.substr(1)}, {"first", ours}, {"second", theirs}});
  }
  return list;
}

std::string p_text(double p) {
  if (!std::isfinite(p)) return "-";
  return p < 0.001 ? "< 0.001 *" : formatted("%.3f%s", p, p < 0.05 ? " *" : "");
}

void print(const std::vector<Match>& matches, std::FILE* out) {
  std::size_t width = 10;
  const auto title = [](const Match& m) { return m.place.empty() ? m.name() : m.place + ": " + m.name(); };
  for (const Match& m : matches) width = std::max(width, title(m).size());
  std::fprintf(out, "%-*s     %11s %20s %20s %-10s %17s %-10s %17s %-10s %s\n", static_cast<int>(width), "",
               "laps", "MS", "MS", "p", "collisions", "p", "success, %", "p", "");
  for (const Match& m : matches) {
    const ExperimentResult &a = m.results[0], &b = m.results[1];
    const auto ms = [](const ExperimentResult& r) {
      return r.laps < fewest_laps ? formatted("%.3f", r.ms_mean)
                                  : formatted("%.3f (%.3f-%.3f)", r.ms_mean, r.ms_ci.low, r.ms_ci.high);
    };
    std::fprintf(out, "%-*s %-3s %5d %5d %20s %20s %-10s %8d %8d %-10s %8.1f %8.1f %-10s %s\n",
                 static_cast<int>(width), title(m).c_str(), m.experiments[0].scenario.c_str(), a.laps, b.laps,
                 ms(a).c_str(), ms(b).c_str(), p_text(m.ms_p).c_str(), a.collisions, b.collisions,
                 p_text(m.collision_p).c_str(), 100 * a.success_rate, 100 * b.success_rate,
                 p_text(m.success_p).c_str(), m.is_paired ? "paired" : "unpaired");
  }
}

/// The match of an experiment of each evaluation. Throws IoError if one has no laps.
Match match(const std::string& place, const StoredEvaluation& a, std::size_t i, const StoredEvaluation& b,
            std::size_t j, bool is_paired) {
  Match made{place, {a.experiments[i], b.experiments[j]}, {}, is_paired};
  for (int side = 0; const auto& [stored, index] : {std::pair(&a, i), std::pair(&b, j)}) {
    const std::size_t before = made.rows.size();
    for (LapRow row : stored->rows) {
      if (row.experiment != static_cast<int>(index)) continue;
      row.experiment = side;
      made.rows.push_back(row);
    }
    const Experiment& experiment = stored->experiments[index];
    if (made.rows.size() == before)
      throw IoError(stored->folder.string(), 0,
                    "has no lap of " + experiment.label() + ", " + experiment.scenario +
                        "; both folders must have laps of the experiments that are compared");
    ++side;
  }
  evaluate(made);
  return made;
}

std::vector<Match> match_all(const std::string& place, const StoredEvaluation& a, const StoredEvaluation& b,
                             bool is_paired) {
  std::vector<Match> matches;
  // Evaluations without a common experiment are compared experiment by experiment of the same scenario.
  for (const bool exactly : {true, false}) {
    for (std::size_t i = 0; i < a.experiments.size(); ++i)
      for (std::size_t j = 0; j < b.experiments.size(); ++j) {
        const Experiment &ea = a.experiments[i], &eb = b.experiments[j];
        if (ea.scenario != eb.scenario || ea.obstacles != eb.obstacles) continue;
        if (!exactly || ea.label() == eb.label()) matches.push_back(match(place, a, i, b, j, is_paired));
      }
    if (!matches.empty()) break;
  }
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
                {"ms_ci", r.laps < fewest_laps ? Json(nullptr) : Json{r.ms_ci.low, r.ms_ci.high}},
                {"contacts", r.collisions},
                {"success_rate", r.success_rate}};
  };
  Json entry = Json::object();
  if (!m.place.empty()) entry["place"] = m.place;
  entry["name"] = m.name();
  entry["scenario"] = m.experiments[0].scenario;
  entry["paired"] = m.is_paired;
  entry["first"] = side(m.results[0]);
  entry["second"] = side(m.results[1]);
  entry["ms_p"] = m.ms_p;
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
  command.examples({"compare BEFORE AFTER", "compare BEFORE AFTER --json compared.json"});
  command.action([arguments] { return compare(*arguments); });
}

}  // namespace slalom::tools
