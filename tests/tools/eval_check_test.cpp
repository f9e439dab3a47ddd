// `slalom eval`: a folder belongs to one run, and --check finds what is not as it was driven.
#include "tools/evaluation_folder.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using ProgramRun = testing::Run;
using testing::contains;
using testing::content;

class EvalCheck : public testing::EvaluationFolder {
 protected:
  static std::string small(int laps = 3) {
    return "eval --course " SLALOM_COURSES "/wren --methods mppi --scenario oa --obstacles 2 --laps " +
           std::to_string(laps) + " --config default_kinematic --set mppi.samples=48 ";
  }
};

TEST_F(EvalCheck, TwoRunsDoNotShareAFolder) {
  const pid_t first = fork();
  if (first == 0) {
    const std::string command =
        "cd '" + folder_.string() + "' && exec '" SLALOM_PROGRAM "' " + small(500) + "--out shared >log 2>&1";
    execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
    _exit(127);
  }
  for (int i = 0; i < 600 && !fs::exists(folder_ / "shared/laps.journal.csv"); ++i) usleep(50000);
  const ProgramRun second = run(small(500) + "--resume --out shared");
  kill(first, SIGKILL);
  waitpid(first, nullptr, 0);
  EXPECT_EQ(second.status, 1);
  EXPECT_TRUE(contains(second.output, "shared: is in use by another process")) << second.output;
}

TEST_F(EvalCheck, CheckFindsDamageAndDrivesLapsAgain) {
  ASSERT_EQ(run(small() + "--out whole").status, 0);
  const ProgramRun good = run("eval --check whole --again 2");
  EXPECT_EQ(good.status, 0) << good.output;
  EXPECT_TRUE(contains(good.output, "3 of 3 laps: seeds as expected, checksums correct")) << good.output;
  EXPECT_TRUE(contains(good.output, "2 of 2 laps driven again are identical")) << good.output;
  EXPECT_EQ(run("eval --check whole --out other").status, 2);
  EXPECT_EQ(run("eval --methods mppi").status, 2) << "--out is required";

  const fs::path table = folder_ / "whole/laps.csv";
  const std::string text = content(table);
  std::string damaged = text;
  damaged[damaged.find("\nmppi") + 20] ^= 1;
  std::ofstream(table) << damaged;
  const ProgramRun flipped = run("eval --check whole");
  EXPECT_EQ(flipped.status, 1);
  EXPECT_TRUE(contains(flipped.output, "laps.csv:2: checksum: the row is damaged")) << flipped.output;

  // A cost that nobody drove, with the checksum of its row.
  std::istringstream lines(text);
  std::string changed;
  for (std::string line; std::getline(lines, line);) {
    auto columns = testing::cells(line.substr(0, line.rfind(',')));
    if (columns.at(0) != "mppi") {
      changed += line + "\n";
      continue;
    }
    columns.at(8) = "7.5";  // state_cost
    std::string row;
    for (std::size_t i = 0; i < columns.size(); ++i) row += (i > 0 ? "," : "") + columns[i];
    changed += evaluation::checked_line(row) + "\n";
  }
  std::ofstream(table) << changed;
  EXPECT_TRUE(contains(run("eval --check whole --again 3").output, "NOT identical"));
}

}  // namespace
}  // namespace slalom::tools
