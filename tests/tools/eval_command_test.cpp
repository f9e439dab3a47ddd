// `slalom eval` and `slalom reproduce`: killed at any moment nothing is lost; settings do not mix; what is
// wrong is named.
#include "tools/evaluation_folder.hpp"
#include "tools/paper_clone.hpp"

namespace slalom::tools {
namespace {

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
  succeed(small() + "--jobs 1 --out whole");
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
  succeed(small() + "--jobs 2 --resume --out torn");
  EXPECT_EQ(repeatable(folder_ / "torn/laps.csv"), whole);
  EXPECT_FALSE(fs::exists(folder_ / "torn/laps.journal.csv"));
  succeed(small() + "--resume --out torn");  // a whole one can be resumed, too
  EXPECT_EQ(repeatable(folder_ / "torn/laps.csv"), whole);
}

TEST_F(EvalCommand, AFullDiskIsReportedAndNoLapIsLost) {
  fs::create_directories(folder_ / "full");
  fs::create_symlink("/dev/full", folder_ / "full/settings.json.new");
  expect_refused(small(1) + "--out full", {"full/settings.json.new: cannot be written: No space left"}, 1);

  // A disk that becomes full on the way: no file may grow beyond a few blocks.
  succeed(small() + "--out whole");
  const auto settings = fs::file_size(folder_ / "whole/settings.json"),
             table = fs::file_size(folder_ / "whole/laps.csv");
  ASSERT_GT(table, 512u);
  const std::string limit = "trap '' XFSZ; ulimit -f " + std::to_string(settings / 512 + 1) + "; ";
  std::string arguments = small(60);
  const testing::Run torn =
      testing::run_shell(limit + "'" SLALOM_PROGRAM "' " + arguments + "--out torn", folder_.string());
  EXPECT_EQ(torn.status, 1);
  expect_says(torn.output, {"laps.journal.csv: cannot be written"});
  const std::size_t kept = count_lines(folder_ / "torn/laps.journal.csv");
  EXPECT_GT(kept, 2u);
  EXPECT_TRUE(kill_after(arguments + "--resume --out torn", 700));
  EXPECT_GE(count_lines(folder_ / "torn/laps.journal.csv"), kept);
}

TEST_F(EvalCommand, RejectsLapsOfAnotherBuild) {
  succeed(small(1) + "--out one");
  auto settings = nlohmann::ordered_json::parse(content(folder_ / "one/settings.json"));
  ASSERT_FALSE(settings.at("build").get<std::string>().empty());
  settings["build"] = "0123456789ab";
  write_settings(folder_ / "one", settings.dump(2));
  succeed(small(1) + "--resume --out one");  // nothing is left to drive, so nothing is mixed

  const std::string table = content(folder_ / "one/laps.csv");
  fs::remove(folder_ / "one/laps.csv");
  write("one/laps.journal.csv", table.substr(0, table.find('\n', table.find('\n') + 1) + 1));
  expect_refused(small(1) + "--resume --out one",
                 {"the laps were driven by another build of the program (build 0123456789ab", "--any-build"},
                 1);
  succeed(small(1) + "--resume --any-build --out one");
  const std::string builds = result("one/settings.json").at("build");
  EXPECT_EQ(builds.rfind("0123456789ab ", 0), 0u) << builds;
}

TEST_F(EvalCommand, RejectsLapsOfOtherSettings) {
  expect_refused("eval --methods mppi", {"--out: is required"}, 2);
  succeed(small(1) + "--out one");
  expect_refused(small(1) + "--out one", {"--resume"}, 1);
  expect_refused(small(1) + "--out one --resume --seed 7 --evaluation published",
                 {"seed0: 0 stored, 7 requested", "evaluation: \"true\" stored, \"published\" requested"}, 1);
}

TEST_F(EvalCommand, ReportsInvalidArgumentsBeforeTheFirstLap) {
  const std::string course = "eval --course " SLALOM_COURSES "/wren --laps 1 ";
  expect_refused(course + "--methods mmpi --out x", {"mmpi"});
  expect_refused(course + "--methods mppi --set mppi.sampels=3 --out x",
                 {"--set: ", "did you mean mppi.samples"}, 2);
  expect_refused(course + "--methods mppi --set mppi.samples=-3 --out x", {"samples"});
  expect_refused(course + "--scenario ot --out x", {"'ot' must be pt or oa"});
  expect_refused("eval --course nowhere --laps 1 --out x", {"nowhere"});
  expect_refused(course + "--methods mppi,mppi --out x", {"twice"});
  expect_refused(course + "--set svg_mppi.samples=32,32 --out x", {"twice"});
  expect_refused(course + "--methods mppi --set svg_mppi.samples=256,512 --out x",
                 {"--set: 'svg_mppi.samples' must be an option of a method"}, 2);
  expect_refused(course + "--methods mppi --set temperature=2,3 --set mppi.temperature=1 --out x",
                 {"--set", "given twice"}, 2);
  EXPECT_FALSE(fs::exists(folder_ / "x"));
  expect_refused(course + "--out /proc/nothing/here", {"/proc/nothing/here"});
  write("file", "not a folder");
  expect_refused(course + "--out file", {"file"});
  EXPECT_FALSE(fs::exists(folder_ / "x/laps.csv"));
}

TEST_F(EvalCommand, WritesASummary) {
  const std::string said = succeed(small(1) + "--out one --report --json -");
  const auto summary = result("one/summary.json");
  ASSERT_EQ(summary.at("results").size(), 2u);
  for (const auto& result : summary.at("results")) {
    for (const char* key : {"method", "scenario", "laps", "ms_mean", "ms_ci", "collisions", "collision_rate",
                            "collision_rate_ci", "success_rate", "time_mean", "time_ci", "solve_ms"})
      EXPECT_TRUE(result.contains(key)) << key;
    for (const char* interval : {"ms_ci", "time_ci"})
      EXPECT_TRUE(result.at(interval).is_null()) << "of fewer than five laps";
    EXPECT_LE(result.at("success_rate"), 1.0);
  }
  const std::string html = content(folder_ / "one/report.html");
  EXPECT_TRUE(contains(html, "</html>"));
  EXPECT_FALSE(contains(html, "src=\"http")) << "needs nothing but itself";
  EXPECT_LT(html.find("Paired comparison"), html.find("<table")) << "begins with the result";
  EXPECT_LT(html.find("<table"), html.find("<img"));
  EXPECT_FALSE(contains(html, "authors' laps")) << "only terms that are used are explained";
  expect_says(html, {"<p>oa: "});  // who is better, in a sentence
  expect_says(said, {"one/report.html"});
  EXPECT_TRUE(fs::exists(folder_ / "one/figures/methods.svg"));
}

TEST_F(EvalCommand, DrivesALapAgainBitForBitAndComparesTwoRuns) {
  succeed(small(2) + "--out one");
  expect_says(succeed("drive --again one --method svg_mppi --lap 1 --course " SLALOM_COURSES
                      "/wren --plot lap.png --record lap.mcap --json lap.json"),
              {"lap 1: finished", "bit for bit"});
  EXPECT_EQ(result("lap.json")["laps"][0]["seed"], 7);
  EXPECT_TRUE(fs::exists(folder_ / "lap.png"));
  EXPECT_GT(fs::file_size(folder_ / "lap.mcap"), 50'000u);
  expect_refused("drive --again one --lap 0", {"must name one of these"});
  expect_refused("drive --again one --method mppi --lap 2", {"--lap"});
  expect_refused("drive --again one --method mppi --lap 0 --course " SLALOM_COURSES "/stag", {});

  EXPECT_EQ(succeed("compare one one --json same.json")
                .rfind("No difference between one and one is significant", 0),
            0u);
  const auto compared = result("same.json");
  ASSERT_EQ(compared.at("results").size(), 2u);
  EXPECT_EQ(compared.at("settings").size(), 0u);
  for (const auto& result : compared.at("results")) {
    EXPECT_TRUE(result.at("paired").get<bool>());
    EXPECT_EQ(result.at("ms_p"), 1);
    EXPECT_EQ(result.at("time_p"), 1);
  }
  expect_refused("compare one nowhere", {});

  // Folders of evaluations: each place, then all its laps together.
  for (const char* place : {"a/wren", "a/again", "b/wren", "b/again", "c/other"}) {
    fs::create_directories((folder_ / place).parent_path());
    fs::copy(folder_ / "one", folder_ / place, fs::copy_options::recursive);
  }
  succeed("compare a b --json places.json");
  const auto all = result("places.json").at("results");
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all.at(0).at("place"), "again");
  EXPECT_EQ(all.at(2).at("place"), "wren");
  for (std::size_t sum : {4u, 5u}) {
    EXPECT_EQ(all.at(sum).at("place"), "all 2");
    EXPECT_EQ(all.at(sum).at("first").at("laps").get<int>(), 2 * all.at(0).at("first").at("laps").get<int>());
    EXPECT_NEAR(all.at(sum).at("first").at("ms_mean").get<double>(),
                all.at(sum - 4).at("first").at("ms_mean").get<double>(), 1e-12);
  }
  expect_refused("compare a c", {"or a folder of evaluations"});
}

TEST_F(EvalCommand, EveryExperimentMeetsTheSameOpponentsWithPlanners) {
  succeed(
      "eval --course " SLALOM_COURSES
      "/wren --methods mppi --scenario pt --laps 1 --config default_kinematic --set mppi.samples=48 --set "
      "world.opponents=1 --set world.planning_opponents=1 --set world.opponent_gap=3 --out one");
  const auto summary = result("one/summary.json");
  EXPECT_EQ(summary.at("settings").at("options").at("svg_mppi").at("samples"), 8000)
      << "options of a method that drives opponents only are kept for replays";
  EXPECT_GT(summary.at("results").at(0).at("overtaking").at("opponents_met"), 0);
  EXPECT_TRUE(summary.at("results").at(0).at("overtaking").at("side_changes").is_number_integer());
  expect_says(succeed("drive --again one --lap 0"), {"bit for bit"});
}

TEST_F(EvalCommand, RemembersTheFolderOfACourseThatHasNoKnownName) {
  fs::copy(SLALOM_COURSES "/wren", folder_ / "elsewhere");
  const std::string drive =
      "--methods mppi --config default_kinematic --set mppi.samples=64 --laps 1 --scenario pt --out one ";
  succeed("eval --course elsewhere " + drive);
  const auto settings = result("one/settings.json");
  EXPECT_EQ(settings.at("course_folder"), fs::canonical(folder_ / "elsewhere").string());
  expect_says(succeed("drive --again one --lap 0"), {"bit for bit"});

  succeed("drive --course elsewhere --json lap.json --set svg_mppi.samples=64");
  EXPECT_EQ(result("lap.json").at("settings").at("course_folder"), settings.at("course_folder"));
  // A course with a known name is found by it on any machine.
  succeed("drive --course wren --json wren.json --set svg_mppi.samples=64");
  EXPECT_FALSE(result("wren.json").at("settings").contains("course_folder"));
}

TEST_F(EvalCommand, ReproduceComparesWithTheLogsOfAClone) {
  testing::write_paper_clone(folder_ / "clone", SLALOM_COURSES "/wren");
  const std::string small =
      "--quick --set mppi.samples=16 --set svg_mppi.samples=16 --set svg_mppi.gradient_samples=4 --set "
      "reverse_mppi.samples=4 --set reverse_mppi.iterations=2 --set sv_mpc.samples=4 --evaluation true "
      "--laps-pt 1 --laps-oa 1 ";
  expect_says(succeed("reproduce --paper clone --tables table2 --out r " + small),
              {"36 of 36 logs", "Table II"});
  auto summary = result("r/summary.json");
  ASSERT_EQ(summary.at("results").size(), 8u);
  for (const auto& result : summary.at("results")) {
    EXPECT_EQ(result.at("published").at("paired_laps"), result.at("scenario") == "oa" ? 1 : 0) << result;
    EXPECT_EQ(result.at("verdict").get<std::string>().find("not compared"), std::string::npos) << result;
  }
  for (const char* file : {"report.html", "figures/table2.svg", "figures/table2.png"})
    EXPECT_TRUE(fs::exists(folder_ / "r" / file)) << file;

  expect_says(succeed("reproduce --course " SLALOM_COURSES "/wren --tables table1 --out s " + small),
              {"https://github.com/kohonda/proj-svg_mppi"});
  summary = result("s/summary.json");
  EXPECT_EQ(summary.at("results").size(), 14u);
  for (const auto& result : summary.at("results")) {
    EXPECT_TRUE(result.at("published").is_null());
    EXPECT_EQ(result.at("verdict"), "not compared");
  }
}

}  // namespace
}  // namespace slalom::tools
