#include "tools/evaluation/tuning_job.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <sstream>

#include "slalom/core/error.hpp"
#include "slalom/core/read_file.hpp"
#include "slalom/evaluation/result_folder.hpp"
#include "slalom/evaluation/results.hpp"
#include "src/evaluation/json.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using namespace evaluation;

void require(const char* option, int value, int low, int high) {
  if (value < low || value > high)
    throw IoError(
        option, 0,
        std::to_string(value) + " must be in [" + std::to_string(low) + ", " + std::to_string(high) + "]");
}

std::string label(const Candidate& candidate) {
  if (candidate.set.empty()) return "as it stands";
  return Experiment{.method = {}, .set = candidate.set, .scenario = {}}.set_text();
}

Json set_json(const Candidate& candidate) {
  Json set = Json::object();
  for (const auto& [key, value] : candidate.set) set[key] = value;
  return set;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  stream.exceptions(std::ios::badbit);  // otherwise the list ends where memory runs out
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

/// The keys of two plans that differ.
std::string differences(const Json& there, const Json& here) {
  std::string text;
  for (const auto& [key, value] : here.items()) {
    if (there.contains(key) && there.at(key) == value) continue;
    text += (text.empty() ? "" : "; ") + key + ": " +
            (there.contains(key) ? json_text(there.at(key)) : "nothing") + " there, " + json_text(value) +
            " here";
  }
  return text;
}

}  // namespace

void keep_plan(const std::filesystem::path& file, const Json& plan, bool resume) {
  if (!fs::exists(file)) return replace_file(file, json_text(plan, 2) + "\n");
  if (!resume)
    throw IoError(file.parent_path().string(), 0,
                  "contains a search; continue it with --resume, or use another folder");
  Json there;
  try {
    there = parse_json(read_file(file, max_json_bytes));
  } catch (const std::invalid_argument& failure) {
    throw IoError(file.string(), 0, failure.what());
  }
  const std::string differing = differences(there, plan);
  if (!differing.empty())
    throw IoError(file.string(), 0, "the folder contains a different search: " + differing);
}

TuningJob::TuningJob(TuningArguments arguments)
    : arguments_(std::move(arguments)), objective_([this] {
        try {
          return Objective(arguments_.objective);
        } catch (const std::invalid_argument& error) {
          throw IoError("--objective", 0, error.what());
        }
      }()) {
  require("--laps", arguments_.laps, 1, 10000);
  require("--rounds", arguments_.rounds, 1, 20);
  require("--held-out", arguments_.held_out, 0, 100000);
  require("--budget", arguments_.budget, 1, 10000000);
  std::vector<std::string> fixed, searched;
  for (const std::string& text : arguments_.set) {
    const bool one_value = text.find(':') == std::string::npos && text.find(',') == std::string::npos;
    (one_value || text.find('[') != std::string::npos ? fixed : searched).push_back(text);
  }
  if (searched.empty())
    throw IoError(
        "--set", 0,
        "at least one must name a range or a list to search: key=lo:hi, key=lo:hi:log or key=v1,v2,...");
  arguments_.evaluation.scenario.set = fixed;
  const auto names = split(arguments_.evaluation.scenario.course);
  if (names.empty()) throw IoError("--course", 0, "must name at least one course");
  for (const std::string& name : names) {
    ScenarioArguments scenario = arguments_.evaluation.scenario;
    scenario.course = name;
    courses_.push_back(load_scenario(scenario, arguments_.method));
    for (std::size_t i = 0; i + 1 < courses_.size(); ++i)
      if (courses_[i].environment->course.name == courses_.back().environment->course.name)
        throw IoError("--course", 0, "'" + courses_.back().environment->course.name + "' is given twice");
  }
  const auto key_of = [](const std::string& text) { return text.substr(0, text.find('=')); };
  for (std::size_t i = 0; i < arguments_.set.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      refuse_twice(key_of(arguments_.set[i]), key_of(arguments_.set[j]), {arguments_.method});
  for (const std::string& text : searched) {
    require_driven(key_of(text), {arguments_.method});
    try {
      dimensions_.push_back(parse_dimension(text, courses_[0].configuration, arguments_.method));
    } catch (const std::invalid_argument& error) {
      throw IoError("--set", 0, error.what());
    }
    best_.place.push_back(
        dimensions_.back().place(option_text(courses_[0].configuration, dimensions_.back().key)));
  }
  const int candidates = candidates_for(arguments_.budget / arguments_.rounds / places(), arguments_.laps);
  const int least = laps_of(halving(2, arguments_.laps)) * arguments_.rounds * places();
  if (candidates < 2)
    throw IoError("--budget", 0,
                  std::to_string(arguments_.budget) + " must be at least " + std::to_string(least) +
                      " for these numbers of rounds, laps, scenarios and courses");
  rungs_ = halving(candidates, arguments_.laps);
}

Json TuningJob::plan() const {
  Json courses = Json::array(), rungs = Json::array();
  for (const Scenario& course : courses_) courses.push_back(course.environment->course.name);
  for (const Rung& rung : rungs_) rungs.push_back({{"candidates", rung.candidates}, {"laps", rung.laps}});
  return {{"courses", courses},
          {"config", arguments_.evaluation.scenario.config},
          {"evaluation", arguments_.evaluation.scenario.evaluation},
          {"method", arguments_.method},
          {"scenarios", arguments_.scenarios},
          {"obstacles", arguments_.obstacles},
          {"objective", arguments_.objective},
          {"set", arguments_.set},
          {"budget", arguments_.budget},
          {"rounds", arguments_.rounds},
          {"rungs", rungs},
          {"held_out", arguments_.held_out},
          {"seed0", arguments_.evaluation.seed0}};
}

bool TuningJob::drive(const std::string& step, const std::vector<Candidate>& candidates, int first_lap,
                      int laps, const std::atomic<bool>& cancel, Driven& driven) const {
  std::vector<Experiment> experiments;
  for (const Candidate& candidate : candidates)
    for (const std::string& scenario : arguments_.scenarios)
      experiments.push_back(
          {arguments_.method, candidate.set, scenario, scenario == "pt" ? 0 : arguments_.obstacles, laps});
  driven.values.resize(candidates.size());
  for (const Scenario& course : courses_) {
    EvaluationArguments arguments = arguments_.evaluation;
    arguments.out += "/" + step + "/" + course.environment->course.name;
    arguments.resume = true;
    // Further than the laps before, in every scenario.
    arguments.seed0 +=
        static_cast<std::uint64_t>(first_lap) * static_cast<std::uint64_t>(arguments_.obstacles + 5);
    const Evaluation evaluation = make_evaluation(arguments, course, experiments);
    std::vector<LapRow> rows;
    if (!drive_evaluation(evaluation, arguments, step + ", " + course.environment->course.name, cancel, rows))
      return false;
    for (const LapRow& row : rows)
      driven.values[static_cast<std::size_t>(row.experiment) / arguments_.scenarios.size()].push_back(
          objective_.of(row));
    for (const ExperimentResult& r : summarise(rows, experiments)) {
      const auto index = static_cast<std::size_t>(r.experiment);
      driven.results.push_back({{"course", course.environment->course.name},
                                {"scenario", experiments[index].scenario},
                                {"set", experiments[index].set_text()},
                                {"laps", r.laps},
                                {"timeouts", r.timeouts},
                                {"contacts", r.collisions},
                                {"ms_mean", r.ms_mean},
                                {"ms_ci", {r.ms_ci.low, r.ms_ci.high}},
                                {"success_rate", r.success_rate},
                                {"success_rate_ci", {r.success_rate_ci.low, r.success_rate_ci.high}},
                                {"solve_ms_p50", r.solve_ms_p50}});
    }
  }
  return true;
}

bool TuningJob::search(int round, const std::atomic<bool>& cancel, std::FILE* words) {
  const int count = rungs_.front().candidates;
  const auto fresh = design(dimensions_, best_.place, std::pow(0.5, round), round * (count - 1), count - 1);
  std::vector<Candidate> candidates{best_};
  for (const Candidate& candidate : fresh) {
    // Whole numbers and choices may come up twice.
    const auto same = [&](const Candidate& other) { return other.set == candidate.set; };
    if (std::none_of(candidates.begin(), candidates.end(), same)) candidates.push_back(candidate);
  }
  std::vector<std::vector<double>> values(candidates.size());
  int before = 0;
  for (std::size_t i = 0; i < rungs_.size(); ++i) {
    const std::string step = "round" + std::to_string(round + 1) + "/rung" + std::to_string(i + 1);
    Driven driven;
    if (!drive(step, candidates, before, rungs_[i].laps - before, cancel, driven)) return false;
    before = rungs_[i].laps;
    for (std::size_t c = 0; c < candidates.size(); ++c)
      values[c].insert(values[c].end(), driven.values[c].begin(), driven.values[c].end());
    std::vector<std::size_t> order(candidates.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return mean(values[a]) < mean(values[b]); });
    Json ranking = Json::array();
    for (const std::size_t c : order)
      ranking.push_back(
          {{"set", set_json(candidates[c])}, {"laps", values[c].size()}, {"objective", mean(values[c])}});
    result_["steps"].push_back({{"step", step}, {"ranking", ranking}});
    std::fprintf(words, "%s: %zu candidates, %zu lap%s each; best %.4g: %s\n", step.c_str(),
                 candidates.size(), values[order[0]].size(), values[order[0]].size() == 1 ? "" : "s",
                 mean(values[order[0]]), label(candidates[order[0]]).c_str());
    std::fflush(words);
    const std::size_t left =
        i + 1 < rungs_.size()
            ? std::min(candidates.size(), static_cast<std::size_t>(rungs_[i + 1].candidates))
            : 1;
    std::vector<Candidate> kept;
    std::vector<std::vector<double>> kept_values;
    for (std::size_t k = 0; k < left; ++k) {
      kept.push_back(candidates[order[k]]);
      kept_values.push_back(values[order[k]]);
    }
    candidates = std::move(kept);
    values = std::move(kept_values);
  }
  best_ = candidates.front();
  return true;
}

/// The final result: laps that were not part of the search, for the best candidate and the initial one.
bool TuningJob::hold_out(const std::atomic<bool>& cancel, std::FILE* words) {
  if (arguments_.held_out == 0) return true;
  std::vector<Candidate> both{{best_.place, {}}};
  if (!best_.set.empty()) both.push_back(best_);
  Driven driven;
  if (!drive("held-out", both, rungs_.back().laps, arguments_.held_out, cancel, driven)) return false;
  const auto& start = driven.values.front();
  const auto& best = driven.values.back();
  std::vector<double> differences(start.size());
  std::transform(best.begin(), best.end(), start.begin(), differences.begin(), std::minus<>());
  const Interval interval = bootstrap_mean(differences);
  const double p = wilcoxon_p(differences);
  result_["held_out"] = {{"laps", start.size()},
                         {"objective_start", mean(start)},
                         {"objective_best", mean(best)},
                         {"difference", mean(differences)},
                         {"difference_ci", {interval.low, interval.high}},
                         {"wilcoxon_p", p},
                         {"results", driven.results}};
  std::fprintf(words, "\nheld-out seeds, %zu lap%s each: %s\n  initial    %.4g\n", start.size(),
               start.size() == 1 ? "" : "s", arguments_.objective.c_str(), mean(start));
  if (!best_.set.empty())
    std::fprintf(words, "  best found %.4g, difference %.4g (95 %%: %.4g to %.4g), Wilcoxon p = %.3g\n",
                 mean(best), mean(differences), interval.low, interval.high, p);
  for (const auto& r : driven.results)
    std::fprintf(
        words, "  %-10s %-2s MS %8.3f (%.3f - %.3f), %d collisions, success %5.1f %%, solve %.2f ms  %s\n",
        r["course"].get<std::string>().c_str(), r["scenario"].get<std::string>().c_str(),
        r["ms_mean"].get<double>(), r["ms_ci"][0].get<double>(), r["ms_ci"][1].get<double>(),
        r["contacts"].get<int>(), 100 * r["success_rate"].get<double>(), r["solve_ms_p50"].get<double>(),
        r["set"].get<std::string>().empty() ? "initial" : "best found");
  return true;
}

/// The whole configuration, so that the file means the same when its base changes.
void TuningJob::write_best() const {
  vehicle::Configuration configuration = courses_[0].configuration;
  std::string head = "# Found by `slalom tune`: --method " + arguments_.method + " --config " +
                     arguments_.evaluation.scenario.config + " --objective '" + arguments_.objective + "'\n";
  for (const auto& [key, value] : best_.set) {
    head += "#   " + key + ": " + value + " instead of " + option_text(configuration, key) + "\n";
    vehicle::set_option(configuration, key, value);
  }
  if (best_.set.empty()) head += "#   no candidate was better than the initial configuration\n";
  replace_file(arguments_.evaluation.out + "/best.yaml", head + vehicle::to_yaml(configuration));
}

bool TuningJob::run(const std::atomic<bool>& cancel, std::FILE* words) {
  const int searched = laps_of(rungs_) * places() * arguments_.rounds,
            held_out = 2 * arguments_.held_out * places();
  std::fprintf(words, "%d round%s of %d candidates: %d laps; then %d on held-out seeds\n", arguments_.rounds,
               arguments_.rounds == 1 ? "" : "s", rungs_.front().candidates, searched, held_out);
  std::fflush(words);
  const fs::path plan_file = fs::path(arguments_.evaluation.out) / "plan.json",
                 folder = plan_file.parent_path();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw IoError(folder.string(), 0, "cannot be created: " + error.message());
  const FolderLock lock(folder);
  keep_plan(plan_file, plan(), arguments_.evaluation.resume);
  result_ = {{"plan", plan()}, {"laps", searched + held_out}, {"steps", Json::array()}};
  for (int round = 0; round < arguments_.rounds; ++round)
    if (!search(round, cancel, words)) return false;
  result_["best"] = set_json(best_);
  if (!hold_out(cancel, words)) return false;
  write_best();
  replace_file(arguments_.evaluation.out + "/tune.json", json_text(result_, 2) + "\n");
  std::fprintf(words, "\nbest: %s\n%s/best.yaml\n", label(best_).c_str(), arguments_.evaluation.out.c_str());
  return true;
}

}  // namespace slalom::tools
