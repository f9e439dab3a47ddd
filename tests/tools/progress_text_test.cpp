// Progress lines never promise a time that is over.
#include "tools/terminal/progress.hpp"

#include <gtest/gtest.h>

namespace slalom::tools {
namespace {

TEST(ProgressText, NoTimeIsLeftThatIsNotKnownOrOver) {
  const auto text = [](int done, double left) {
    return evaluation_text({.laps_done = done, .laps_total = 10, .seconds_left = left});
  };
  EXPECT_EQ(text(0, 0), "0 of 10 laps");
  EXPECT_EQ(text(5, 62), "5 of 10 laps, 1 min 02 s left");
  EXPECT_EQ(text(9, 0.2), "9 of 10 laps, 1 s left");
  EXPECT_EQ(text(10, 0), "10 of 10 laps");
}

}  // namespace
}  // namespace slalom::tools
