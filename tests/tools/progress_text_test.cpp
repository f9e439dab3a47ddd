// Progress bars fit the terminal and never promise a time that is over; nearest words; completion; man pages.
#include "tools/terminal/progress_text.hpp"

#include <gtest/gtest.h>

#include "tools/command_line/description.hpp"
#include "tools/command_line/nearest.hpp"
#include "tools/commands/commands.hpp"

namespace slalom::tools {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

evaluation::EvaluationProgress progress(int done, int total, double seconds_left) {
  evaluation::EvaluationProgress p;
  p.laps_done = done;
  p.laps_total = total;
  p.seconds_left = seconds_left;
  return p;
}

TEST(ProgressText, AnEvaluationFitsAnyTerminal) {
  for (const int columns : {10, 20, 40, 60, 80, 120}) {
    for (const int done : {0, 1, 999, 1000}) {
      const std::string text =
          evaluation_text("candidate 12 of 64", progress(done, 1000, 7384), columns, false);
      EXPECT_LT(text.size(), static_cast<std::size_t>(columns)) << text;
    }
  }
  EXPECT_EQ(evaluation_text("", progress(5, 10, 62), 80, false),
            "[###############...............] 5 of 10 laps, 1 min 02 s left");
}

TEST(ProgressText, NoTimeIsLeftThatIsNotKnownOrOver) {
  EXPECT_FALSE(contains(evaluation_text("", progress(0, 10, 0), 80, false), "left"));
  EXPECT_FALSE(contains(evaluation_text("", progress(10, 10, 0), 80, false), "left"));
  EXPECT_TRUE(contains(evaluation_text("", progress(9, 10, 0.2), 80, false), "1 s left"));
}

TEST(ProgressText, ALapShowsWhatThereIsRoomFor) {
  const std::vector<std::string> parts = {"12.3 s",        "0 collisions", "3.4 m/s",
                                          "cost 1.23e+03", "0.26 ms",      "ESS 4200 of 8000"};
  for (const int columns : {8, 20, 40, 60, 80, 120})
    EXPECT_LT(lap_text("lap 10 of 100", 0.3, parts, columns, false).size(),
              static_cast<std::size_t>(columns));
  const std::string narrow = lap_text("lap 1 of 3", 0.5, parts, 60, false);
  EXPECT_TRUE(contains(narrow, "12.3 s  0 collisions")) << narrow;
  EXPECT_FALSE(contains(narrow, "ESS")) << narrow;
  EXPECT_TRUE(contains(lap_text("lap 1 of 3", 0.5, parts, 120, false), "ESS 4200 of 8000"));
}

TEST(ProgressText, ColourTakesNoRoom) {
  std::string coloured = progress_bar(0.5, 10, true);
  EXPECT_TRUE(contains(coloured, "\033[32m#####\033[0m....."));
  EXPECT_EQ(progress_bar(0.5, 10, false), "[#####.....]");
}

TEST(NearestWord, FindsWhatWasMeant) {
  const std::vector<std::string> words = {"drive", "eval", "explain", "view", "track", "tune"};
  EXPECT_EQ(nearest_word("drvie", words), "drive");
  EXPECT_EQ(nearest_word("veiw", words), "view");
  EXPECT_EQ(nearest_word("evaluate", words), "");
  EXPECT_EQ(nearest_word("explian", words), "explain");
  EXPECT_EQ(nearest_word("xyz", words), "");
}

TEST(Description, EveryCommandHasACompletionAndAManPageWithAllItsOptions) {
  const auto commands = describe_commands(all_commands());
  ASSERT_EQ(commands.size(), all_commands().size());
  const CompletionValues values{.courses = {"eel"}, .configurations = {"default"}, .methods = {"mppi"}};
  const std::string bash = completion_script("bash", commands, values);
  const std::string zsh = completion_script("zsh", commands, values);
  const auto pages = manual_pages(commands);
  ASSERT_EQ(pages.size(), commands.size() + 1);
  for (std::size_t i = 0; i < commands.size(); ++i) {
    EXPECT_FALSE(commands[i].summary.empty()) << commands[i].name;
    EXPECT_EQ(pages[i + 1].file, "slalom-" + commands[i].name + ".1");
    EXPECT_TRUE(contains(bash, "    " + commands[i].name + ") options=")) << commands[i].name;
    for (const OptionDescription& option : commands[i].options) {
      std::string escaped;
      for (const char c : option.name) escaped += c == '-' ? std::string("\\-") : std::string(1, c);
      EXPECT_TRUE(contains(pages[i + 1].text, ".B " + escaped)) << commands[i].name << " " << option.name;
      if (option.name.rfind("--", 0) != 0) continue;
      EXPECT_TRUE(contains(bash, " " + option.name)) << commands[i].name << " " << option.name;
      EXPECT_TRUE(contains(zsh, "'*" + option.name + "[")) << commands[i].name << " " << option.name;
    }
  }
  EXPECT_THROW(completion_script("fish", commands, values), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::tools
