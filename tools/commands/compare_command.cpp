#include <map>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/results.hpp"
#include "tools/commands/commands.hpp"
#include "tools/evaluation/comparison.hpp"
#include "tools/evaluation/stored_evaluation.hpp"
#include "tools/terminal/json_output.hpp"
#include "tools/terminal/text_table.hpp"

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
  bool is_paired;                           ///< lap k of both has the same seed: the same obstacles
  bool tests_ms;                            ///< both have the same weights
  std::array<std::int64_t, 2> obstacles{};  ///< numbers of obstacles of all laps
  std::array<ExperimentResult, 2> results{};
  Comparison comparison{};

  std::string name() const {
    const std::string first = experiments[0].label(), second = experiments[1].label();
    return first == second ? first : first + " | " + second;
  }
  /// Adds the laps of another match, with numbers of their own, so that pairs remain pairs.
  void add(const Match& other, int count) {
    for (LapRow row : other.rows) {
      row.lap += count * 1'000'000;
      rows.push_back(row);
    }
    for (std::size_t side : {0U, 1U}) obstacles[side] += other.obstacles[side];
    is_paired = is_paired && other.is_paired;
    tests_ms = tests_ms && other.tests_ms;
  }
  void evaluate() {
    const auto all = summarise(rows, experiments);
    results = {all[0], all[1]};
    comparison = compare_laps(rows_of(rows, 0), obstacles[0], rows_of(rows, 1), obstacles[1], is_paired);
    if (!tests_ms) comparison.ms_p.reset();
  }
};

/// The comparison of the laps of several matches.
Match together(const std::vector<const Match*>& matches, const std::string& place) {
  Match sum{place, matches.front()->experiments, {}, true, true};
  for (int count = 0; const Match* each : matches) sum.add(*each, count++);
  sum.evaluate();
  return sum;
}

/// For each name and scenario, the comparison of the laps of all places where they are paired.
std::vector<Match> over_places(const std::vector<Match>& matches) {
  std::map<std::string, std::vector<const Match*>> alike;
  for (const Match& each : matches)
    if (each.is_paired)
      alike[each.name() + ", " + each.experiments[0].scenario + std::to_string(each.experiments[0].obstacles)]
          .push_back(&each);
  std::vector<Match> sums;
  for (const auto& [name, places] : alike)
    if (places.size() > 1) sums.push_back(together(places, "all " + std::to_string(places.size())));
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
    if (key.rfind("/experiments", 0) != 0 && key != "/checksum" && ours != theirs)
      list.push_back({{"setting", key.substr(1)}, {"first", ours}, {"second", theirs}});
  }
  return list;
}

/// Prints a match: the figures of both sides, and the p values of their differences.
void print(const Match& m, const std::array<std::string, 2>& names, std::FILE* out) {
  const auto &a = m.results[0], &b = m.results[1];
  const auto end_of = [](const std::string& name) {
    return name.size() > 26 ? name.substr(name.size() - 26) : name;
  };
  std::fprintf(out, "\n%s%s, %s, %s\n", m.place.empty() ? "" : (m.place + ": ").c_str(), m.name().c_str(),
               m.experiments[0].scenario.c_str(), m.is_paired ? "paired by lap" : "unpaired");
  const Comparison& c = m.comparison;
  TextTable table({"<", end_of(names[0]), end_of(names[1]), "<p"});
  const auto row = [&](const char* figure, const std::optional<double>& p, auto cell) {
    table.add({figure, cell(a), cell(b), p_text(p)});
  };
  table.add({"laps", std::to_string(a.laps), std::to_string(b.laps), ""});
  row("success, %", c.success_p, [](const auto& r) { return rate_cell(r.success_rate, r.success_rate_ci); });
  row("collisions", c.collisions_p, [](const auto& r) { return std::to_string(r.collisions); });
  row("lap time, s", c.time_p, [](const auto& r) { return mean_cell(r.time_mean, r.time_ci, r.finished); });
  row("MS", c.ms_p, [](const auto& r) { return mean_cell(r.ms_mean, r.ms_ci, r.laps); });
  table.print(out);
}

/// The match of an experiment of each evaluation. Throws IoError if one has no laps.
Match match(const std::string& place, const StoredEvaluation& a, std::size_t i, const StoredEvaluation& b,
            std::size_t j, bool is_paired) {
  const Json settings_a = parse_json(a.settings), settings_b = parse_json(b.settings);
  Match made{place,
             {a.experiments[i], b.experiments[j]},
             {},
             is_paired,
             same_weights(settings_a, a.experiments[i], settings_b, b.experiments[j])};
  for (int side = 0; const auto& [stored, index] : {std::pair(&a, i), std::pair(&b, j)}) {
    const std::size_t before = made.rows.size();
    for (LapRow row : stored->rows) {
      if (row.experiment != static_cast<int>(index)) continue;
      row.experiment = side;
      made.rows.push_back(row);
    }
    const Experiment& experiment = stored->experiments[index];
    made.obstacles[static_cast<std::size_t>(side)] = static_cast<std::int64_t>(experiment.obstacles) *
                                                     static_cast<std::int64_t>(made.rows.size() - before);
    if (made.rows.size() == before)
      throw IoError(stored->folder.string(), 0,
                    "has no lap of " + experiment.label() + ", " + experiment.scenario +
                        "; both folders must have laps of the experiments that are compared");
    ++side;
  }
  made.evaluate();
  return made;
}

/// The experiments of both in the same scenario: those that are the same, or else those of the same method,
/// or else all with all.
std::vector<Match> match_all(const std::string& place, const StoredEvaluation& a, const StoredEvaluation& b,
                             bool is_paired) {
  const std::function<bool(const Experiment&, const Experiment&)> rules[] = {
      [](const auto& x, const auto& y) { return x.label() == y.label(); },
      [](const auto& x, const auto& y) { return x.method == y.method; },
      [](const auto&, const auto&) { return true; }};
  std::vector<Match> matches;
  for (const auto& belong_together : rules) {
    for (std::size_t i = 0; i < a.experiments.size(); ++i)
      for (std::size_t j = 0; j < b.experiments.size(); ++j) {
        const Experiment &ea = a.experiments[i], &eb = b.experiments[j];
        if (ea.scenario == eb.scenario && ea.obstacles == eb.obstacles && belong_together(ea, eb))
          matches.push_back(match(place, a, i, b, j, is_paired));
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
  Json entry = Json::object();
  if (!m.place.empty()) entry["place"] = m.place;
  entry.update({{"name", m.name()},
                {"scenario", m.experiments[0].scenario},
                {"first", result_json(m.results[0])},
                {"second", result_json(m.results[1])}});
  entry.update(comparison_json(m.comparison));
  return entry;
}

/// Both sides of a comparison, place by place.
struct Sides {
  std::vector<Match> matches;
  Json settings = Json::array();   ///< those that differ
  std::vector<std::string> notes;  ///< sentences
};

Sides read_sides(const CompareArguments& arguments) {
  Sides sides;
  for (const std::string& place : places_of(arguments)) {
    const StoredEvaluation a = load_evaluation(fs::path(arguments.first) / place),
                           b = load_evaluation(fs::path(arguments.second) / place);
    const Json sa = parse_json(a.settings), sb = parse_json(b.settings);
    const auto is_same = [&](const char* key) { return sa.value(key, Json()) == sb.value(key, Json()); };
    const bool same_world = is_same("course_hash") && is_same("evaluation") && is_same("seed0");
    auto found = match_all(place, a, b, same_world);
    if (found.empty())
      throw IoError(b.folder.string(), 0, "has no scenario that " + a.folder.string() + " has");
    sides.matches.insert(sides.matches.end(), found.begin(), found.end());
    for (const auto* e : {&a, &b})
      if (!e->complete) sides.notes.push_back(e->folder.string() + " is not complete");
    for (const auto& d : differing_settings(sa, sb))
      if (std::find(sides.settings.begin(), sides.settings.end(), d) == sides.settings.end())
        sides.settings.push_back(d);
  }
  return sides;
}

int compare(const CompareArguments& arguments) {
  std::FILE* words = arguments.json == "-" ? stderr : stdout;
  Sides sides = read_sides(arguments);
  std::vector<const Match*> all;
  for (const Match& each : sides.matches) all.push_back(&each);
  const std::array<std::string, 2> names{arguments.first, arguments.second};
  const Match whole = together(all, "");
  const std::string sentence = verdict(names, whole.results, whole.comparison);
  const auto sums = over_places(sides.matches);
  sides.matches.insert(sides.matches.end(), sums.begin(), sums.end());

  std::fprintf(words, "%s\n", sentence.c_str());
  for (const std::string& note : sides.notes) std::fprintf(words, "note: %s\n", note.c_str());
  for (const Match& m : sides.matches) print(m, names, words);
  if (!whole.tests_ms) std::fprintf(words, "\nMS is not tested where the weights of the two differ.\n");
  if (!sides.settings.empty()) std::fprintf(words, "\nsettings that differ\n");
  for (const auto& d : sides.settings)
    std::fprintf(words, "  %s: %s | %s\n", d["setting"].get<std::string>().c_str(),
                 json_text(d["first"]).c_str(), json_text(d["second"]).c_str());
  if (arguments.json.empty()) return 0;
  Json list = Json::array();
  for (const Match& m : sides.matches) list.push_back(json_of(m));
  write_json({{"verdict", sentence},
              {"first", arguments.first},
              {"second", arguments.second},
              {"settings", sides.settings},
              {"results", list}},
             arguments.json);
  return 0;
}

}  // namespace

void declare_compare(Subcommand& command) {
  command.summary("Compare two evaluations: which is better, with tests of significance");
  const auto arguments = std::make_shared<CompareArguments>();
  command.option("first", arguments->first, "Output folder of an evaluation, or a folder of several",
                 {.required = true});
  command.option(
      "second", arguments->second,
      "Output folder of the other evaluation, or a folder of several; evaluations of equal name are compared",
      {.required = true});
  command.json(arguments->json, "the comparison");
  command.examples({"compare BEFORE AFTER", "compare BEFORE AFTER --json compared.json"});
  command.action([arguments] { return compare(*arguments); });
}

}  // namespace slalom::tools
