// The planner of the ROS nodes takes every input: goal speed, other cars, points, covariance, what is obeyed.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <thread>

#include "simulated_drive.hpp"
#include "view/protocol/frame_reader.hpp"
#include "view/web_client.hpp"

namespace slalom::nodes::testing {
namespace {

/// Drives among no parked cars for so long (s) with something told in each step.
struct Told : Drive {
  Told(double duration, const std::function<void(Told&, PlannerCore&)>& tell, DriveSetup setup = {})
      : Drive((setup.parked = 0, setup)) {
    for (const double begin = time(); time() < begin + duration; run(SimulatedCar::period))
      tell(*this, planner());
  }
  Stamp now() const { return stamp_of(time()); }
  std::string value(const std::string& key) {
    for (const auto& [name, text] : planner().report().values)
      if (name == key) return text;
    return "";
  }
};

bool same(const std::vector<Command>& a, const std::vector<Command>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](auto& x, auto& y) { return x.steer == y.steer && x.speed == y.speed; });
}

TEST(NodeInputs, SpeedMessagesAt50HertzChangeNothingThatWasLearned) {
  const Told once(6, [](Told& d, auto& to) {
    if (d.commands().empty()) to.hear_goal_speed(1.5);
  });
  const Told often(6, [](Told&, auto& to) {
    to.hear_goal_speed(1.5);
    to.hear_goal_speed(1.5);
  });
  EXPECT_TRUE(once.drives()) << once.log();
  EXPECT_TRUE(same(once.commands(), often.commands()));
  EXPECT_LT(once.speed(), 1.6);
  const Told never(6, [](Told&, auto&) {});
  EXPECT_GT(never.speed(), 1.8);
}

TEST(NodeInputs, TheCarOvertakesASlowerOneOfWhichItHasTheScanAlone) {
  const auto overtaken = [](const char* others) {  // without a collision
    int count = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      Drive drive({.course = "hare", .others = others, .seed = seed, .parked = 0, .other_speed = 0.6});
      count += drive.run_until(40, [&] { return drive.other_ahead() < -1; }) && drive.car().collisions() == 0;
    }
    return count;
  };
  EXPECT_GE(overtaken("scan"), 9);
  EXPECT_LE(overtaken("none"), 6) << "the test would not show anything";
}

TEST(NodeInputs, AreUsedWhenTheyAreFreshAndNotAfterwards) {
  const Told plain(3, [](Told&, auto&) {});
  const vehicle::PoseCovariance uncertain{{{0.01, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}}};
  const auto covariance = [&](double age) {
    return Told(3, [&, age](Told& d, auto& to) { to.hear_covariance(d.now() - stamp_of(age), uncertain); });
  };
  EXPECT_FALSE(same(plain.commands(), covariance(0.01).commands()));
  EXPECT_TRUE(same(plain.commands(), covariance(0.5).commands()));

  Told own(3, [](Told& d, auto& to) {
    if (!d.commands().empty()) to.hear_executed(d.commands().back());
  });
  EXPECT_TRUE(same(plain.commands(), own.commands())) << "the car executes what it is sent";
  EXPECT_EQ(own.value("commands"), "");
  Told remote(3, [](Told&, auto& to) { to.hear_executed({-0.2, 1}); });
  EXPECT_FALSE(same(plain.commands(), remote.commands()));
  EXPECT_EQ(remote.value("commands"), "of somebody else");
}

TEST(NodeInputs, PointsOfAnotherSensorStopTheCarAndSoDoesTheirAbsence) {
  std::optional<maps::Pose> wall;  // which no scan shows
  Told drive(8, [&](Told& d, auto& to) {
    if (!wall && d.drives()) wall = moved_ahead(d.car().pose(), 4);
    if (!wall) return;
    std::vector<std::array<double, 3>> points;
    for (int i = -100; i < 100; ++i) {
      const maps::Pose laser = composed(d.car().pose(), d.car().laser());
      const maps::Point at = maps::inverse_transform(laser, maps::transform(*wall, {0, 0.03 * i}));
      points.push_back({at.x, at.y, 0});
    }
    to.hear_points(d.now(), "laser", points);
  });
  ASSERT_TRUE(wall);
  const double left = -maps::inverse_transform(*wall, {drive.car().pose().x, drive.car().pose().y}).x;
  EXPECT_GT(left, 0.4);
  EXPECT_LT(left, 2.5);
  EXPECT_EQ(drive.value("obstacle points"), "200");
  drive.run(2);
  EXPECT_TRUE(drive.has_said("no obstacle points", 0)) << drive.log();
  EXPECT_TRUE(drive.car_stands());
}

TEST(NodeInputs, ObjectsThatAnotherNodeTracksAreNeededAndAvoided) {
  const DriveSetup topic{.others = "topic"};
  Told silent(
      3, [](Told&, auto&) {}, topic);
  EXPECT_TRUE(silent.has_said("no tracked objects", 0)) << silent.log();
  const auto driven = [&](double ahead, double speed) {
    return Told(
        4,
        [=](Told& d, auto& to) {
          tracking::TrackedObject object{.id = 1,
                                         .pose = moved_ahead(d.car().pose(), ahead),
                                         .speed = speed,
                                         .length = 0.5,
                                         .width = 0.3};
          for (int i = 0; i < 5; ++i) object.covariance[i][i] = 1e-4;
          to.hear_objects(d.now(), {&object, 1});
        },
        topic);
  };
  Told far = driven(50, 1), close = driven(1.5, 0.6);
  EXPECT_TRUE(far.drives()) << far.log();
  EXPECT_EQ(close.value("other cars"), "1");
  EXPECT_LT(close.speed(), far.speed() - 0.3);
  EXPECT_THROW(Drive({.others = "radar"}), std::exception);
}

TEST(NodeInputs, AViewPortShowsThePlansOnAPageAndChangesNone) {
  const Told plain(3, [](Told&, auto&) {});
  std::optional<slalom::testing::WebClient> page;
  std::vector<std::string> frames;
  Told shown(3,
             [&](Told& d, auto&) {
               const std::string said = d.log(), words = "the live view is at http://127.0.0.1:";
               if (const auto at = said.find(words); !page && at != std::string::npos) {
                 page.emplace(static_cast<std::uint16_t>(std::stoi(said.substr(at + words.size()))));
                 page->get("/ws", true);
               }
               if (page) std::this_thread::sleep_for(std::chrono::milliseconds(15));
             },
             {.view_port = 8440});
  ASSERT_TRUE(page) << shown.log();
  EXPECT_TRUE(same(plain.commands(), shown.commands()));
  nlohmann::json hello;
  while (frames.size() < 10) {
    std::string message = page->next_message();
    ASSERT_FALSE(message.empty());
    if (message.starts_with("SLV1") && !view::FrameReader(message).block(view::Block::plan).empty())
      frames.push_back(message);
    if (!message.starts_with("SLV1") && hello.is_null()) hello = nlohmann::json::parse(message);
  }
  EXPECT_EQ(hello["lidar"]["range_max"], shown.car().scan().range_max);
  const view::FrameReader frame(frames.back());
  for (const view::Block part : {view::Block::scan, view::Block::candidates, view::Block::plan})
    EXPECT_FALSE(frame.block(part).empty()) << static_cast<int>(part);
  view::PayloadReader scalars(frame.block(view::Block::scalars));
  scalars.take(2 * sizeof(double));
  const double x = scalars.get<double>(), y = scalars.get<double>();
  EXPECT_LT(std::hypot(x - shown.car().pose().x, y - shown.car().pose().y), 6);
}

}  // namespace
}  // namespace slalom::nodes::testing
