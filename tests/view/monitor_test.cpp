// The page of a controller that runs in the program of a user.
#include "slalom/view/monitor.hpp"

#include <gtest/gtest.h>

#include "slalom/problems/differential_drive.hpp"
#include "slalom/solvers/controllers.hpp"
#include "support/allocations.hpp"
#include "view/paused_session.hpp"

namespace slalom::view {
namespace {

using problems::DifferentialDrive;
using State = DifferentialDrive::State<double>;

Drawing<DifferentialDrive> drawing() {
  return {.x = &State::x,
          .y = &State::y,
          .heading = &State::yaw,
          .length = 0.5,
          .width = 0.4,
          .shapes = [](const DifferentialDrive& p) {
            if (p.goal_x < 0) throw std::runtime_error("there is no goal");
            return std::vector{disc(p.goal_x, p.goal_y, 0.2, ShapeKind::goal)};
          }};
}

/// A loop that drives, and a page that watches it.
class Watched : public ::testing::Test {
 protected:
  /// Plans and drives a step after the page can take the next one.
  void step() {
    std::this_thread::sleep_for(std::chrono::milliseconds(15));
    const auto plan = controller_.solve(x_, {.elapsed = steps_++ > 0 ? 0.1 : 0});
    monitor_.show(controller_, plan);
    cost_ = plan.stats.minimum_cost;
    samples_ = plan.stats.samples->samples();  // of the last batch
    x_ = controller_.problem().step(x_, plan.inputs[0]);
  }
  void open() {
    client_.emplace(std::uint16_t(std::stoi(monitor_.address().substr(monitor_.address().rfind(':') + 1))));
    client_->get("/ws", true);
    hello_ = text("hello");
  }
  /// The next message of a type.
  json text(const std::string& type) {
    for (;;) {
      const std::string message = client_->next_message();
      if (message.empty()) return {};
      if (message.starts_with("SLV1")) continue;
      json parsed = json::parse(message);
      if (parsed["type"] == type) return parsed;
    }
  }
  /// The next frame.
  std::string frame() {
    for (;;)
      if (std::string message = client_->next_message(); message.empty() || message.starts_with("SLV1"))
        return message;
  }
  double scalar(const std::string& frame, const std::string& name) {
    const std::vector<std::string> names = hello_["scalars"];
    double value;
    std::memcpy(
        &value,
        &FrameReader(frame).block(
            Block::scalars)[8 * static_cast<std::size_t>(std::ranges::find(names, name) - names.begin())],
        sizeof value);
    return value;
  }
  std::string refusal(const json& command) {
    client_->send_message(command.dump());
    return text("error")["message"];
  }

  SvgMppi<DifferentialDrive> controller_{
      DifferentialDrive{}, {.horizon = 25, .samples = 256, .input_min = {0, -2}, .input_max = {1.5, 2}}};
  Monitor<DifferentialDrive> monitor_{controller_, drawing(), {.port = 0}};
  State x_{};
  int steps_ = 0, samples_ = 0;
  double cost_ = 0;
  std::optional<testing::WebClient> client_;
  json hello_;
};

TEST_F(Watched, ShowsWhatTheControllerPlannedWithItsSamples) {
  for (int i = 0; i < 3; ++i) step();
  EXPECT_EQ(monitor_.dropped(), 0u) << "nobody looks";
  open();
  EXPECT_EQ(hello_["can"], json({"watch"}));
  EXPECT_EQ(hello_["methods"], json({"svg_mppi"}));
  const State before = x_;
  step();
  std::string shown = frame();
  EXPECT_EQ(scalar(shown, "tick"), 0);
  EXPECT_EQ(scalar(shown, "x"), before.x);
  EXPECT_EQ(scalar(shown, "minimum_cost"), cost_);
  EXPECT_EQ(scalar(shown, "samples"), samples_);
  PayloadReader candidates(FrameReader(shown).block(Block::candidates));
  EXPECT_EQ(candidates.get<std::uint16_t>(), std::min(samples_, 160));
  controller_.problem().goal_x = 4;  // the scene is that of the plan
  step();
  shown = frame();
  PayloadReader bodies(FrameReader(shown).block(Block::bodies));
  bodies.take(4 + 24 + 4);
  EXPECT_EQ(bodies.f32(), 4);
}

TEST_F(Watched, GoesBackInThePastAndChangesNothing) {
  open();
  for (int i = 0; i < 5; ++i) step(), frame();
  client_->send_message(R"({"do": "seek", "tick": 1})");
  EXPECT_EQ(scalar(frame(), "tick"), 1);
  for (int i = 0; i < 2; ++i) step();
  client_->send_message(R"({"do": "step", "ticks": 2})");
  EXPECT_EQ(scalar(frame(), "tick"), 3) << "the page is paused";
  client_->send_message(R"({"do": "play"})");
  EXPECT_EQ(scalar(frame(), "tick"), 6);
  for (const char* what : {"restart", "set", "place_car", "fork", "scenario", "save"})
    EXPECT_EQ(refusal({{"do", what}}),
              "this page shows a controller that runs elsewhere; it cannot change it");
}

TEST_F(Watched, AFailureOfTheDrawingIsToldOnThePage) {
  open();
  controller_.problem().goal_x = -1;
  step();
  EXPECT_EQ(text("error")["message"], "there is no goal");
  controller_.problem().goal_x = 8;
  step();
  EXPECT_EQ(scalar(frame(), "tick"), 0);
}

TEST_F(Watched, CountsPlansThatComeTooSoon) {
  open();
  for (int i = 0; i < 50; ++i) monitor_.show(controller_, controller_.solve(x_, {}));
  EXPECT_GT(monitor_.dropped(), 0u);
}

TEST(Monitor, DoesNotAllocateAfterTheFirstPlan) {
  SvgMppi controller{DifferentialDrive{},
                     {.horizon = 25, .samples = 256, .input_min = {0, -2}, .input_max = {1.5, 2}}};
  detail::WatchedController<DifferentialDrive> source(controller, drawing());
  State x{};
  for (int i = 0; i < 20; ++i) {
    const auto plan = controller.solve(x, {.elapsed = i > 0 ? 0.1 : 0});
    const long before = testing::allocations();
    source.give(controller, plan, i);
    EXPECT_TRUE(i == 0 || testing::allocations() == before) << i;
    EXPECT_TRUE(i % 3 != 0 || source.take()->time == i);
    x = controller.problem().step(x, plan.inputs[0]);
  }
}

TEST(Monitor, RejectsWhatItCannotServe) {
  SvgMppi controller{DifferentialDrive{}, {.horizon = 5}};
  EXPECT_THROW(Monitor(controller, {}), std::invalid_argument) << "neither x and y nor pose";
  EXPECT_THROW(Monitor(controller, drawing(), {.port = 0, .against = "mppi"}), std::invalid_argument);
  EXPECT_THROW(Monitor(controller, drawing(), {.host = "0.0.0.0", .port = 0}), std::invalid_argument);
}

TEST(Handover, GivesTheNewestValueOnceAndTellsWhatItReplaces) {
  Handover<int> to;
  EXPECT_EQ(to.take(), nullptr);
  const auto give = [&](int value) { return to.give([=](int& slot) { slot = value; }); };
  EXPECT_FALSE(give(1));
  EXPECT_TRUE(give(2));
  EXPECT_EQ(*to.take(), 2);
  EXPECT_EQ(to.take(), nullptr);
  std::atomic<bool> ends = false;
  std::thread writer([&] {
    for (int i = 3; !ends; ++i) give(i);
  });
  for (int last = 2; last < 100000;)
    if (const int* value = to.take()) {
      ASSERT_GT(*value, last);
      last = *value;
    }
  ends = true;
  writer.join();
}

}  // namespace
}  // namespace slalom::view
