// A navigator in its room on the page: ghost and undo.

#include "tools/live_view/subjects.hpp"
#include "view/paused_session.hpp"

namespace slalom::tools {
namespace {

class RoomSession : public ::testing::Test, protected view::PausedSession {
 protected:
  RoomSession() : PausedSession(room_subject("pallet-on-path", "svg_mppi", 1)) {}
};

TEST_F(RoomSession, AGhostNavigatesInARoomOfItsOwn) {
  step_to(4);
  say({R"({"do": "ghost", "method": "mppi"})"});
  EXPECT_EQ(ghost_figure("x", 4), figure("x", 4));
  step_to(20);
  const double x = figure("x", 20), ghost = ghost_figure("x", 20);
  EXPECT_GT(ghost, ghost_figure("x", 4) + 0.1) << "it moves";
  EXPECT_NE(ghost, x);
  say({R"({"do": "seek", "tick": 10})"});
  step_to(20);
  EXPECT_EQ(figure("x", 20), x);
  EXPECT_EQ(ghost_figure("x", 20), ghost) << "both are driven again exactly";
}

TEST_F(RoomSession, UndoPutsThePalletBackAndTheMethod) {
  step_to(4);
  const auto bodies = [&] {
    const std::string shown = frame(4);
    return std::string(view::FrameReader(shown).block(view::Block::bodies));
  };
  const std::string before = bodies();
  say({R"({"do": "move", "body": 1, "x": 0, "y": 99})"});
  EXPECT_NE(bodies(), before);
  say({R"({"do": "method", "method": "mppi"})"});
  EXPECT_EQ(last("state")["method"], "mppi");
  say({R"({"do": "undo"})", R"({"do": "undo"})"});
  EXPECT_EQ(last("state")["method"], "svg_mppi");
  EXPECT_EQ(last("options")["undo"], 0);
  EXPECT_EQ(last("options")["redo"], 2);
  EXPECT_EQ(bodies(), before);
}

}  // namespace
}  // namespace slalom::tools
