// Memory that long drives hold: a minute on the page of the live view with a ghost, a race of four cars, and
// drives that are recorded. docs/robustness.md has the bounds.
#include <sys/resource.h>

#include "tools/program_test.hpp"
#include "view/car/car_subject.hpp"
#include "view/paused_session.hpp"

namespace slalom::tools {
namespace {

/// The most that this process, or one of its children that have ended, has held, MiB.
double most_held(int who) {
  rusage usage{};
  getrusage(who, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;
}

class Memory : public testing::ProgramTest {};

// The first: a child begins with the memory of this process.
TEST_F(Memory, OfRacesAndOfDrivesThatAreRecordedIsBounded) {
  succeed("race --course wren --config default --cars 4 --laps 2 --races 4 --jobs 2");
  succeed("drive --course wren --laps 4 --record-all --record laps.mcap");
  EXPECT_LT(most_held(RUSAGE_CHILDREN), 160);
}

TEST_F(Memory, OfAMinuteOnThePageIsBounded) {
  view::SessionOptions options{.choices = {.methods = {"svg_mppi", "mppi"}}};
  const auto fox =
      evaluation::load_environment(SLALOM_COURSES "/fox", evaluation::Protocol::true_physics, {});
  const auto configuration = vehicle::load_configuration(SLALOM_CONFIGS "/default.yaml");
  view::PausedSession page(view::car_subject({fox, {configuration, "svg_mppi"}, {}}, 1), options);
  page.tell({{"do", "ghost"}, {"method", "mppi"}});
  for (int second = 0; second < 60; ++second) page.step(40);
  EXPECT_GE(page.last("state")["tick"], 2400);
  EXPECT_LT(most_held(RUSAGE_SELF), 320);
}

}  // namespace
}  // namespace slalom::tools
