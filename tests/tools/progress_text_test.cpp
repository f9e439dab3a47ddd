// Progress bars fit the terminal and never promise a time that is over.
#include "tools/terminal/progress.hpp"

#include <gtest/gtest.h>

namespace slalom::tools {
namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

evaluation::EvaluationProgress progress(int done, int total, double seconds_left) {
  return {.laps_done = done, .laps_total = total, .seconds_left = seconds_left};
}

TEST(ProgressText, AnEvaluationFitsAnyTerminal) {
  for (const int columns : {10, 20, 40, 60, 80, 120}) {
    for (const int done : {0, 1, 999, 1000}) {
      const std::string text = evaluation_text(progress(done, 1000, 7384), columns, false);
      EXPECT_LT(text.size(), static_cast<std::size_t>(columns)) << text;
    }
  }
  EXPECT_EQ(evaluation_text(progress(5, 10, 62), 80, false),
            "[###############...............] 5 of 10 laps, 1 min 02 s left");
}

TEST(ProgressText, NoTimeIsLeftThatIsNotKnownOrOver) {
  EXPECT_FALSE(contains(evaluation_text(progress(0, 10, 0), 80, false), "left"));
  EXPECT_FALSE(contains(evaluation_text(progress(10, 10, 0), 80, false), "left"));
  EXPECT_TRUE(contains(evaluation_text(progress(9, 10, 0.2), 80, false), "1 s left"));
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
  EXPECT_TRUE(contains(evaluation_text(progress(5, 10, 62), 80, true),
                       "[\033[32m###############\033[0m...............]"));
}

}  // namespace
}  // namespace slalom::tools
