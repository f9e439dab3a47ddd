// The introduction: two controllers before a parked car, in slow motion until both have passed it.
#include <gtest/gtest.h>

#include <cmath>

#include "view/protocol/frame_reader.hpp"
#include "view/session_fixture.hpp"

namespace slalom::view {
namespace {

SessionOptions introduction() {
  SessionOptions options = session_options();
  options.scenario = {
      .course = "stag", .method = "svg_mppi", .config = "default", .seed = 77, .obstacles = 1};
  options.against = "mppi";
  options.introduction = true;
  return options;
}

class Introduction : public ViewSession {
 protected:
  Introduction() : ViewSession(introduction()) {}
};

/// The frame of the ghost within a frame.
std::string_view ghost_of(const std::string& frame) {
  return FrameReader(frame).block(Block::ghost_frame);
}

/// Returns the distance by which the parked car lies ahead of the car of a frame, m.
double parked_ahead(std::string_view frame) {
  PayloadReader bodies(FrameReader(frame).block(Block::bodies));
  bodies.take(4 + 4);  // the count, and the number and kind of the car
  const double x = bodies.f32(), y = bodies.f32(), yaw = bodies.f32();
  bodies.take(2 * sizeof(float) + 4);
  const double dx = bodies.f32() - x;
  return std::cos(yaw) * dx + std::sin(yaw) * (bodies.f32() - y);
}

TEST_F(Introduction, FramesHoldWhatBothControllersConsider) {
  const std::string both = step_to(3);
  const std::string_view ghost = ghost_of(both);
  ASSERT_FALSE(ghost.empty());
  EXPECT_EQ(scalar(both, "method"), 0);
  EXPECT_EQ(scalar(ghost, "method"), 1);
  EXPECT_EQ(scalar(ghost, "tick"), 3) << "of the same control step";
  const FrameReader reader(ghost);
  for (const Block block : {Block::scan, Block::candidates, Block::nominal, Block::plan, Block::bodies})
    EXPECT_FALSE(reader.block(block).empty()) << static_cast<int>(block);
  // The car, then the parked car; both worlds have the same.
  EXPECT_EQ(PayloadReader(reader.block(Block::bodies)).get<std::uint32_t>(), 2u);
  EXPECT_EQ(reader.block(Block::bodies).substr(4 + 24),
            FrameReader(both).block(Block::bodies).substr(4 + 24));
  tell({{"do", "ghost"}, {"method", ""}});
  EXPECT_TRUE(ghost_of(step_to(4)).empty());
}

TEST_F(Introduction, AnObstacleThatIsMovedWhilePausedMovesInBothWorlds) {
  step_to(3);
  tell({{"do", "add"}, {"kind", "disc"}, {"x", 0}, {"y", 50}});
  const std::string both = frame(3);
  EXPECT_EQ(PayloadReader(FrameReader(both).block(Block::bodies)).get<std::uint32_t>(), 3u);
  EXPECT_EQ(PayloadReader(FrameReader(ghost_of(both)).block(Block::bodies)).get<std::uint32_t>(), 3u);
}

TEST_F(Introduction, SlowsDownUntilBothCarsHavePassed) {
  json state = last_state_ticks();
  EXPECT_EQ(state["introduction"], true);
  EXPECT_EQ(state["rate"], 0.5) << "nothing is near";
  std::vector<double> rates{0.5};
  bool has_passed = false;
  for (int tick = 4; tick < 160 && rates.back() != 1; tick += 4) {
    const std::string both = step_to(tick);
    state = last_state_ticks();
    if (state["rate"] != rates.back()) rates.push_back(state["rate"]);
    has_passed = parked_ahead(both) < 0 && parked_ahead(ghost_of(both)) < 0;
  }
  EXPECT_EQ(rates, (std::vector<double>{0.5, 0.1, 1}));
  EXPECT_TRUE(has_passed);
  tell({{"do", "restart"}});
  EXPECT_EQ(last_state_ticks()["rate"], 0.5) << "it is shown again";
}

TEST_F(Introduction, EndsWithAnotherScenarioOrRate) {
  tell({{"do", "rate"}, {"rate", 2}});
  json state = last_state_ticks();
  EXPECT_EQ(state["introduction"], false);
  EXPECT_EQ(state["rate"], 2);
  step_to(30);
  EXPECT_EQ(last_state_ticks()["rate"], 2);
}

TEST_F(Introduction, AnotherMethodDrivesInRealTime) {
  tell({{"do", "method"}, {"method", "mppi"}});
  const json state = last_state_ticks();
  EXPECT_EQ(state["introduction"], false);
  EXPECT_EQ(state["rate"], 1);
}

}  // namespace
}  // namespace slalom::view
