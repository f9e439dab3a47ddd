#include <gtest/gtest.h>

#include <map>

#include "sim/golden_table.hpp"
#include "sim/gym_world.hpp"
#include "slalom/sim/time_to_collision.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::sim {
namespace {

using slalom::testing::compare_rows;
using slalom::testing::Comparison;
using slalom::testing::GoldenRow;
using slalom::testing::GoldenTable;

TEST(GymWorld, BeamGeometry) {
  const Lidar lidar(testing::gym_lidar());
  const TimeToCollision geometry(testing::gym_lidar(), {});
  compare_rows("beam_geometry", 1e-9, [&](const GoldenRow& row, Comparison& compared) {
    const auto beam = static_cast<std::size_t>(row.integer("beam"));
    compared.absolute(row, {{"scan_angle", lidar.angles()[beam]},
                            {"cosine", geometry.cosines()[beam]},
                            {"side_distance", geometry.sides()[beam]}});
  });
}

TEST(GymWorld, TimeToCollision) {
  const TimeToCollision test(testing::gym_lidar(), {});
  compare_rows("ttc", 0, [&](const GoldenRow& row, Comparison& compared) {
    const auto ranges = row.series("r");
    const int hit = test.first_hit(std::span<const double>(ranges), row.real("vel"));
    EXPECT_EQ(hit >= 0, row.integer("in_collision") == 1) << "case " << row.text("case");
    compared.absolute(row, {{"first_hit_beam", hit}});
  });
}

/// Drives the cases of a recorded run again and compares states and scans.
class TraceRun {
 public:
  TraceRun(const GoldenTable& trace, const GoldenTable& scans, std::shared_ptr<const Track> track)
      : trace_(trace), scans_(scans), track_(std::move(track)) {
    for (std::size_t row = 0; row < scans.rows(); ++row)
      scan_rows_[{scans.integer(row, "case"), scans.integer(row, "k"), scans.integer(row, "agent")}] = row;
  }

  void run(std::size_t begin, std::size_t end, Comparison& states, Comparison& ranges) {
    std::vector<maps::Pose> starts;
    std::size_t row = begin;
    for (; row < end && trace_.integer(row, "k") == 0; ++row)
      starts.push_back({trace_.real(row, "x"), trace_.real(row, "y"), trace_.real(row, "psi")});
    WorldOptions options = WorldOptions::gym_compatible();
    options.lidar.noise = 0;
    // The file does not name it; f1tenth_gym's default but for the one case that was run with Euler.
    if (trace_.integer(begin, "case") == 7) options.plant.dynamics.integrator = Integrator::euler;
    World world(options, track_);
    world.reset(0, starts);
    for (std::size_t agent = 0; agent < starts.size(); ++agent)
      compare(world, agent, begin + agent, states, ranges);
    std::vector<Command> commands(starts.size());
    while (row < end) {
      for (std::size_t agent = 0; agent < starts.size(); ++agent)
        commands[agent] = {trace_.real(row + agent, "steer_cmd"), trace_.real(row + agent, "speed_cmd")};
      world.step(commands);
      for (std::size_t agent = 0; agent < starts.size(); ++agent, ++row)
        compare(world, agent, row, states, ranges);
      if (::testing::Test::HasFailure()) return;
    }
  }

 private:
  void compare(const World& world, std::size_t agent, std::size_t row, Comparison& states,
               Comparison& ranges) {
    const auto where = [&] { return "case " + trace_.text(row, "case") + " k " + trace_.text(row, "k"); };
    const CarState& s = world.state(agent);
    states.absolute({trace_, row}, {{"x", s.x},
                                    {"y", s.y},
                                    {"delta", s.steer},
                                    {"v", s.speed},
                                    {"psi", s.yaw},
                                    {"psidot", s.yaw_rate},
                                    {"beta", s.slip},
                                    {"lap_time", world.start_zone_laps(agent).time()}});
    EXPECT_LE(states.worst(), 1e-8) << where();
    EXPECT_EQ(world.flags()[agent], trace_.integer(row, "collision")) << where();
    EXPECT_EQ(world.observe(agent).wall, trace_.integer(row, "wall_collision") == 1) << where();
    EXPECT_EQ(world.last_partner(agent), trace_.integer(row, "collision_idx")) << where();
    EXPECT_EQ(world.start_zone_laps(agent).toggles(), trace_.integer(row, "toggles")) << where();
    EXPECT_EQ(world.start_zone_laps(agent).laps(), trace_.integer(row, "lap_count")) << where();
    bool all_finished = true;
    for (std::size_t i = 0; i < world.cars(); ++i)
      all_finished = all_finished && world.start_zone_laps(i).finished();
    EXPECT_EQ(world.flags()[0] || all_finished, trace_.integer(row, "done") == 1) << where();
    const auto scan =
        scan_rows_.find({trace_.integer(row, "case"), trace_.integer(row, "k"), static_cast<int>(agent)});
    if (scan == scan_rows_.end()) return;
    ranges.next_case();
    ranges.absolute(world.observe(agent).gym_ranges, scans_.series(scan->second, "r"));
    EXPECT_LE(ranges.worst(), 1e-8) << where();
  }

  const GoldenTable& trace_;
  const GoldenTable& scans_;
  std::shared_ptr<const Track> track_;
  std::map<std::tuple<int, int, int>, std::size_t> scan_rows_;
};

TEST(GymWorld, EnvironmentTraces) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable trace(folder / "sim_trace.csv"), scans(folder / "sim_trace_scans.csv");
  TraceRun run(trace, scans, std::make_shared<const Track>(testing::gym_track(folder, "berlin")));
  Comparison states("sim_trace"), ranges("sim_trace_scans");
  for (std::size_t begin = 0, end; begin < trace.rows(); begin = end) {
    end = begin;
    while (end < trace.rows() && trace.text(end, "case") == trace.text(begin, "case")) ++end;
    states.next_case();
    run.run(begin, end, states, ranges);
  }
  EXPECT_GT(states.cases(), 0);
}

}  // namespace
}  // namespace slalom::sim
