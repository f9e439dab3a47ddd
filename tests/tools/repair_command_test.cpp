// `slalom replay --repair`: recordings of drives that were killed, and what a failure leaves.
#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "tools/program_test.hpp"

namespace slalom::tools {
namespace {

namespace fs = std::filesystem;
using testing::content;

class RepairCommand : public testing::ProgramTest {
 protected:
  /// Records laps without end to `file` and kills the program when `enough` is true of the file's bytes.
  /// Whether it was killed then.
  template <class Enough>
  bool record_and_kill(const std::string& file, const Enough& enough) const {
    const std::string command = "cd '" + folder_.string() +
                                "' && exec '" SLALOM_PROGRAM "' drive --course '" SLALOM_COURSES
                                "/wren' --method mppi --set samples=32 --laps 1000 --record " +
                                file;
    const pid_t child = fork();
    if (child == 0) {
      const int nothing = open("/dev/null", O_WRONLY);
      dup2(nothing, 1);
      dup2(nothing, 2);
      execl("/bin/sh", "sh", "-c", command.c_str(), static_cast<char*>(nullptr));
      _exit(127);
    }
    int status = 0;
    for (int waits = 0; waits < 1200 && !enough(content(folder_ / file)); ++waits) {
      if (waitpid(child, &status, WNOHANG) == child) return false;
      usleep(50000);
    }
    kill(child, SIGKILL);
    waitpid(child, &status, 0);
    return WIFSIGNALED(status) && enough(content(folder_ / file));
  }
};

TEST_F(RepairCommand, AKilledDriveInJsonLinesIsKeptUpToItsLastWholeLine) {
  ASSERT_TRUE(record_and_kill("cut.jsonl", [](const std::string& bytes) { return bytes.size() > 400000; }));
  const auto run = program("replay cut.jsonl --repair whole.jsonl");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("bytes of cut.jsonl were lost"), std::string::npos) << run.output;
  const std::string cut = content(folder_ / "cut.jsonl"), whole = content(folder_ / "whole.jsonl");
  ASSERT_FALSE(whole.empty());
  EXPECT_EQ(whole.back(), '\n');
  // At most the newline of the last record is new.
  EXPECT_EQ(whole.substr(0, std::min(whole.size(), cut.size())), cut.substr(0, whole.size()));
  EXPECT_GE(whole.size(), std::min(cut.rfind('\n') + 1, cut.size()));
  std::istringstream lines(whole);
  int ticks = 0;
  for (std::string line; std::getline(lines, line);)
    ticks += nlohmann::json::parse(line).at("type") == "tick";
  EXPECT_GT(ticks, 10);
  const auto again = program("replay whole.jsonl --repair again.jsonl");
  EXPECT_EQ(again.status, 0) << again.output;
  EXPECT_EQ(content(folder_ / "again.jsonl"), whole);
  // The other reader of such a recording names the repair.
  std::ofstream(folder_ / "torn.jsonl", std::ios::binary) << whole.substr(0, whole.size() - 20);
  expect_refused("identify torn.jsonl", {"torn.jsonl:", "was cut in this line", "slalom replay --repair"});
}

TEST_F(RepairCommand, AKilledDriveInMcapIsShownAfterTheRepair) {
  // Of two segments of the page, the first is whole.
  const auto two_segments = [](const std::string& bytes) {
    return bytes.find("replay/") != bytes.rfind("replay/");
  };
  ASSERT_TRUE(record_and_kill("cut.mcap", two_segments));
  const auto run = program("replay cut.mcap --repair whole.mcap");
  ASSERT_EQ(run.status, 0) << run.output;
  EXPECT_NE(run.output.find("bytes of cut.mcap were lost"), std::string::npos) << run.output;
  const auto shown = program("replay whole.mcap --html lap.html");
  EXPECT_EQ(shown.status, 0) << shown.output;
  EXPECT_EQ(shown.output.find("was cut"), std::string::npos) << shown.output;
  expect_refused("replay cut.mcap --repair whole.mcap", {"whole.mcap: exists"});
}

TEST_F(RepairCommand, AFailureLeavesNoFile) {
  for (const std::string text : {"no recording", "\x89MCAP0\r\n", "{\"type\":\"recording\"}\nno record\n"}) {
    write("bad", text);
    for (int attempt = 0; attempt < 2; ++attempt) {
      const auto run = program("replay bad --repair out");
      EXPECT_EQ(run.status, 1) << run.output;
      EXPECT_EQ(run.output.find("exists"), std::string::npos) << run.output;
      EXPECT_NE(run.output.find("bad"), std::string::npos) << run.output;
    }
    EXPECT_FALSE(fs::exists(folder_ / "out"));
    EXPECT_FALSE(fs::exists(folder_ / "out.new"));
  }
}

}  // namespace
}  // namespace slalom::tools
