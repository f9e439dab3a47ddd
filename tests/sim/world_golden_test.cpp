
#include <map>

#include "sim/golden_table.hpp"
#include "sim/gym_world.hpp"
#include "slalom/sim/gym.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::sim {
namespace {

using namespace slalom::testing;

TEST(GymWorld, BeamGeometry) {
  const Lidar lidar(gym_lidar());
  const TimeToCollision geometry(gym_lidar(), {});
  compare_rows("beam_geometry", 1e-9, [&](const GoldenRow& row, Comparison& compared) {
    const auto beam = static_cast<std::size_t>(row.integer("beam"));
    compared.absolute(row, {{"scan_angle", lidar.angles()[beam]},
                            {"cosine", geometry.cosines()[beam]},
                            {"side_distance", geometry.sides()[beam]}});
  });
}

TEST(GymWorld, TimeToCollision) {
  const TimeToCollision test(gym_lidar(), {});
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
  explicit TraceRun(const std::filesystem::path& folder)
      : trace_(folder / "sim_trace.csv"),
        scans_(folder / "sim_trace_scans.csv"),
        track_(std::make_shared<const Track>(gym_track(folder, "berlin"))) {
    for (std::size_t row = 0; row < scans_.rows(); ++row) scan_rows_[key_of(scans_[row])] = row;
    visit_cases(trace_, [&](std::size_t begin, std::size_t end) { run(begin, end); });
    EXPECT_GT(states_.cases(), 0);
  }

 private:
  using RowKey = std::tuple<int, int, int>;
  static RowKey key_of(const GoldenRow& row) {
    return {row.integer("case"), row.integer("k"), row.integer("agent")};
  }

  void run(std::size_t begin, std::size_t end) {
    if (::testing::Test::HasFailure()) return;
    states_.next_case();
    std::vector<maps::Pose> starts;
    std::size_t row = begin;
    for (; row < end && trace_[row].integer("k") == 0; ++row)
      starts.push_back({trace_[row].real("x"), trace_[row].real("y"), trace_[row].real("psi")});
    WorldOptions options = WorldOptions::gym_compatible();
    options.lidar.noise = 0;
    // The file does not name it; f1tenth_gym's default but for the one case that was run with Euler.
    if (trace_[begin].integer("case") == 7) options.plant.dynamics.integrator = Integrator::euler;
    World world(options, track_);
    world.reset(0, starts);
    for (std::size_t agent = 0; agent < starts.size(); ++agent) compare(world, agent, trace_[begin + agent]);
    std::vector<Command> commands(starts.size());
    while (row < end && !::testing::Test::HasFailure()) {
      for (std::size_t agent = 0; agent < starts.size(); ++agent)
        commands[agent] = {trace_[row + agent].real("steer_cmd"), trace_[row + agent].real("speed_cmd")};
      world.step(commands);
      for (std::size_t agent = 0; agent < starts.size(); ++agent, ++row) compare(world, agent, trace_[row]);
    }
  }

  void compare(const World& world, std::size_t agent, const GoldenRow& row) {
    SCOPED_TRACE("case " + row.text("case") + " k " + row.text("k"));
    const StartZoneLaps& laps = world.start_zone_laps(agent);
    states_.absolute(row, columns(world.state(agent)));
    states_.absolute(row, {{"lap_time", laps.time()}});
    EXPECT_LE(states_.worst(), 1e-8);
    EXPECT_EQ(world.flags()[agent], row.integer("collision"));
    EXPECT_EQ(world.observe(agent).wall, row.integer("wall_collision") == 1);
    EXPECT_EQ(world.last_partner(agent), row.integer("collision_idx"));
    EXPECT_EQ(laps.toggles(), row.integer("toggles"));
    EXPECT_EQ(laps.laps(), row.integer("lap_count"));
    bool all_finished = true;
    for (std::size_t i = 0; i < world.cars(); ++i)
      all_finished = all_finished && world.start_zone_laps(i).finished();
    EXPECT_EQ(world.flags()[0] || all_finished, row.integer("done") == 1);
    const auto scan = scan_rows_.find(key_of(row));
    if (scan == scan_rows_.end()) return;
    ranges_.next_case();
    ranges_.absolute(world.observe(agent).gym_ranges, scans_[scan->second].series("r"));
    EXPECT_LE(ranges_.worst(), 1e-8);
  }

  GoldenTable trace_, scans_;
  std::shared_ptr<const Track> track_;
  std::map<RowKey, std::size_t> scan_rows_;
  Comparison states_{"sim_trace"}, ranges_{"sim_trace_scans"};
};

TEST(GymWorld, EnvironmentTraces) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  TraceRun run(folder);
}

}  // namespace
}  // namespace slalom::sim
