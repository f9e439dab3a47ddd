#include "tools/evaluation/reproduction.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "slalom/core/error.hpp"
#include "src/evaluation/json.hpp"
#include "tools/command_line/command.hpp"
#include "tools/evaluation/paper_program.hpp"

namespace slalom::tools {

namespace {

namespace fs = std::filesystem;
using namespace evaluation;

constexpr const char* authors = "https://github.com/kohonda/proj-svg_mppi";
constexpr const char* logs_course = "berlin";

std::string format(const char* pattern, double value) {
  char text[80];
  std::snprintf(text, sizeof text, pattern, value);
  return text;
}

/// A p value in its usual notation.
std::string p_text(double p) {
  return p < 0.001 ? "p < 0.001" : format("p = %.3f", p);
}

std::string ratio_text(double ratio) {
  if (ratio > 2 || ratio < 0.5) return format("MS %.2f times that of the log", ratio);
  return format(ratio > 1 ? "MS %.1f %% higher" : "MS %.1f %% lower", 100 * std::abs(ratio - 1));
}

/// Describes the difference between measured laps and a log, in the figures that decide their agreement.
std::string difference_text(const LogComparison& c, double our_rate) {
  const bool outside = c.agreement() == Agreement::outside;
  std::string text;
  if (c.ms_agreement() == c.agreement())
    text = ratio_text(c.ms_ratio) + (outside ? " (" + p_text(c.ms_p) + ")"
                                             : format(" (95 %%: %.2f to ", c.ms_ratio_ci.low) +
                                                   format("%.2f times)", c.ms_ratio_ci.high));
  if (c.collision_p && c.collision_agreement() == c.agreement()) {
    const double points = 100 * (our_rate - *c.collision_rate);
    text += text.empty() ? "" : ", ";
    text += format(points >= 0 ? "collision rate %.1f points higher" : "collision rate %.1f points lower",
                   std::abs(points));
    text += outside ? " (" + p_text(*c.collision_p) + ")"
                    : format(" (95 %%: %.1f to ", 100 * c.rate_difference_ci->low) +
                          format("%.1f points)", 100 * c.rate_difference_ci->high);
  }
  return text;
}

/// Figures of laps of the paper's program.
std::string released_text(const LogComparison& c) {
  std::string text = "MS " + format("%.3g", c.ms_mean) + " in " + std::to_string(c.laps) +
                     (c.laps == 1 ? " lap, " : " laps, ") + p_text(c.ms_p);
  if (c.collision_rate)
    text += format(", collision rate %.1f %%, ", 100 * *c.collision_rate) + p_text(*c.collision_p);
  return text;
}

Json comparison_json(const LogComparison& c, const LapLog& log) {
  const auto interval = [](const std::optional<Interval>& i) {
    return i ? Json{i->low, i->high} : Json(nullptr);
  };
  const auto number = [](const std::optional<double>& v) {
    return v && std::isfinite(*v) ? Json(*v) : Json(nullptr);
  };
  return {{"file", fs::path(log.file).filename().string()},
          {"laps", log.laps},
          {"timeouts", log.timeouts},
          {"contacts", log.collisions},
          {"ms_mean", c.ms_mean},
          {"ms_ci", interval(c.ms_ci)},
          {"ms_ratio", c.ms_ratio},
          {"ms_ratio_ci", interval(c.ms_ratio_ci)},
          {"ms_p", number(c.ms_p)},
          {"collision_rate", number(c.collision_rate)},
          {"collision_rate_ci", interval(c.collision_rate_ci)},
          {"contacts_p", number(c.collision_p)},
          {"collision_rate_difference_ci", interval(c.rate_difference_ci)},
          {"success_rate", static_cast<double>(log.successes) / log.laps},
          {"solve_ms", {{"mean", number(log.solve_ms_mean)}, {"max", number(log.solve_ms_max)}}}};
}

}  // namespace

std::vector<PaperRow> paper_rows() {
  std::vector<PaperRow> rows;
  const auto baseline = [&](const char* name, const char* method, const char* log) {
    rows.push_back({.section = "baseline",
                    .name = name,
                    .method = method,
                    .log_pt = std::string("path_tracking/") + log + ".csv",
                    .log_oa = std::string("obstacle_avoidance/") + log + ".csv"});
  };
  for (const char* variance : {"0.025", "0.05", "0.075", "0.1"}) {
    const std::string text = variance;
    baseline(("MPPI, covariance " + text).c_str(), "mppi", ("forward_mppi_cov_" + text).c_str());
    rows.back().set = {{"mppi.variance", text}};
    rows.back().released = "mppi_" + text;
  }
  rows[1].note =
      "This row is in the authors' logs but not in the paper's tables. Its logged figures are those of "
      "covariance 0.1, which was most likely driven. The paper's program and Slalom agree with each other.";
  rows[3].lockstep = "mppi_cov0.1";
  baseline("Reverse MPPI", "reverse_mppi", "reverse_mppi");
  rows.back().released = "reverse_mppi";
  rows.back().note =
      "The log is not what one thread computes: the threads of the paper's program race when they sum the "
      "moments, and contributions are lost (docs/logbook/evaluation.md). One thread of it has the figure of "
      "Slalom.";
  baseline("SV-MPC", "sv_mpc", "sv_mpc");
  rows.back().released = "sv_mpc";
  rows.back().note =
      "The log is not what one thread computes: particles diverge until numbers overflow, and contributions "
      "that the threads of the paper's program lose in a race damp this (docs/logbook/evaluation.md). One "
      "thread of it has the figure of Slalom.";
  baseline("SVG-MPPI", "svg_mppi", "svg_mppi");
  rows.back().released = "svg_mppi";
  rows.back().lockstep = "svg_mppi";

  const std::string nominal = "ablation_wo_nominal_solution/", sweep = "ablation_wo_cov_adaptation/";
  rows.push_back({.section = "ablation",
                  .name = "MPPI",
                  .method = "mppi",
                  .set = {{"mppi.variance", "0.075"}},
                  .log_pt = rows[2].log_pt,
                  .log_oa = rows[2].log_oa,
                  .released = rows[2].released});
  const auto fixed = [&](const char* section, const std::string& name, const std::string& variance) {
    rows.push_back(
        {.section = section,
         .name = name,
         .method = "svg_mppi",
         // The authors vary one parameter, steer_cov, which is both (docs/published-parameters.md).
         .set = {{"svg_mppi.adapt_covariance", "false"},
                 {"svg_mppi.variance", variance},
                 {"svg_mppi.guide_variance", variance}},
         .log_pt = sweep + "path_tracking/cov_" + variance + ".csv",
         .log_oa = sweep + "obstacle_avoidance/cov_" + variance + ".csv",
         .released = "ns_" + variance});
  };
  fixed("ablation", "MPPI + nominal sequence (NS)", "0.075");
  rows.push_back(
      {.section = "ablation",
       .name = "MPPI + adaptive covariance (AC)",
       .method = "svg_mppi",
       .set = {{"svg_mppi.use_nominal", "false"}},
       .log_pt = nominal + "obstacle_avoidance/wo_nominal_solution.csv",
       .log_oa = nominal + "path_tracking/wo_nominal_solution.csv",
       .released = "ac",
       .note = "The paper prints PT 18.18, OA 7.08; the seeds and collisions in the logs show that the "
               "two are swapped. The comparison uses what was driven."});
  rows.push_back({.section = "ablation",
                  .name = "MPPI + NS + AC (SVG-MPPI)",
                  .method = "svg_mppi",
                  .log_pt = "path_tracking/svg_mppi.csv",
                  .log_oa = "obstacle_avoidance/svg_mppi.csv",
                  .lockstep = "svg_mppi",
                  .released = "svg_mppi"});
  for (const char* variance :
       {"0.001", "0.005", "0.01", "0.015", "0.02", "0.025", "0.03", "0.05", "0.075", "0.1"})
    fixed("sweep", std::string("fixed ") + variance, variance);
  rows.push_back({.section = "sweep",
                  .name = "adaptive",
                  .method = "svg_mppi",
                  .log_pt = sweep + "path_tracking/cov_adaptive.csv",
                  .log_oa = sweep + "obstacle_avoidance/cov_adaptive.csv",
                  .lockstep = "svg_mppi",
                  .released = "svg_mppi"});
  return rows;
}

bool drives(const Experiment& experiment, const PaperRow& row) {
  return experiment.method == row.method && experiment.set == row.set;
}

std::vector<Experiment> paper_experiments(const std::vector<std::string>& sections, int laps_pt, int laps_oa,
                                          int obstacles) {
  std::vector<Experiment> experiments;
  const auto rows = paper_rows();
  for (const std::string& section : sections) {
    for (const char* scenario : {"pt", "oa"}) {
      for (const PaperRow& row : rows) {
        if (row.section != section) continue;
        const bool there = std::any_of(experiments.begin(), experiments.end(), [&](const Experiment& e) {
          return e.scenario == scenario && drives(e, row);
        });
        const bool tracking = scenario == std::string("pt");
        if (!there)
          experiments.push_back(
              {row.method, row.set, scenario, tracking ? 0 : obstacles, tracking ? laps_pt : laps_oa});
      }
    }
  }
  return experiments;
}

namespace {

/// A folder that is given must hold at least one of the logs.
void require_logs(const fs::path& published) {
  if (!fs::is_directory(published))
    throw CommandLineError("--published", published.string(), "must be a folder");
  for (const PaperRow& row : paper_rows())
    if (fs::is_regular_file(published / row.log_pt) || fs::is_regular_file(published / row.log_oa)) return;
  throw CommandLineError("--published", published.string(),
                         std::string("must contain logs of the authors (src/eval/log of ") + authors + ")");
}

}  // namespace

LogFolders find_logs(const std::string& published, const std::string& course) {
  LogFolders folders;
  if (!published.empty()) require_logs(published);
  const std::string where = std::string("The authors provide map and logs at ") + authors + ".";
  if (course != logs_course)
    folders.notes.push_back("The paper's laps were driven on Berlin; these are laps of " + course +
                            ", so nothing is compared. " + where);
  if (published.empty()) {
    folders.notes.push_back(
        "No logs of the authors were given; --published names their folder (src/eval/log). " + where);
  } else if (course == logs_course) {
    folders.published = published;
    const fs::path beside = fs::weakly_canonical(published).parent_path() / "lockstep";
    if (fs::is_directory(beside)) folders.lockstep = beside;
  }
  return folders;
}

std::string verdict_of(const Reference& r, double collision_rate) {
  if (!r.published) return verdicts::none;
  const std::string from_log = difference_text(*r.published, collision_rate);
  std::string text;
  if (r.published->agreement() == Agreement::inside) {
    text = verdicts::log;
  } else if (r.published->agreement() == Agreement::undecided) {
    text = verdicts::log + std::string(": no significant difference, but wide intervals; ") + from_log;
  } else if (!r.released) {
    text = verdicts::not_log + (": " + from_log);
  } else if (r.released->agreement() == Agreement::outside) {
    text = verdicts::neither + (": log: " + from_log) +
           "; paper's program: " + difference_text(*r.released, collision_rate);
  } else {
    text = verdicts::released + (": " + released_text(*r.released)) + "; log: " + from_log;
  }
  if (r.lockstep)
    text += std::string("; the paper's program in lockstep: ") +
            (r.lockstep->agreement() == Agreement::outside ? difference_text(*r.lockstep, collision_rate)
                                                           : "no significant difference");
  return text;
}

std::vector<Reference> find_references(const LogFolders& folders, const std::vector<Experiment>& experiments,
                                       const std::vector<LapRow>& rows) {
  const auto paper = paper_rows();
  std::vector<Reference> references;
  for (int i = 0; i < static_cast<int>(experiments.size()); ++i) {
    const Experiment& e = experiments[static_cast<std::size_t>(i)];
    std::vector<LapRow> ours;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(ours),
                 [&](const LapRow& row) { return row.experiment == i; });
    Reference& r = references.emplace_back();
    const auto row =
        std::find_if(paper.begin(), paper.end(), [&](const PaperRow& p) { return drives(e, p); });
    if (row != paper.end()) r.note = row->note;
    const auto look = [&](const fs::path& file, auto& log, auto& comparison) {
      if (!fs::exists(file)) return;
      log = read_lap_log(file);
      comparison = compare_with_log(ours, e.obstacles, *log);
    };
    if (row == paper.end() || folders.published.empty()) {
      r.verdict = verdicts::none + std::string(": the authors have no laps on this course");
      continue;
    }
    look(folders.published / row->log(e.scenario), r.log, r.published);
    if (!folders.lockstep.empty() && !row->lockstep.empty())
      look(folders.lockstep / (row->lockstep + "_" + e.scenario + ".csv"), r.lockstep_log, r.lockstep);
    if (!r.published) {
      r.verdict = verdicts::none + (": " + row->log(e.scenario)) + " is missing";
      continue;
    }
    if (ours.empty()) continue;
    r.released_log = paper_program_laps(row->released, e.scenario);
    if (r.released_log) r.released = compare_with_log(ours, e.obstacles, *r.released_log);
    int collisions = 0;
    for (const LapRow& lap : ours) collisions += lap.collisions;
    const double chances = e.obstacles * static_cast<double>(ours.size());
    r.verdict = verdict_of(r, chances > 0 ? collisions / chances : 0);
  }
  return references;
}

void add_reference(Json& result, const Reference& reference) {
  result["published"] =
      reference.published ? comparison_json(*reference.published, *reference.log) : Json(nullptr);
  result["paper_program"] =
      reference.released ? comparison_json(*reference.released, *reference.released_log) : Json(nullptr);
  result["lockstep"] =
      reference.lockstep ? comparison_json(*reference.lockstep, *reference.lockstep_log) : Json(nullptr);
  result["verdict"] = reference.verdict;
  result["note"] = reference.note;
}

}  // namespace slalom::tools
