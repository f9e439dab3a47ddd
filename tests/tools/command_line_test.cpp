// Mistakes that every command refuses in the same words, and results that are not lost.
#include <regex>
#include <sstream>

#include "tools/evaluation_folder.hpp"

namespace slalom::tools {
namespace {

const std::string wren = SLALOM_COURSES "/wren";

class CommandLine : public testing::EvaluationFolder {
 protected:
  /// In the scratch folder; a program that serves where it should have refused is ended.
  testing::Run timed(const std::string& arguments, const std::string& before = "") const {
    return testing::run_shell(before + " timeout 100 '" SLALOM_PROGRAM "' " + arguments, folder_.string());
  }
  void refuses(const std::string& arguments, const std::vector<std::string>& says, int status = 1) const {
    const testing::Run run = timed(arguments);
    EXPECT_EQ(run.status, status) << arguments << ": " << run.output;
    expect_says(run.output, says);
    EXPECT_FALSE(contains(run.output, "json.exception")) << run.output;
  }
  std::string evaluation(const std::string& out) const {
    return "eval --course " + wren +
           " --methods mppi --scenario pt --laps 1 --config default_kinematic --set mppi.samples=48 --out " +
           out;
  }
  const std::string plotted = "drive --course wren --method mppi --set samples=32 --plot ";
  /// Copies an evaluation of one lap and the recording of a lap into the folder.
  void prepare() const {
    fs::copy(testing::evaluated_lap(), folder_ / "ev");
    fs::copy(testing::small_recording(), folder_ / "lap.mcap");
  }
  /// The commands that print and end, with arguments for a short run; `out` is a file or folder of its own.
  std::vector<std::string> short_runs(const std::string& out) const {
    return {"bench --methods mppi --seconds 0.01 --json " + out,
            "compare ev ev --json " + out,
            "course '" SLALOM_COURSES "/wren/map.yaml' --out " + out,
            "drive --course wren --method mppi --set samples=32 --json " + out,
            "drive --again ev --lap 0",
            "export lap.mcap " + out + ".html",
            "identify lap.mcap --json " + out,
            evaluation(out),
            "options",
            "race --course wren --config default --method mppi --set samples=256 --laps 1 --json " + out,
            "track --length 30 --out " + out};
  }
};

TEST_F(CommandLine, AnUnknownInstructionSetDoesNotAbort) {
  for (const std::string arguments :
       {"drive --course wren", "explain --figure 1 --plot a.png", "view --port 0", "bench", "options"}) {
    const testing::Run run = timed(arguments, "SLALOM_TARGET=foo");
    EXPECT_EQ(run.status, 2) << arguments << ": " << run.output;
    expect_says(run.output, {"slalom: SLALOM_TARGET=foo: not one of avx512"});
  }
  EXPECT_EQ(timed("drive --help", "SLALOM_TARGET=foo").status, 0);
}

TEST_F(CommandLine, MessagesDoNotRepeatLongValues) {
  const std::string text(5000, 'x');
  for (const char* before : {"", "drive --", "drive --set samples=", "drive --course ", "drive --seed "}) {
    const testing::Run run = timed(before + text);
    EXPECT_LT(run.output.size(), 1100u) << before;
    expect_says(run.output, {"slalom: ", " ... "});
  }
}

TEST_F(CommandLine, AMistypedCommandOrOptionIsAnsweredWithTheNearest) {
  refuses("drvie --course wren", {"slalom: drvie: is not a command; did you mean drive?"}, 2);
  refuses("something", {"slalom: something: is not a command\n"}, 2);
  refuses("drive --obstcles 5", {"slalom: --obstcles: is not an option of drive; did you mean --obstacles?"},
          2);
}

/// Every option with a number, of every command, refuses what is none, and what is outside its range, in the
/// same words and with the same status.
TEST_F(CommandLine, EveryNumberIsCheckedInTheSameWords) {
  const auto words_of = [&](const std::string& arguments, const std::regex& pattern) {
    const std::string text = timed(arguments + " --help").output;
    std::vector<std::string> found;
    for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at)
      found.push_back((*at)[1]);
    return found;
  };
  const auto commands = words_of("", std::regex("\n  ([a-z][a-z-]+) +[A-Z]"));
  EXPECT_EQ(commands.size(), 17u);
  int options = 0, ranges = 0;
  const std::regex range(R"(must be a (whole )?number in \[([^,]*), ([^\]]*)\])");
  for (const std::string& command : commands)
    for (const std::string& option : words_of(command, std::regex("\n  (--[a-z0-9-]+) (?:INT|NUMBER)"))) {
      ++options;
      const std::string begin = command + " " + option;
      const std::string refused = timed(begin + " abc").output;
      for (const std::string value : {"abc", "nan", "99999999999999999999e999"})
        refuses(begin + " " + value, {"slalom: " + option + ": '" + value + "' must be a "}, 2);
      if (contains(refused, "must be a whole number from 0"))
        refuses(begin + " -1", {option + ": '-1' must be a whole number from 0"}, 2);
      EXPECT_EQ(std::count(refused.begin(), refused.end(), '\n'), 1) << refused;
      std::smatch found;
      if (!std::regex_search(refused, found, range)) continue;
      ++ranges;
      for (const auto& [bound, step] : {std::pair(found[2], -1), std::pair(found[3], 1)}) {
        const std::string value = std::to_string(std::stol(bound) + step);
        refuses(begin + " " + value, {"slalom: " + option + ": '" + value + "' must be a "}, 2);
      }
    }
  EXPECT_GT(options, 40);
  EXPECT_GT(ranges, 30);
}

TEST_F(CommandLine, HelpFitsTheTerminalAndHasExamples) {
  for (const std::string command :
       {"bench", "compare", "course", "drive", "eval", "explain", "export", "identify", "navigate", "options",
        "race", "racing-benchmark", "replay", "reproduce", "track", "tune", "view"}) {
    const std::string text = timed(command + " --help").output;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << command << ": " << line;
    expect_says(text, {"\nExamples:\n  slalom " + command});
    EXPECT_FALSE(contains(text, " in [")) << "a rule of the parser: " << text;
  }
  expect_says(timed("course --help").output, {"  --out TEXT              Required. Output folder"});
}

TEST_F(CommandLine, AFullStandardOutputIsAnError) {
  ASSERT_TRUE(fs::exists("/dev/full"));
  for (const std::string arguments :
       {"options", "options --json -", "options --yaml", "--help", "--version"}) {
    succeed(arguments + " >/dev/null");
    const testing::Run run = timed(arguments + " >/dev/full");
    EXPECT_EQ(run.status, 1) << arguments;
    expect_says(run.output, {"slalom: standard output: cannot be written"});
  }
}

TEST_F(CommandLine, AStandardOutputThatIsClosedIsAnErrorAndLosesNothing) {
  prepare();
  const auto open = short_runs("open"), closed = short_runs("closed"), broken = short_runs("broken");
  for (std::size_t i = 0; i < open.size(); ++i) {
    for (const char* name : {"open", "closed", "broken"}) fs::remove_all(folder_ / name);
    succeed(open[i]);
    const testing::Run without = timed(closed[i] + " >&-");
    EXPECT_EQ(without.status, 1) << closed[i];
    expect_says(without.output, {"slalom: standard output: cannot be written"});
    const testing::Run unread = testing::run_shell(
        "{ sleep 0.05; '" SLALOM_PROGRAM "' " + broken[i] + "; echo status $? >&2; } | true",
        folder_.string());
    expect_says(unread.output, {"slalom: standard output: cannot be written", "status 1"});
    if (!contains(open[i], "--json")) continue;
    EXPECT_EQ(result("closed").size(), result("open").size()) << closed[i];
    EXPECT_EQ(result("broken").size(), result("open").size()) << broken[i];
  }
}

TEST_F(CommandLine, AFileDoesNotTakeThePlaceOfAClosedStream) {
  fs::copy(wren, folder_ / "short");
  std::ofstream(folder_ / "short/course.yaml") << "timeout: 1\n";
  for (const std::string closed : {" >&-", " 2>&-", " <&-", " <&- >&- 2>&-"}) {
    timed("drive --course short --method mppi --set samples=32 --record lap.mcap" + closed);
    const std::string recording = content(folder_ / "lap.mcap");
    EXPECT_FALSE(contains(recording, "lap 1:")) << closed;
    EXPECT_EQ(recording.rfind("\x89MCAP", 0), 0u) << closed;
  }
}

TEST_F(CommandLine, ChecksItsOutputFilesFirst) {
  write("kept.json", "kept");
  write("lap.mcap", "{}\n");
  for (const std::string arguments :
       {"drive --course wren --json kept.json --plot ", "drive --course wren --record new.mcap --json ",
        "bench --json ", "explain --figure 1 --plot ", "export lap.mcap ", "identify lap.mcap --json ",
        "eval --out e --json "})
    refuses(arguments + "nodir/x.png", {"slalom: nodir/x.png: cannot be written: No such file"});
  refuses("options --json .", {".: cannot be written: is a folder"});
  EXPECT_EQ(content(folder_ / "kept.json"), "kept");
  EXPECT_FALSE(fs::exists(folder_ / "new.mcap"));
  EXPECT_FALSE(fs::exists(folder_ / "e"));
}

TEST_F(CommandLine, RejectsOneFileForTwoOutputs) {
  write("in.mcap", "{}\n");
  refuses("drive --course wren --json same.mcap --record same.mcap", {"--json", "--record", "same.mcap"}, 2);
  refuses("drive --course wren --json a.png --plot ./a.png", {"--json", "--plot", "a.png"}, 2);
  refuses("identify in.mcap --json in.mcap", {"recording", "--json", "in.mcap"}, 2);
  EXPECT_EQ(content(folder_ / "in.mcap"), "{}\n");
  refuses("drive --course wren --record -", {"--record", "only --json accepts -"}, 2);
  refuses("explain --figure 1 --plot -", {"--plot", "only --json accepts -"}, 2);
  refuses("drive --course wren --record lap.jsonl", {"--record: 'lap.jsonl' must end in .mcap"}, 2);
  refuses("explain --figure 1 --plot x.jpg", {"--plot: 'x.jpg' must end in .png, .svg or .pdf"}, 2);
  EXPECT_FALSE(fs::exists(folder_ / "x.jpg") || fs::exists(folder_ / "same.mcap"));
  succeed(plotted + "/dev/null");
}

TEST_F(CommandLine, RejectsEmptyValues) {
  for (const std::string arguments :
       {"drive --json ''", "drive --plot ''", "drive --record ''", "drive --start ''", "view --token ''",
        "track --out ''", "eval --methods '' --out e", "compare '' ''"})
    refuses(arguments, {"the value must not be empty"}, 2);
  refuses("drive --seed 99999999999999999999", {"--seed", "must be a whole number from 0"}, 2);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(CommandLine, RejectsContradictoryOptions) {
  refuses("options --json - --yaml", {"--json", "--yaml"}, 2);
  refuses("options --yaml --method mppi", {"--method", "--yaml"}, 2);
  refuses("drive --record-times", {"--record-times", "--record"}, 2);
  refuses("bench --methods foo", {"--methods: ", "foo", "svg_mppi"}, 2);
  for (const char* scenario : {"--course fox", "--set mppi.samples=9"})
    refuses(std::string("view --problem pendulum --port 0 ") + scenario, {"--problem: has only --method"}, 2);
}

TEST_F(CommandLine, ReproduceRequiresTheCourseAndTheCloneThatAreNamed) {
  refuses("reproduce --course nowhere/berlin --out r", {"--course: ", "nowhere/berlin"}, 2);
  const std::string command = "reproduce --course " + wren + " --out /proc/none --paper clone";
  refuses(command, {"--paper: clone: has no folder data/map"}, 2);
  fs::create_directories(folder_ / "clone/data/map");
  fs::create_directories(folder_ / "clone/src/eval/log/path_tracking");
  refuses(command, {"slalom: /proc/none"});
  refuses("reproduce --paper clone --out r --tables table3", {"--tables: 'table3' must be table1"}, 2);
  refuses("reproduce --claims", {"--claims: needs --paper"}, 2);
}

TEST_F(CommandLine, ReplayTellsWhatReadsABag) {
  fs::create_directory(folder_ / "first");
  std::ofstream(folder_ / "first/metadata.yaml") << "rosbag2_bagfile_information:";
  std::ofstream(folder_ / "first/first_0.db3") << "SQLite format 3";
  for (const char* bag : {"first", "first/first_0.db3"})
    refuses(std::string("replay ") + bag, {bag + std::string(": is a bag of rosbag2"), "slalom identify"});
}

TEST_F(CommandLine, ALapThatIsDrivenAgainHasTheSettingsOfItsEvaluation) {
  refuses("drive --again ev --lap 0", {"ev/settings.json"});
  prepare();
  refuses("drive --again ev", {"--lap: is required with --again"}, 2);
  refuses("drive --again ev --lap 1", {"--lap: '1' must be in [0, 0]"}, 2);
  for (const std::string option : {"--seed 3", "--set mppi.samples=9", "--config race", "--laps 2"})
    refuses("drive --again ev --lap 0 " + option, {"--again: has only --lap, --scenario"}, 2);
  refuses("drive --lap 0", {"--lap: needs --again"}, 2);
}

TEST_F(CommandLine, NamesEmptyEvaluations) {
  prepare();
  fs::copy(folder_ / "ev", folder_ / "none");
  const std::string table = content(folder_ / "ev/laps.csv");
  std::ofstream(folder_ / "none/laps.csv") << table.substr(0, table.find('\n') + 1);
  refuses("compare ev none", {"none", "has no lap of mppi"});
  refuses("compare none ev", {"none", "has no lap of mppi"});
  std::ofstream(folder_ / "ev/settings.json") << "[]";
  refuses(evaluation("ev") + " --resume", {"ev/settings.json: ", "is not a JSON object"});
  refuses("drive --again ev --lap 0", {"ev/settings.json: ", "is not a JSON object"});
}

TEST_F(CommandLine, PicturesAreWrittenInTheFormatOfTheirEnding) {
  for (const auto& [ending, begin] : {std::pair("png", "\x89PNG"), {"svg", "<?xml"}, {"pdf", "%PDF"}}) {
    succeed(plotted + "lap." + ending);
    EXPECT_EQ(content(folder_ / (std::string("lap.") + ending)).rfind(begin, 0), 0u) << ending;
  }
}

TEST_F(CommandLine, ATokenMustFitIntoAnAddress) {
  refuses("view --port 0 --token 'a b/&?#'", {"--token: 'a b/&?#' must have only letters, digits"}, 2);
}

TEST_F(CommandLine, ReportsThatMemoryRanOut) {
#if !SLALOM_TESTS_LIMITS
  GTEST_SKIP() << "sanitizers take more address space than the limit leaves";
#endif
  const testing::Run run =
      timed("drive --course wren --config default_kinematic --set samples=4194304 --set horizon=10000",
            "ulimit -v 3000000;");
  EXPECT_EQ(run.status, 1);
  expect_says(run.output, {"not enough memory"});
}

}  // namespace
}  // namespace slalom::tools
