
#include <iostream>

#include "golden.hpp"
#include "maps/grid_map_csv.hpp"
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/vehicle/published/path_tracking.hpp"
#include "vehicle/rollout_cases.hpp"

namespace slalom::vehicle {
namespace {

using slalom::testing::GridMap;
using namespace testing;

struct MapPair {
  GridMap<4> reference;
  GridMap<1> obstacles;
  double x, y, yaw;
};

std::map<std::string, MapPair> load_maps(const std::filesystem::path& folder) {
  std::map<std::string, MapPair> maps;
  const auto described = nlohmann::json::parse(std::ifstream(folder / "maps.json"));
  for (const auto& [id, about] : described.items()) {
    if (!std::filesystem::exists(folder / (id + "_obstacle.csv"))) continue;
    const double x = about.at("robot_x"), y = about.at("robot_y"), yaw = about.at("robot_yaw");
    maps.emplace(id, MapPair{slalom::testing::load_reference_map(folder, id, x, y),
                             slalom::testing::load_obstacle_map(folder, id), x, y, yaw});
  }
  return maps;
}

/// The storage cells that a position falls into: {reference, obstacle}.
struct Cells {
  long reference, obstacle;
  bool operator==(const Cells&) const = default;
};

template <class Problem>
constexpr bool two_trajectories = std::is_same_v<Problem, published::TwoTrajectories>;

/// A problem on its maps, in a frame that is parallel to the map frame and begins at `origin`.
template <class Problem>
struct Checked {
  Problem problem;
  VehicleMaps maps;  ///< in the map frame
  maps::Point origin;

  Checked(const VehicleOptions& options, const MapPair& pair)
      : problem(options, options.own_of<published::ModelOptions>()),
        // Without localisation the state itself is in the robot's frame.
        maps{pair.reference.view(), pair.obstacles.view(),
             options.localisation_less ? maps::Pose{} : maps::Pose{pair.x, pair.y, pair.yaw}} {
    problem.set_maps(maps);
  }
  /// The same in a frame that begins at the start, as ProblemModel rolls out.
  Checked relative_to_start(const Case& c) const {
    Checked made = *this;
    made.origin = {c.start[0], c.start[1]};
    made.problem.set_maps(maps.relative_to(made.origin));
    return made;
  }

  template <class T>
  typename Problem::template State<T> start(const Case& c) const {
    typename Problem::template State<T> s{};
    s.x = T(c.start[0] - origin.x);
    s.y = T(c.start[1] - origin.y);
    s.yaw = T(c.start[2]);
    s.speed = T(c.start[3]);
    s.steer = T(c.start[4]);
    s.held = T(0);
    if constexpr (two_trajectories<Problem>) s.local_x = s.local_y = s.local_yaw = s.local_steer = T(0);
    return s;
  }
};

template <class Problem>
void check_in_double(const Checked<Problem>& checked, const Case& c, double& worst_state,
                     double& worst_cost) {
  const auto& problem = checked.problem;
  auto s = checked.template start<double>(c);
  double state = 0, collision = 0;
  const auto note = [](double& worst, double value, double expected) {
    worst = std::max(worst, std::abs(value - expected) / std::max(1.0, std::abs(expected)));
  };
  for (std::size_t k = 0; k < 15; ++k) {
    const auto& golden = c.states.at(k);
    note(worst_state, s.x, golden[0]);
    note(worst_state, s.y, golden[1]);
    note(worst_state, std::remainder(s.yaw - golden[2], 2 * std::acos(-1.0)), 0);
    note(worst_state, s.speed, golden[3]);
    note(worst_state, s.steer, golden[4]);
    if constexpr (two_trajectories<Problem>) {
      note(worst_state, s.local_x, golden[5]);
      note(worst_state, s.local_y, golden[6]);
      note(worst_state, std::remainder(s.local_yaw - golden[7], 2 * std::acos(-1.0)), 0);
      note(worst_state, s.local_steer, golden[9]);
    }
    const auto seen = problem.look_up(s);
    const Input<double, 1> u{{k < 14 ? c.inputs[k] : 0}};
    const auto cost = k < 14 ? problem.stage_cost(s, seen, u) : problem.terminal_cost(s, seen);
    const double hit = problem.collision_part(seen, k == 14);
    collision += hit;
    state += cost.value - hit;
    if (k < 14) s = problem.step(s, seen, u, static_cast<int>(k));
  }
  note(worst_cost, state, c.state_cost);
  note(worst_cost, collision, c.collision_cost);
  note(worst_cost, state + collision, c.sample_cost);
}

/// Appends the cells that a rollout visits in packs.
template <class Problem>
struct VisitedCells {
  template <class Target>
  SLALOM_KERNEL static void run(const Checked<Problem>& checked, const Case& c, std::vector<Cells>& visited) {
    using F = Pack<Target>;
    const VehicleMaps maps = checked.maps.relative_to(checked.origin);
    auto s = checked.template start<F>(c);
    for (int k = 0; k < 15; ++k) {
      F local_x = s.x + F(checked.origin.x), local_y = s.y + F(checked.origin.y);
      if constexpr (two_trajectories<Problem>) {
        local_x = s.local_x;
        local_y = s.local_y;
      }
      const auto r = maps.reference.index(s.x, s.y);
      const auto o = maps.obstacles.index(local_x, local_y);
      visited.push_back({r.v[0], o.v[0]});
      const auto seen = checked.problem.look_up(s);
      const Input<F, 1> u{{F(k < 14 ? c.inputs[k] : 0)}};
      s = checked.problem.step(s, seen, u, k);
    }
  }
};

/// Whether a position lies within 1e-4 m of an edge between two cells of a grid, along either axis.
template <int Layers>
bool near_edge(const GridView<Layers>& grid, double x, double y) {
  const auto off = [&](double position, double center, int count) {
    const double cells = (position - center) / grid.resolution() + 0.5 * count;
    return std::abs(cells - std::round(cells)) * grid.resolution();
  };
  return off(x, grid.center_x(), grid.rows()) < 1e-4 || off(y, grid.center_y(), grid.columns()) < 1e-4;
}

struct FloatTally {
  int same_cells = 0, other_cells = 0;
  double worst = 0;
};

template <class Problem>
void check_in_float(const Checked<Problem>& in_map, const Case& c, simd::Target target, FloatTally& tally) {
  const Checked<Problem> checked = in_map.relative_to_start(c);
  const GridView<4>& reference = checked.maps.reference;
  const GridView<1>& obstacles = checked.maps.obstacles;
  std::vector<Cells> visited;
  simd::kernel<VisitedCells<Problem>>(target)(checked, c, visited);
  bool differs = false;
  for (std::size_t k = 0; k < 15; ++k) {
    const auto& golden = c.states[k];
    const long r = reference.index(golden[0], golden[1]), o = obstacles.index(golden[5], golden[6]);
    // The ring has many cells of equal value; in double all of them are cell 0.
    const auto same = [](const auto& grid, long a, long b) { return a == b || (b == 0 && grid.in_ring(a)); };
    if (!same(reference, visited[k].reference, r)) {
      differs = true;
      EXPECT_TRUE(near_edge(reference, golden[0], golden[1])) << "case " << c.id << " step " << k;
    }
    if (!same(obstacles, visited[k].obstacle, o)) {
      differs = true;
      EXPECT_TRUE(near_edge(obstacles, golden[5], golden[6])) << "case " << c.id << " step " << k;
    }
    EXPECT_FALSE(differs && k == 0) << "case " << c.id << ": the start itself is in another cell";
    if (differs) break;  // from here on the rollout may go another way
  }
  if (differs) {
    ++tally.other_cells;
    return;
  }
  ++tally.same_cells;
  ProblemEvaluator<Problem> evaluator(checked.problem, target);
  evaluator.set_state(checked.template start<double>(c));
  SequenceBatch batch(14, 1, 1);
  for (int t = 0; t < 14; ++t) batch.at(t, 0, 0) = static_cast<float>(c.inputs[t]);
  std::vector<float> costs(simd::padding);
  std::vector<std::uint8_t> collided(simd::padding);
  evaluator.evaluate(batch, 0, 1, costs.data(), collided.data());
  const double error = std::abs(costs[0] - c.sample_cost) / std::max(1.0, std::abs(c.sample_cost));
  tally.worst = std::max(tally.worst, error);
  EXPECT_LE(error, 1e-4) << "case " << c.id;
}

template <class Check>
int for_each_case(const std::filesystem::path& folder, const std::filesystem::path& map_folder,
                  Check&& check) {
  const auto maps = load_maps(map_folder);
  const auto sets = nlohmann::json::parse(std::ifstream(folder / "param_sets.json"));
  int compared = 0;
  for (const Case& c : load_cases(folder)) {
    const auto map = maps.find(c.map);
    if (map == maps.end()) {
      ADD_FAILURE() << "case " << c.id << ": there is no map " << c.map;
      continue;
    }
    const VehicleOptions options = options_of(sets.at(std::to_string(c.parameters)));
    // The linear form's target is the reference speed at the start; without localisation there is none.
    const auto run = [&](auto checked) {
      double target = options.reference_speed;
      if (!options.localisation_less)
        target = slalom::look_up(checked.maps.reference, c.start[0], c.start[1]).c;
      checked.problem.set_target_speed(target);
      check(checked, c);
    };
    if (options.own_of<published::ModelOptions>().straight_local_rollout) {
      run(Checked<published::TwoTrajectories>(options, map->second));
    } else {
      run(Checked<published::OneTrajectory>(options, map->second));
    }
    ++compared;
  }
  return compared;
}

TEST(GoldenRollout, Double) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/rollout_cost");
  SLALOM_GOLDEN_FOLDER(map_folder, "controller/maps");
  double worst_state = 0, worst_cost = 0;
  const int compared = for_each_case(folder, map_folder, [&](const auto& checked, const Case& c) {
    check_in_double(checked, c, worst_state, worst_cost);
  });
  std::cout << "rollout_cost, double: " << compared << " cases, largest error of a state " << worst_state
            << ", of a cost " << worst_cost << "\n";
  EXPECT_GT(compared, 0);
  EXPECT_LE(worst_state, 1e-9);
  EXPECT_LE(worst_cost, 1e-9);
}

class GoldenRolloutOn : public ::testing::TestWithParam<simd::Target> {};

TEST_P(GoldenRolloutOn, Float) {
  SLALOM_GOLDEN_FOLDER(folder, "controller/rollout_cost");
  SLALOM_GOLDEN_FOLDER(map_folder, "controller/maps");
  if (!simd::supported(GetParam())) GTEST_SKIP() << "this processor has no " << simd::name(GetParam());
  FloatTally tally;
  const int compared = for_each_case(folder, map_folder, [&](const auto& checked, const Case& c) {
    check_in_float(checked, c, GetParam(), tally);
  });
  std::cout << "rollout_cost, float32 on " << simd::name(GetParam()) << ": " << compared << " cases, "
            << tally.other_cells
            << " of them with another cell at an edge; largest relative error of the others " << tally.worst
            << "\n";
  EXPECT_LE(tally.other_cells, 0.1 * compared);
  EXPECT_GT(tally.same_cells, 0);
}

INSTANTIATE_TEST_SUITE_P(Targets, GoldenRolloutOn,
                         ::testing::Values(simd::Target::generic, simd::Target::sse4, simd::Target::avx2,
                                           simd::Target::avx512),
                         [](const auto& target) { return simd::name(target.param); });

}  // namespace
}  // namespace slalom::vehicle
