// Planner and localiser of the ROS nodes: every fault stops the car with a reason, then it drives on.
// The planner of the ROS nodes takes every input: goal speed, other cars, points, covariance, what is obeyed.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <thread>

#include "simulated_drive.hpp"
#include "view/protocol/frame_reader.hpp"
#include "view/web_client.hpp"

namespace slalom::nodes::testing {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// Moves the odometry and its transform along x, m.
void move(Messages& m, double way) {
  m.odometry[0].pose.x += way;
  m.transforms[0].pose.x += way;
}
/// A change of the messages of each period that needs no drive.
template <class Change>
auto each(Change change) {
  return [change](Drive&, Messages& m) mutable { change(m); };
}
auto shift_scan(double time) {
  return each([=](Messages& m) { m.scans[0].stamp += stamp_of(time); });
}
auto shift_odometry(double time) {
  return each([=](Messages& m) { m.odometry[0].stamp += stamp_of(time); });
}
Fault clock_jumps(const char* name, double time) {
  return {.name = name, .reason = "clock", .begin = [=](Drive& d) { d.jump(time); }, .lasts = false};
}

std::vector<Fault> faults() {
  return {
      {"scan silent", "no scan", each([](Messages& m) { m.scans.clear(); })},
      {"scan of NaN", "", each([](Messages& m) {
         for (float& range : m.scans[0].ranges) range = std::numeric_limits<float>::quiet_NaN();
       })},
      {"scan of a wrong count", "number",
       each([](Messages& m) { m.scans[0].ranges.resize(m.scans[0].ranges.size() / 2); })},
      {"scan from the future", "future", shift_scan(5)},
      {"scan late", "late", shift_scan(-0.5)},
      {"scans out of order", "out of order", each([held = std::vector<Scan>()](Messages& m) mutable {
         if (held.empty()) return held.swap(m.scans);
         m.scans.push_back(held[0]);
         held.clear();
       })},
      {"odometry silent", "no odometry", each([](Messages& m) {
         m.odometry.clear();
         m.transforms.clear();
       })},
      {"odometry of NaN", "finite", each([](Messages& m) {
         move(m, unknown);
         m.odometry[0].speed = unknown;
       })},
      {"odometry late", "late", shift_odometry(-0.5)},
      {"odometry from the future", "future", shift_odometry(5)},
      {"odometry jumps", "jump", each([](Messages& m) {
         move(m, 3 * std::fmod(std::floor(in_seconds(m.odometry[0].stamp) / 0.2), 2));
       })},
      {"odometry of a place that no car reaches", "", each([](Messages& m) { move(m, 1e9); })},
      {"odometry of a speed that no car has", "", each([](Messages& m) { m.odometry[0].speed = 4132; })},
      {"tf missing", "tf", each([](Messages& m) { m.transforms.clear(); })},
      {"tf extrapolates", "extrapolation", each([](Messages& m) { m.transforms[0].stamp -= stamp_of(1); })},
      {"tf of NaN", "tf", each([](Messages& m) { m.transforms[0].pose.x = unknown; })},
      {"two planners", "another node commands",
       [](Drive& d, Messages&) { d.planner().hear_other_command("another"); }},
      {.name = "a map that does not match",
       .reason = "localisation",
       .begin = [](Drive& d) { d.hear_map(1.6); },
       .end = [](Drive& d) { d.hear_map(1); },
       .within = 5},  // until the localiser sees that the map does not fit
      {.name = "localiser dies",
       .reason = "tf",
       .begin = [](Drive& d) { d.end_localiser(); },
       .end = [](Drive& d) { d.start_localiser(); }},
      {"world dies", "no scan", each([](Messages& m) { m = {}; })},
      clock_jumps("clock jumps ahead", 20),
      clock_jumps("clock jumps back", -20),
  };
}

class NodeFault : public ::testing::TestWithParam<Fault> {};

TEST_P(NodeFault, StopsTheCarWithAReasonAndThenItDrivesOn) {
  const Fault& fault = GetParam();
  Drive drive;
  ASSERT_TRUE(drive.run_until(30, [&] { return drive.drives(); })) << drive.log();
  drive.run(1.5);  // longer than a fault is remembered as the cause of others
  ASSERT_TRUE(drive.drives()) << drive.log();
  const double begin = drive.time();
  drive.begin(fault);
  if (fault.lasts) {
    EXPECT_TRUE(drive.run_until(fault.within, [&] { return drive.stops(); })) << drive.log();
    EXPECT_TRUE(drive.run_until(5, [&] { return drive.car_stands(); })) << drive.log();
    drive.run(1.5);
    EXPECT_TRUE(drive.stops()) << "must stay stopped\n" << drive.log();
  } else {
    EXPECT_TRUE(drive.run_until(fault.within, [&] { return drive.has_stopped_since(begin); })) << drive.log();
  }
  EXPECT_TRUE(drive.run_until(2, [&] { return drive.has_said(fault.reason, begin); })) << drive.log();
  drive.end();
  EXPECT_TRUE(drive.run_until(30, [&] { return drive.drives(); })) << drive.log();
  EXPECT_EQ(drive.mistake(), "") << drive.log();
}

INSTANTIATE_TEST_SUITE_P(Each, NodeFault, ::testing::ValuesIn(faults()), [](const auto& fault) {
  std::string name = fault.param.name;
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
});

class NodeDrive : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(drive_.run_until(30, [&] { return drive_.drives(); })) << drive_.log();
  }

  PlannerCore& planner() { return drive_.planner(); }

  Drive drive_;
};

TEST_F(NodeDrive, NothingIsAllocatedFromAScanToItsCommand) {
  drive_.run(2);
  drive_.allocations();
  drive_.run(2);
  ASSERT_TRUE(drive_.drives()) << drive_.log();
  EXPECT_EQ(drive_.allocations(), 0);
}

TEST_F(NodeDrive, EndsAfterTheNumberOfLaps) {
  EXPECT_THROW(planner().drive_laps(-1), std::exception);
  planner().drive_laps(1);
  const double begin = drive_.time();
  EXPECT_TRUE(drive_.run_until(60, [&] { return drive_.has_said("all laps are driven", begin); }))
      << drive_.log();
  EXPECT_GT(drive_.time() - begin, 5) << "a lap takes longer";
  EXPECT_EQ(planner().laps(), 1);
  EXPECT_TRUE(drive_.run_until(5, [&] { return drive_.car_stands(); }));
  planner().drive_laps(0);
  EXPECT_TRUE(drive_.run_until(10, [&] { return drive_.drives(); })) << drive_.log();
}

/// The car stops metres from the place that was kept, and parked cars hide walls there.
TEST_F(NodeDrive, ALocaliserThatIsRestartedContinuesWhereverTheCarStops) {
  for (int k = 0; k < 4; ++k) {
    drive_.run(1.1 + 0.14 * k);
    drive_.end_localiser();
    ASSERT_TRUE(drive_.run_until(5, [&] { return drive_.car_stands(); })) << drive_.log();
    drive_.start_localiser();
    ASSERT_TRUE(drive_.run_until(3, [&] { return drive_.drives(); })) << k << ": " << drive_.log();
  }
}

TEST_F(NodeDrive, AGoalSpeedOfZeroStopsTheCarAndALowOneSlowsIt) {
  planner().hear_goal_speed(0);
  EXPECT_TRUE(drive_.run_until(5, [&] { return drive_.car_stands(); }));
  EXPECT_TRUE(drive_.has_said("goal speed is 0", 0)) << drive_.log();
  planner().hear_goal_speed(0.8);
  EXPECT_TRUE(drive_.run_until(10, [&] { return drive_.drives(); })) << drive_.log();
  drive_.run(2);
  EXPECT_LE(drive_.speed(), 0.9);
}

TEST_F(NodeDrive, ReportsPlansAndLatency) {
  planner().report();
  drive_.run(1);
  const Report report = planner().report();
  EXPECT_EQ(report.about, "plans");
  EXPECT_EQ(report.message, "driving");
  const auto value = [&](const std::string& key) {
    for (const auto& [name, text] : report.values)
      if (name == key) return std::stod(text);
    ADD_FAILURE() << "there is no " << key;
    return 0.0;
  };
  EXPECT_NEAR(value("plans"), 40, 2);
  EXPECT_EQ(value("stops"), 0);
  EXPECT_GE(value("latency from scan to command, p99, ms"), value("latency from scan to command, p50, ms"));
  EXPECT_LT(value("latency from scan to command, p99, ms"), 25) << "of the simulated clock";
}

TEST_F(NodeDrive, AnImuThatTfDoesNotKnowIsReportedOnce) {
  const double begin = drive_.time();
  for (int i = 0; i < 100; ++i) {
    planner().hear_imu({"unknown", {0, 0, 0}, {0, 0, 0}});
    drive_.run(0.025);
  }
  EXPECT_EQ(drive_.count_said("imu is not used", begin), 1) << drive_.log();
  EXPECT_TRUE(drive_.drives()) << drive_.log();
}

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
