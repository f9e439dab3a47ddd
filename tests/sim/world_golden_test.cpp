#include <map>

#include "sim/golden_table.hpp"
#include "slalom/maps/ros_map.hpp"
#include "slalom/sim/gym.hpp"
#include "slalom/sim/lidar.hpp"
#include "slalom/sim/plant.hpp"
#include "slalom/sim/world.hpp"

namespace slalom::sim {
namespace {

/// A map of the golden data as f1tenth_gym reads it.
inline sim::Track gym_track(const std::filesystem::path& folder, const std::string& map) {
  auto yaml = folder / "maps" / map / "map.yaml";
  if (!std::filesystem::exists(yaml)) yaml.replace_filename(map + ".yaml");
  return sim::Track(maps::load_ros_map(yaml, maps::MapRule::grey_threshold), {}, false);
}

inline sim::LidarOptions gym_lidar() {
  return sim::WorldOptions::gym_compatible().lidar;
}

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

using namespace slalom::testing;

maps::Pose pose_of(const GoldenRow& row, const std::string& prefix = "") {
  return {row.real(prefix + "x"), row.real(prefix + "y"), row.real(prefix + "yaw")};
}

class GymScan : public ::testing::TestWithParam<const char*> {};

TEST_P(GymScan, Lidar) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const std::string map = GetParam();
  const Track track = gym_track(folder, map);
  const Lidar lidar(gym_lidar());
  std::vector<double> ranges(1080);
  compare_rows("lidar_" + map, 1e-9, [&](const GoldenRow& row, Comparison& compared) {
    // The pose of this case lies on a corner of a cell.
    if (map == "berlin" && row.integer("case") == 59) return;
    lidar.gym_scan(track, pose_of(row), ranges);
    compared.absolute(ranges, row.series("r"));
  });
}

INSTANTIATE_TEST_SUITE_P(Maps, GymScan, ::testing::Values("berlin", "skirk"));

TEST(GymLidar, RayCast) {
  const Lidar lidar(gym_lidar());
  std::vector<double> ranges;
  compare_rows("raycast", 1e-9, [&](const GoldenRow& row, Comparison& compared) {
    if (row.text("row") == "base") {
      ranges = row.series("r");
      return;
    }
    lidar.gym_cast(pose_of(row, "ego_"), Box{pose_of(row, "opp_"), 0.58, 0.31}, ranges);
    compared.absolute(ranges, row.series("r"));
  });
}

using namespace slalom::testing;

const DynamicsOptions gym_dynamics{.substeps = 1, .gym = true};
const ActuationOptions gym_actuation{.gym = true};

CarState state_of(const GoldenRow& row) {
  CarState s{row.real("x"), row.real("y"), row.real("delta"), row.real("v"), row.real("psi")};
  if (row.has("psidot")) s.yaw_rate = row.real("psidot"), s.slip = row.real("beta");
  return s;
}

TEST(GymDynamics, SingleTrackDerivatives) {
  compare_rows("dynamics_st", 1e-12, [](const GoldenRow& row, Comparison& compared) {
    const auto car = row.text("params") == "commonroad" ? CarParameters::full_scale() : CarParameters{};
    const CarState f = derivative(car, gym_dynamics, state_of(row), {row.real("u_sv"), row.real("u_accl")});
    compared.relative(row, {{"f_x", f.x},
                            {"f_y", f.y},
                            {"f_delta", f.steer},
                            {"f_v", f.speed},
                            {"f_psi", f.yaw},
                            {"f_psidot", f.yaw_rate},
                            {"f_beta", f.slip}});
  });
}

TEST(GymDynamics, KinematicDerivatives) {
  DynamicsOptions options = gym_dynamics;
  options.model = Model::kinematic;
  compare_rows("dynamics_ks", 1e-12, [&](const GoldenRow& row, Comparison& compared) {
    const CarState f =
        derivative(CarParameters{}, options, state_of(row), {row.real("u_sv"), row.real("u_accl")});
    compared.relative(row,
                      {{"f_x", f.x}, {"f_y", f.y}, {"f_delta", f.steer}, {"f_v", f.speed}, {"f_psi", f.yaw}});
  });
}

TEST(GymDynamics, Trajectories) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable sensitivity(folder / "trajectory_sensitivity.csv");
  std::unordered_map<std::string, int> valid_steps;
  for (std::size_t i = 0; i < sensitivity.rows(); ++i)
    valid_steps[sensitivity[i].text("case") + sensitivity[i].text("integrator")] =
        sensitivity[i].integer("valid_steps");
  PlantOptions options{.dynamics = gym_dynamics, .actuation = gym_actuation, .gym = true};
  Plant plant(CarParameters{}, options, 0.01);
  int valid = 0;
  compare_rows("trajectories", 1e-10, [&](const GoldenRow& row, Comparison& compared) {
    const std::string integrator = row.text("integrator");
    if (row.integer("k") == 0) {
      options.dynamics.integrator = integrator == "Euler" ? Integrator::euler : Integrator::runge_kutta_4;
      plant = Plant(CarParameters{}, options, 0.01);
      plant.reset(state_of(row));
      valid = valid_steps.at(row.text("case") + integrator);
      return;
    }
    if (row.integer("k") > valid) return;
    plant.step({row.real("steer_cmd"), row.real("speed_cmd")});
    EXPECT_EQ(plant.steering_applied(), row.real("steer_applied"));
    compared.relative(row, columns(plant.state()));
  });
}

}  // namespace

}  // namespace slalom::sim
