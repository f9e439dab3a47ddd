#include "tools/evaluation/reproduction.hpp"

#include <set>

#include "json/json.hpp"
#include "slalom/core/error.hpp"
#include "tools/command_line/words.hpp"
#include "tools/evaluation/claims.hpp"
#include "tools/evaluation/comparison.hpp"

namespace slalom::tools {

namespace {

namespace fs = std::filesystem;
using namespace evaluation;

constexpr const char* authors = "https://github.com/kohonda/proj-svg_mppi";
constexpr const char* logs_course = "berlin";

std::string ratio_text(double ratio) {
  if (ratio > 2 || ratio < 0.5) return formatted("MS %.2f times that of the log", ratio);
  return formatted(ratio > 1 ? "MS %.1f %% higher" : "MS %.1f %% lower", 100 * std::abs(ratio - 1));
}

/// Describes the difference between measured laps and a log, in the figures that decide their agreement.
std::string difference_text(const LogComparison& c, double our_rate) {
  const bool outside = c.agreement() == Agreement::outside;
  std::string text;
  if (c.ms_agreement() == c.agreement())
    text = ratio_text(c.ms_ratio) +
           (outside ? " (" + p_words(c.ms_p) + ")"
                    : formatted(" (95 %%: %.2f to %.2f times)", c.ms_ratio_ci.low, c.ms_ratio_ci.high));
  if (c.collision_p && c.collision_agreement() == c.agreement()) {
    const double points = 100 * (our_rate - *c.collision_rate);
    text += text.empty() ? "" : ", ";
    text += formatted(points >= 0 ? "collision rate %.1f points higher" : "collision rate %.1f points lower",
                      std::abs(points));
    text += outside ? " (" + p_words(*c.collision_p) + ")"
                    : formatted(" (95 %%: %.1f to %.1f points)", 100 * c.rate_difference_ci->low,
                                100 * c.rate_difference_ci->high);
  }
  return text;
}

/// Figures of laps of the paper's program.
std::string released_text(const LogComparison& c) {
  std::string text = "MS " + formatted("%.3g", c.ms_mean) + " in " + std::to_string(c.laps) +
                     (c.laps == 1 ? " lap, " : " laps, ") + p_words(c.ms_p);
  if (c.collision_rate)
    text += formatted(", collision rate %.1f %%, ", 100 * *c.collision_rate) + p_words(*c.collision_p);
  return text;
}

Json comparison_json(const LogComparison& c, const LapLog& log) {
  const auto number = [](const std::optional<double>& v) {
    return v && std::isfinite(*v) ? Json(*v) : Json(nullptr);
  };
  return {{"file", fs::path(log.file).filename().string()},
          {"laps", log.laps},
          {"paired_laps", c.paired ? c.our_laps : 0},
          {"timeouts", log.timeouts},
          {"collisions", log.collisions},
          {"ms_mean", c.ms_mean},
          {"ms_ci", interval_json(c.ms_ci)},
          {"ms_ratio", c.ms_ratio},
          {"ms_ratio_ci", interval_json(c.ms_ratio_ci)},
          {"ms_p", number(c.ms_p)},
          {"collision_rate", number(c.collision_rate)},
          {"collision_rate_ci", interval_json(c.collision_rate_ci)},
          {"collisions_p", number(c.collision_p)},
          {"collision_rate_difference_ci", interval_json(c.rate_difference_ci)},
          {"success_rate", static_cast<double>(log.successes) / log.laps},
          {"solve_ms", {{"mean", number(log.solve_ms_mean)}, {"max", number(log.solve_ms_max)}}}};
}

/// The rows of the paper's tables, as they are added.
struct PaperRows {
  std::vector<PaperRow> rows;

  void add(PaperRow row, const std::string& log) {
    row.log_pt = "path_tracking/" + log;
    row.log_oa = "obstacle_avoidance/" + log;
    rows.push_back(row);
  }
  void mppi(const char* table, const std::string& name, const std::string& variance) {
    add({.table = table,
         .name = name,
         .method = "mppi",
         .set = {{"mppi.variance", variance}},
         .released = "mppi_" + variance},
        "forward_mppi(cov:" + variance + ").csv");
  }
  void svg_mppi(const char* table, const char* name) {
    add({.table = table, .name = name, .method = "svg_mppi", .released = "svg_mppi"}, "svg_mppi.csv");
  }
  void fixed(const char* table, const std::string& name, const std::string& variance) {
    PaperRow row{.table = table,
                 .name = name,
                 .method = "svg_mppi",
                 // The authors vary one parameter, steer_cov, which is both (docs/paper-options.md).
                 .set = {{"svg_mppi.adapt_covariance", "false"},
                         {"svg_mppi.variance", variance},
                         {"svg_mppi.guide_variance", variance}},
                 .released = "ns_" + variance};
    const std::string folder = "ablation_study/wo_cov_adaptation/", file = "cov:" + variance + ".csv";
    row.log_pt = folder + "path_tracking/" + file;
    row.log_oa = folder + "obstacle_avoidance/" + file;
    rows.push_back(row);
  }
};

PaperRows all_paper_rows() {
  PaperRows made;
  for (const char* variance : {"0.025", "0.05", "0.075", "0.1"})
    made.mppi("table1", std::string("MPPI, covariance ") + variance, variance);
  made.rows[1].note =
      "This row is in the authors' logs but not in the paper's tables. Its logged figures are those of "
      "covariance 0.1, which was most likely driven. The paper's program and Slalom agree with each other.";
  made.add(
      {.table = "table1",
       .name = "Reverse MPPI",
       .method = "reverse_mppi",
       .released = "reverse_mppi",
       .note = "The log is not what one thread computes: the threads of the paper's program race when they "
               "sum the moments, and contributions are lost (docs/logbook/evaluation.md). One thread of it "
               "has the figure of Slalom."},
      "reverse_mppi.csv");
  made.add({.table = "table1",
            .name = "SV-MPC",
            .method = "sv_mpc",
            .released = "sv_mpc",
            .note = "The log is not what one thread computes: particles diverge until numbers overflow, and "
                    "contributions that the threads of the paper's program lose in a race damp this "
                    "(docs/logbook/evaluation.md). One thread of it has the figure of Slalom."},
           "sv_mpc.csv");
  made.svg_mppi("table1", "SVG-MPPI");

  made.mppi("table2", "MPPI", "0.075");
  made.fixed("table2", "MPPI + NS", "0.075");
  made.rows.push_back(
      {.table = "table2",
       .name = "MPPI + AC",
       .method = "svg_mppi",
       .set = {{"svg_mppi.use_nominal", "false"}},
       .log_pt = "ablation_study/wo_nominal_solution/obstacle_avoidance/wo_nominal_solution.csv",
       .log_oa = "ablation_study/wo_nominal_solution/path_tracking/wo_nominal_solution.csv",
       .released = "ac",
       .note = "The paper prints PT 18.18, OA 7.08; the seeds and collisions in the logs show "
               "that the two are swapped. The comparison uses what was driven."});
  made.svg_mppi("table2", "MPPI + NS + AC (SVG-MPPI)");
  for (const char* variance :
       {"0.001", "0.005", "0.01", "0.015", "0.02", "0.025", "0.03", "0.05", "0.075", "0.1"})
    made.fixed("covariances", std::string("fixed ") + variance, variance);
  made.svg_mppi("covariances", "adaptive");
  return made;
}

}  // namespace

const std::vector<PaperRow>& paper_rows() {
  static const std::vector<PaperRow> rows = all_paper_rows().rows;
  return rows;
}

const PaperTable* find_table(const std::string& name) {
  for (const PaperTable& table : paper_tables)
    if (name == table.name) return &table;
  return nullptr;
}

bool drives(const Experiment& experiment, const PaperRow& row) {
  return experiment.method == row.method && experiment.set == row.set;
}

std::vector<Experiment> paper_experiments(const std::vector<std::string>& tables, int laps_pt, int laps_oa,
                                          int obstacles) {
  std::vector<Experiment> experiments;
  for (const std::string& table : tables) {
    for (const char* scenario : {"pt", "oa"}) {
      for (const PaperRow& row : paper_rows()) {
        if (row.table != table) continue;
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

/// Adds to the notes how many logs there are and which are missing. False if there is none.
bool note_logs(PaperFiles& files) {
  std::set<std::string> found, missing;
  for (const PaperRow& row : paper_rows())
    for (const std::string& log : {row.log_pt, row.log_oa})
      (fs::is_regular_file(files.logs / log) ? found : missing).insert(log);
  std::string note = std::to_string(found.size()) + " of " + std::to_string(found.size() + missing.size()) +
                     " logs in " + files.logs.string();
  for (const std::string& log : missing) note += (log == *missing.begin() ? "; missing: " : ", ") + log;
  files.notes.push_back(note);
  return !found.empty();
}

}  // namespace

PaperFiles find_paper_files(const fs::path& clone, const std::string& course) {
  PaperFiles files;
  const std::string source = std::string("map, path and logs: --paper with a clone of ") + authors;
  if (clone.empty()) {
    files.notes.push_back("Nothing is compared. For the authors' " + source);
    return files;
  }
  const fs::path maps = clone / "data/map", path = clone / "data/reference_path" / course;
  if (!fs::is_directory(maps))
    throw IoError(clone.string(), 0, std::string("has no folder data/map; must be a clone of ") + authors);
  if (fs::is_directory(maps / course)) {
    files.course = maps / course;
    files.notes.push_back("map " + files.course.string() + ", path " + path.string());
  }
  files.logs = clone / "src/eval/log";
  const bool logged = note_logs(files);
  if (course != logs_course)
    files.notes.push_back("Nothing is compared: the logs are of laps on Berlin, these are laps on " + course);
  if (!logged || course != logs_course) files.logs.clear();
  return files;
}

/// Whether the two-sided permutation test of few laps can find a difference at the 5 % level.
bool can_differ(const LogComparison& c) {
  const int fewer = std::min(c.laps, c.our_laps), more = std::max(c.laps, c.our_laps);
  return fewer > 3 || (fewer == 3 && more > 3) || (fewer == 2 && more > 4) || (fewer == 1 && more > 19);
}

std::string verdict_of(const Reference& r, double collision_rate) {
  if (!r.published) return verdicts::none;
  const std::string from_log = difference_text(*r.published, collision_rate);
  std::string text;
  if (r.published->agreement() == Agreement::inside) {
    text = verdicts::log;
  } else if (r.published->agreement() == Agreement::undecided) {
    text = verdicts::undecided + (": " + from_log);
  } else if (!r.released) {
    text = verdicts::not_log + (": " + from_log);
  } else if (r.released->agreement() == Agreement::outside) {
    text = verdicts::neither + (": log: " + from_log) +
           "; paper's program: " + difference_text(*r.released, collision_rate);
  } else if (!can_differ(*r.released)) {
    text = verdicts::undecided + (": log: " + from_log) + "; paper's program: " + released_text(*r.released);
  } else {
    text = verdicts::released + (": " + released_text(*r.released)) + "; log: " + from_log;
  }
  return text;
}

std::vector<Reference> find_references(const fs::path& logs, const std::vector<Experiment>& experiments,
                                       const std::vector<LapRow>& rows) {
  const auto& paper = paper_rows();
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
    if (row == paper.end() || logs.empty()) {
      r.verdict = verdicts::none;
      continue;
    }
    if (const fs::path file = logs / row->log(e.scenario); fs::exists(file)) {
      r.log = read_lap_log(file);
      r.published = compare_with_log(ours, e.obstacles, *r.log);
    }
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
  result["verdict"] = reference.verdict;
  result["note"] = reference.note;
}

}  // namespace slalom::tools
