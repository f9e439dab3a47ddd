#include "compare_command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "json_output.hpp"
#include "slalom/core/error.hpp"
#include "slalom/evaluation/results.hpp"
#include "stored_evaluation.hpp"

namespace slalom::tools {
namespace {

using Json = nlohmann::ordered_json;
using namespace evaluation;

struct Arguments {
  std::string first, second, json;
};

std::vector<LapRow> rows_of(const StoredEvaluation& stored, int experiment) {
  std::vector<LapRow> rows;
  for (const LapRow& row : stored.rows)
    if (row.experiment == experiment) rows.push_back(row);
  std::sort(rows.begin(), rows.end(), [](const LapRow& a, const LapRow& b) { return a.lap < b.lap; });
  return rows;
}

/// An experiment of both.
struct Match {
  std::string name, scenario;
  int obstacles = 0;
  ExperimentResult a, b;
  bool paired = false;  ///< lap k of both has the same seed: the same obstacles
  double ms_p = 1, success_p = 1, contacts_p = 1;
};

Match match(const StoredEvaluation& a, const StoredEvaluation& b, int ia, int ib, bool same_world) {
  const Experiment &ea = a.experiments[static_cast<std::size_t>(ia)],
                   &eb = b.experiments[static_cast<std::size_t>(ib)];
  const auto ra = rows_of(a, ia), rb = rows_of(b, ib);
  Match m{.name = ea.label() == eb.label() ? ea.label() : ea.label() + " | " + eb.label(),
          .scenario = ea.scenario,
          .obstacles = ea.obstacles,
          .a = summarise(a.rows, a.experiments)[static_cast<std::size_t>(ia)],
          .b = summarise(b.rows, b.experiments)[static_cast<std::size_t>(ib)],
          .paired = same_world && ea.obstacles == eb.obstacles};
  std::vector<double> ms_a, ms_b;
  for (const LapRow& row : ra) ms_a.push_back(row.mean_sequence_cost());
  for (const LapRow& row : rb) ms_b.push_back(row.mean_sequence_cost());
  if (m.paired) {
    std::vector<LapRow> both = ra;
    for (LapRow& row : both) row.experiment = 0;
    for (LapRow row : rb) {
      row.experiment = 1;
      both.push_back(row);
    }
    const PairedComparison c =
        compare_pairs(both, {ea, {ea.method, ea.set, ea.scenario, ea.obstacles, eb.laps}}).front();
    m.ms_p = c.ms_p;
    m.success_p = c.success_p;
    m.contacts_p = c.collision_p;
  } else {
    const auto successes = [](const std::vector<LapRow>& rows) {
      return std::count_if(rows.begin(), rows.end(), [](const LapRow& row) { return row.success; });
    };
    m.ms_p = bootstrap_difference_p(ms_a, ms_b);
    m.success_p = fisher_p(successes(ra), m.a.laps, successes(rb), m.b.laps);
    m.contacts_p = fisher_p(m.a.collisions, std::int64_t{ea.obstacles} * m.a.laps, m.b.collisions,
                            std::int64_t{eb.obstacles} * m.b.laps);
  }
  return m;
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
  char text[32];
  std::snprintf(text, sizeof text, "%.4f%s", p, p < 0.05 ? " *" : "");
  return std::isfinite(p) ? text : "-";
}

void print(const std::vector<Match>& matches, std::FILE* out) {
  std::size_t width = 10;
  for (const Match& m : matches) width = std::max(width, m.name.size());
  std::fprintf(out, "%-*s     %11s %20s %20s %-10s %17s %-10s %17s %-10s %s\n", static_cast<int>(width), "",
               "laps", "MS", "MS", "p", "contacts", "p", "success, %", "p", "");
  for (const Match& m : matches) {
    const auto ms = [](const ExperimentResult& r) {
      char text[48];
      std::snprintf(text, sizeof text, "%.3f (%.3f-%.3f)", r.ms_mean, r.ms_ci.low, r.ms_ci.high);
      return std::string(text);
    };
    std::fprintf(out, "%-*s %-3s %5d %5d %20s %20s %-10s %8d %8d %-10s %8.1f %8.1f %-10s %s\n",
                 static_cast<int>(width), m.name.c_str(), m.scenario.c_str(), m.a.laps, m.b.laps,
                 ms(m.a).c_str(), ms(m.b).c_str(), p_text(m.ms_p).c_str(), m.a.collisions, m.b.collisions,
                 p_text(m.contacts_p).c_str(), 100 * m.a.success_rate, 100 * m.b.success_rate,
                 p_text(m.success_p).c_str(), m.paired ? "paired" : "unpaired");
  }
}

std::vector<Match> match_all(const StoredEvaluation& a, const StoredEvaluation& b, bool same_world) {
  std::vector<Match> matches;
  const auto with = [&](bool exactly) {
    for (int i = 0; i < static_cast<int>(a.experiments.size()); ++i) {
      for (int j = 0; j < static_cast<int>(b.experiments.size()); ++j) {
        const Experiment &ea = a.experiments[static_cast<std::size_t>(i)],
                         &eb = b.experiments[static_cast<std::size_t>(j)];
        if (ea.scenario != eb.scenario || ea.obstacles != eb.obstacles) continue;
        if (exactly ? ea.label() == eb.label() : true) matches.push_back(match(a, b, i, j, same_world));
      }
    }
  };
  with(true);
  // Two evaluations of one thing each under two names are still meant to be compared.
  if (matches.empty()) with(false);
  return matches;
}

int run(const Arguments& arguments) {
  const StoredEvaluation a = load_evaluation(arguments.first), b = load_evaluation(arguments.second);
  const Json sa = Json::parse(a.settings), sb = Json::parse(b.settings);
  const bool same_world = sa["course_hash"] == sb["course_hash"] && sa["evaluation"] == sb["evaluation"] &&
                          sa["seed0"] == sb["seed0"];
  const auto matches = match_all(a, b, same_world);
  if (matches.empty()) throw IoError(arguments.second, 0, "has no scenario that " + arguments.first + " has");
  std::FILE* words = arguments.json == "-" ? stderr : stdout;
  for (const auto* e : {&a, &b})
    if (!e->complete) std::fprintf(words, "note: %s is not complete\n", e->folder.c_str());
  const Json differing = differing_settings(sa, sb);
  for (const auto& d : differing)
    std::fprintf(words, "%s: %s | %s\n", d["setting"].get<std::string>().c_str(), d["first"].dump().c_str(),
                 d["second"].dump().c_str());
  print(matches, words);
  if (arguments.json.empty()) return 0;
  Json list = Json::array();
  for (const Match& m : matches) {
    const auto side = [](const ExperimentResult& r) {
      return Json{{"laps", r.laps},
                  {"ms_mean", r.ms_mean},
                  {"ms_ci", {r.ms_ci.low, r.ms_ci.high}},
                  {"contacts", r.collisions},
                  {"success_rate", r.success_rate}};
    };
    list.push_back({{"name", m.name},
                    {"scenario", m.scenario},
                    {"paired", m.paired},
                    {"first", side(m.a)},
                    {"second", side(m.b)},
                    {"ms_p", std::isfinite(m.ms_p) ? Json(m.ms_p) : Json(nullptr)},
                    {"contacts_p", m.contacts_p},
                    {"success_p", m.success_p}});
  }
  write_json(
      {{"first", arguments.first}, {"second", arguments.second}, {"settings", differing}, {"results", list}},
      arguments.json);
  return 0;
}

}  // namespace

CLI::App* add_compare_command(CLI::App& app, int& exit_status) {
  CLI::App* command =
      app.add_subcommand("compare", "Two evaluations side by side, with tests of significance");
  const auto arguments = std::make_shared<Arguments>();
  command->add_option("first", arguments->first, "The --out of an evaluation")->required();
  command->add_option("second", arguments->second, "That of another")->required();
  command->add_option("--json", arguments->json,
                      "Write the comparison to this file, or to standard output: -");
  command->callback([arguments, &exit_status] { exit_status = run(*arguments); });
  return command;
}

}  // namespace slalom::tools
