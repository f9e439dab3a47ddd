// `slalom eval` and `slalom reproduce`: killed at any moment nothing is lost; settings do not mix; what is
// wrong is named.
#include <nlohmann/json.hpp>

#include "tools/evaluation_folder.hpp"
#include "tools/paper_clone.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using ProgramRun = testing::Run;
using testing::contains;
using testing::content;
using testing::count_lines;
using testing::repeatable;
using testing::write_settings;

class EvalCommand : public testing::EvaluationFolder {
 protected:
  static std::string small(int laps = 3) {
    return "eval --course " SLALOM_COURSES
           "/wren --methods mppi,svg_mppi --scenario oa --obstacles 2 --laps " +
           std::to_string(laps) +
           " --config default_kinematic --set mppi.samples=48 --set svg_mppi.samples=32 --set "
           "svg_mppi.gradient_samples=8 ";
  }
};

TEST_F(EvalCommand, KilledTenTimesAndResumedEqualsAnUninterruptedRun) {
  ASSERT_EQ(run(small() + "--jobs 1 --out whole").status, 0);
  const std::string whole = repeatable(folder_ / "whole/laps.csv");
  EXPECT_EQ(std::count(whole.begin(), whole.end(), '\n'), 1 + 2 * 3);

  std::size_t laps = 0;
  int killed = 0;
  for (int i = 0; i < 10; ++i) {
    killed += kill_after(small() + "--jobs 2 --resume --out torn", 40 + 97 * i % 411);
    const fs::path journal = folder_ / "torn/laps.journal.csv";
    if (!fs::exists(journal)) continue;
    EXPECT_GE(count_lines(journal), laps) << "no lap that was kept may be lost";
    laps = count_lines(journal);
  }
  EXPECT_GT(killed, 0);
  const ProgramRun end = run(small() + "--jobs 2 --resume --out torn");
  ASSERT_EQ(end.status, 0) << end.output;
  EXPECT_EQ(repeatable(folder_ / "torn/laps.csv"), whole);
  EXPECT_FALSE(fs::exists(folder_ / "torn/laps.journal.csv"));
  const ProgramRun again = run(small() + "--resume --out torn");
  EXPECT_EQ(again.status, 0) << "a whole one can be resumed too: " << again.output;
  EXPECT_EQ(repeatable(folder_ / "torn/laps.csv"), whole);
}

TEST_F(EvalCommand, AFullDiskIsReportedAndNoLapIsLost) {
  fs::create_directories(folder_ / "full");
  fs::create_symlink("/dev/full", folder_ / "full/settings.json.new");
  const ProgramRun full = run(small(1) + "--out full");
  EXPECT_EQ(full.status, 1);
  EXPECT_TRUE(contains(full.output, "full/settings.json.new: cannot be written: No space left"))
      << full.output;

  // A disk that becomes full on the way: no file may grow beyond a few blocks.
  ASSERT_EQ(run(small() + "--out whole").status, 0);
  const auto settings = fs::file_size(folder_ / "whole/settings.json"),
             table = fs::file_size(folder_ / "whole/laps.csv");
  ASSERT_GT(table, 512u);
  const std::string limit = "trap '' XFSZ; ulimit -f " + std::to_string(settings / 512 + 1) + "; ";
  std::string arguments = small(60);
  const ProgramRun torn =
      testing::run_shell(limit + "'" SLALOM_PROGRAM "' " + arguments + "--out torn", folder_.string());
  EXPECT_EQ(torn.status, 1);
  EXPECT_TRUE(contains(torn.output, "laps.journal.csv: cannot be written")) << torn.output;
  const std::size_t kept = count_lines(folder_ / "torn/laps.journal.csv");
  EXPECT_GT(kept, 2u);
  EXPECT_TRUE(kill_after(arguments + "--resume --out torn", 700));
  EXPECT_GE(count_lines(folder_ / "torn/laps.journal.csv"), kept);
}

TEST_F(EvalCommand, RejectsLapsOfAnotherBuild) {
  ASSERT_EQ(run(small(1) + "--out one").status, 0);
  auto settings = nlohmann::ordered_json::parse(content(folder_ / "one/settings.json"));
  ASSERT_FALSE(settings.at("build").get<std::string>().empty());
  settings["build"] = "0123456789ab";
  write_settings(folder_ / "one", settings.dump(2));
  EXPECT_EQ(run(small(1) + "--resume --out one").status, 0)
      << "nothing is left to drive, so nothing is mixed";

  const std::string table = content(folder_ / "one/laps.csv");
  fs::remove(folder_ / "one/laps.csv");
  std::ofstream(folder_ / "one/laps.journal.csv")
      << table.substr(0, table.find('\n', table.find('\n') + 1) + 1);
  const ProgramRun refused = run(small(1) + "--resume --out one");
  EXPECT_EQ(refused.status, 1);
  EXPECT_TRUE(
      contains(refused.output, "the laps were driven by another build of the program (build 0123456789ab"))
      << refused.output;
  EXPECT_TRUE(contains(refused.output, "--any-build"));
  ASSERT_EQ(run(small(1) + "--resume --any-build --out one").status, 0);
  const std::string builds =
      nlohmann::json::parse(content(folder_ / "one/settings.json")).at("build").get<std::string>();
  EXPECT_EQ(builds.rfind("0123456789ab ", 0), 0u) << builds;
}

TEST_F(EvalCommand, RejectsLapsOfOtherSettings) {
  EXPECT_EQ(run("eval --methods mppi").status, 2) << "--out is required";
  ASSERT_EQ(run(small(1) + "--out one").status, 0);
  const ProgramRun again = run(small(1) + "--out one");
  EXPECT_EQ(again.status, 1);
  EXPECT_TRUE(contains(again.output, "--resume")) << again.output;
  const ProgramRun other = run(small(1) + "--out one --resume --seed 7 --evaluation published");
  EXPECT_EQ(other.status, 1);
  EXPECT_TRUE(contains(other.output, "seed0: 0 stored, 7 requested")) << other.output;
  EXPECT_TRUE(contains(other.output, "evaluation: \"true\" stored, \"published\" requested")) << other.output;
}

TEST_F(EvalCommand, ReportsInvalidArgumentsBeforeTheFirstLap) {
  const auto complaint = [&](const std::string& arguments) {
    const ProgramRun r = run(arguments);
    EXPECT_NE(r.status, 0) << arguments;
    return r.output;
  };
  const std::string course = "eval --course " SLALOM_COURSES "/wren --laps 1 ";
  EXPECT_TRUE(contains(complaint(course + "--methods mmpi --out x"), "mmpi"));
  EXPECT_TRUE(contains(complaint(course + "--methods mppi --set mppi.sample=3 --out x"), "sample"));
  EXPECT_TRUE(contains(complaint(course + "--methods mppi --set mppi.samples=-3 --out x"), "samples"));
  EXPECT_TRUE(contains(complaint(course + "--scenario ot --out x"), "'ot' must be pt or oa"));
  EXPECT_TRUE(contains(complaint("eval --course nowhere --laps 1 --out x"), "nowhere"));
  EXPECT_TRUE(contains(complaint(course + "--methods mppi,mppi --out x"), "twice"));
  EXPECT_TRUE(contains(complaint(course + "--set svg_mppi.samples=32,32 --out x"), "twice"));
  EXPECT_TRUE(contains(complaint(course + "--out /proc/nothing/here"), "/proc/nothing/here"));
  std::ofstream(folder_ / "file") << "not a folder";
  EXPECT_TRUE(contains(complaint(course + "--out file"), "file"));
  EXPECT_FALSE(fs::exists(folder_ / "x/laps.csv"));
}

TEST_F(EvalCommand, WritesASummary) {
  const ProgramRun r = run(small(1) + "--out one --report --json -");
  ASSERT_EQ(r.status, 0) << r.output;
  const auto summary = nlohmann::json::parse(content(folder_ / "one/summary.json"));
  ASSERT_EQ(summary.at("results").size(), 2u);
  for (const auto& result : summary.at("results")) {
    for (const char* key : {"method", "scenario", "laps", "ms_mean", "ms_ci", "collision_rate",
                            "collision_rate_ci", "success_rate", "solve_ms"})
      EXPECT_TRUE(result.contains(key)) << key;
    EXPECT_TRUE(result.at("ms_ci").is_null()) << "of fewer than five laps";
    EXPECT_LE(result.at("success_rate"), 1.0);
  }
  const std::string html = content(folder_ / "one/report.html");
  EXPECT_TRUE(contains(html, "</html>"));
  EXPECT_FALSE(contains(html, "src=\"http")) << "needs nothing but itself";
  EXPECT_LT(html.find("Paired comparison"), html.find("<table")) << "begins with the result";
  EXPECT_LT(html.find("<table"), html.find("<img"));
  EXPECT_FALSE(contains(html, "the authors' laps")) << "only terms that are used are explained";
  EXPECT_TRUE(contains(r.output, "one/report.html")) << "the path of the report";
  EXPECT_TRUE(fs::exists(folder_ / "one/figures/methods.svg"));
}

TEST_F(EvalCommand, ReplaysALapBitForBitAndComparesTwoRuns) {
  ASSERT_EQ(run(small(2) + "--out one").status, 0);
  const ProgramRun lap = run("replay one --method svg_mppi --lap 1 --course " SLALOM_COURSES
                             "/wren --plot lap.png --record lap.mcap");
  EXPECT_EQ(lap.status, 0) << lap.output;
  EXPECT_TRUE(contains(lap.output, "bit for bit")) << lap.output;
  EXPECT_TRUE(fs::exists(folder_ / "lap.png"));
  EXPECT_GT(fs::file_size(folder_ / "lap.mcap"), 50'000u);
  EXPECT_TRUE(contains(run("replay one --lap 0").output, "must name one of these"));
  EXPECT_TRUE(contains(run("replay one --method mppi --lap 2").output, "--lap"));
  EXPECT_NE(run("replay one --method mppi --lap 0 --course " SLALOM_COURSES "/stag").status, 0);

  const ProgramRun same = run("compare one one --json same.json");
  ASSERT_EQ(same.status, 0) << same.output;
  const auto compared = nlohmann::json::parse(content(folder_ / "same.json"));
  ASSERT_EQ(compared.at("results").size(), 2u);
  EXPECT_EQ(compared.at("settings").size(), 0u);
  for (const auto& result : compared.at("results")) {
    EXPECT_TRUE(result.at("paired").get<bool>());
    EXPECT_EQ(result.at("ms_p"), 1);
  }
  EXPECT_NE(run("compare one nowhere").status, 0);

  // Folders of evaluations: each place, then all its laps together.
  for (const char* place : {"a/wren", "a/again", "b/wren", "b/again", "c/other"}) {
    fs::create_directories((folder_ / place).parent_path());
    fs::copy(folder_ / "one", folder_ / place, fs::copy_options::recursive);
  }
  const ProgramRun places = run("compare a b --json places.json");
  ASSERT_EQ(places.status, 0) << places.output;
  const auto all = nlohmann::json::parse(content(folder_ / "places.json")).at("results");
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all.at(0).at("place"), "again");
  EXPECT_EQ(all.at(2).at("place"), "wren");
  for (std::size_t sum : {4u, 5u}) {
    EXPECT_EQ(all.at(sum).at("place"), "all 2");
    EXPECT_EQ(all.at(sum).at("first").at("laps").get<int>(), 2 * all.at(0).at("first").at("laps").get<int>());
    EXPECT_NEAR(all.at(sum).at("first").at("ms_mean").get<double>(),
                all.at(sum - 4).at("first").at("ms_mean").get<double>(), 1e-12);
  }
  EXPECT_TRUE(contains(run("compare a c").output, "or a folder of evaluations"));
}

TEST_F(EvalCommand, EveryExperimentMeetsTheSameOpponentsWithPlanners) {
  const ProgramRun driven = run("eval --course " SLALOM_COURSES
                                "/wren --methods mppi --scenario pt --laps 1 --config default_kinematic "
                                "--set mppi.samples=48 --set world.opponents=1 --set "
                                "world.planning_opponents=1 --set world.opponent_gap=3 --out one");
  ASSERT_EQ(driven.status, 0) << driven.output;
  const auto summary = nlohmann::json::parse(content(folder_ / "one/summary.json"));
  EXPECT_EQ(summary.at("settings").at("options").at("svg_mppi").at("samples"), 8000)
      << "options of a method that drives opponents only are kept for replays";
  EXPECT_GT(summary.at("results").at(0).at("overtaking").at("met"), 0);
  EXPECT_TRUE(summary.at("results").at(0).at("overtaking").at("side_changes").is_number_integer());
  const ProgramRun lap = run("replay one --lap 0");
  EXPECT_EQ(lap.status, 0) << lap.output;
  EXPECT_TRUE(contains(lap.output, "bit for bit")) << lap.output;
}

TEST_F(EvalCommand, RemembersTheFolderOfACourseThatHasNoKnownName) {
  fs::copy(SLALOM_COURSES "/wren", folder_ / "elsewhere");
  const std::string drive =
      "--methods mppi --config default_kinematic --set mppi.samples=64 --laps 1 --scenario pt --out one ";
  ASSERT_EQ(run("eval --course elsewhere " + drive).status, 0);
  const auto settings = nlohmann::json::parse(content(folder_ / "one/settings.json"));
  EXPECT_EQ(settings.at("course_folder"), fs::canonical(folder_ / "elsewhere").string());
  const ProgramRun lap = run("replay one --lap 0");
  EXPECT_EQ(lap.status, 0) << lap.output;
  EXPECT_TRUE(contains(lap.output, "bit for bit")) << lap.output;

  ASSERT_EQ(run("drive --course elsewhere --json lap.json --set svg_mppi.samples=64").status, 0);
  const auto driven = nlohmann::json::parse(content(folder_ / "lap.json"));
  EXPECT_EQ(driven.at("settings").at("course_folder"), settings.at("course_folder"));
  // A course with a known name is found by it on any machine.
  ASSERT_EQ(run("drive --course wren --json wren.json --set svg_mppi.samples=64").status, 0);
  EXPECT_FALSE(
      nlohmann::json::parse(content(folder_ / "wren.json")).at("settings").contains("course_folder"));
}

TEST_F(EvalCommand, ReproduceComparesWithTheLogsOfAClone) {
  testing::write_paper_clone(folder_ / "clone", SLALOM_COURSES "/wren");
  const std::string small =
      "--quick --set mppi.samples=16 --set svg_mppi.samples=16 --set svg_mppi.gradient_samples=4 --set "
      "reverse_mppi.samples=4 --set reverse_mppi.iterations=2 --set sv_mpc.samples=4 --evaluation true "
      "--laps-pt 1 --laps-oa 1 ";
  const ProgramRun compared = run("reproduce --paper clone --tables table2 --out r " + small);
  ASSERT_EQ(compared.status, 0) << compared.output;
  EXPECT_TRUE(contains(compared.output, "36 of 36 logs")) << compared.output;
  EXPECT_TRUE(contains(compared.output, "Table II")) << compared.output;
  auto summary = nlohmann::json::parse(content(folder_ / "r/summary.json"));
  ASSERT_EQ(summary.at("results").size(), 8u);
  for (const auto& result : summary.at("results")) {
    EXPECT_EQ(result.at("published").at("paired_laps"), result.at("scenario") == "oa" ? 1 : 0) << result;
    EXPECT_EQ(result.at("verdict").get<std::string>().find("not compared"), std::string::npos) << result;
  }
  for (const char* file : {"report.html", "figures/table2.svg", "figures/fig2a.png", "figures/fig2b.png"})
    EXPECT_TRUE(fs::exists(folder_ / "r" / file)) << file;

  const ProgramRun alone = run("reproduce --course " SLALOM_COURSES "/wren --tables table1 --out s " + small);
  ASSERT_EQ(alone.status, 0) << alone.output;
  EXPECT_TRUE(contains(alone.output, "https://github.com/kohonda/proj-svg_mppi")) << alone.output;
  summary = nlohmann::json::parse(content(folder_ / "s/summary.json"));
  EXPECT_EQ(summary.at("results").size(), 14u);
  for (const auto& result : summary.at("results")) {
    EXPECT_TRUE(result.at("published").is_null());
    EXPECT_EQ(result.at("verdict"), "not compared");
  }
}

}  // namespace
}  // namespace slalom::tools
