// Four tasks of hydrax (Kurtz, github.com/vincekurtz/hydrax) with its models and costs, solved by methods
// that get horizon and bounds alone. Prints a row for each task and method.
//   slalom_mujoco_hydrax CLONE_OF_HYDRAX [seeds]

#include <cmath>
#include <filesystem>
#include <fstream>
#include <regex>
#include <string>

#include <slalom/core/read_file.hpp>

#include "closed_loop.hpp"

constexpr double period = 0.02;  ///< s, of the inputs in all tasks

/// The squared distance of the unit vector at an angle, 0 if it hangs, from the upright one.
double from_upright(double angle) {
  return 2 + 2 * std::cos(angle);
}

struct Pendulum {
  static constexpr const char* folder = "pendulum";
  static constexpr int positions = 1, velocities = 1, inputs = 1;
  static constexpr int physics_steps = 1, horizon = 50, samples = 32;
  static constexpr double spread = 0.1;  ///< standard deviation of the joints at the start

  double stage_cost(const mjModel& m, const mjData& d) const {
    return period * (terminal_cost(m, d) + 0.001 * d.ctrl[0] * d.ctrl[0]);
  }
  double terminal_cost(const mjModel&, const mjData& d) const {
    return from_upright(d.qpos[0]) + 0.01 * d.qvel[0] * d.qvel[0];
  }
  bool good(const mjData& d) const { return std::cos(d.qpos[0]) < -0.95; }
};

struct CartPole {
  static constexpr const char* folder = "cart_pole";
  static constexpr int positions = 2, velocities = 2, inputs = 1;
  static constexpr int physics_steps = 2, horizon = 50, samples = 128;
  static constexpr double spread = 0.1;

  double stage_cost(const mjModel& m, const mjData& d) const {
    const double rest = terminal_cost(m, d) - 9 * from_upright(d.qpos[1]);
    return period * (rest + 0.01 * d.ctrl[0] * d.ctrl[0]);
  }
  double terminal_cost(const mjModel&, const mjData& d) const {
    return 10 * from_upright(d.qpos[1]) + d.qpos[0] * d.qpos[0] +
           0.01 * (d.qvel[0] * d.qvel[0] + d.qvel[1] * d.qvel[1]);
  }
  bool good(const mjData& d) const { return std::cos(d.qpos[1]) < -0.95; }
};

struct DoubleCartPole {
  static constexpr const char* folder = "double_cart_pole";
  static constexpr int positions = 3, velocities = 3, inputs = 1;
  static constexpr int physics_steps = 2, horizon = 50, samples = 256;
  static constexpr double spread = 0.1;

  double stage_cost(const mjModel&, const mjData& d) const {
    const double rates = d.qvel[1] * d.qvel[1] + d.qvel[2] * d.qvel[2];
    return period * (from_top(d) + 0.1 * rates + 0.001 * d.ctrl[0] * d.ctrl[0]);
  }
  double terminal_cost(const mjModel&, const mjData& d) const {
    const double speeds = d.qvel[0] * d.qvel[0] + d.qvel[1] * d.qvel[1] + d.qvel[2] * d.qvel[2];
    return 10 * from_top(d) + 10 * d.qpos[0] * d.qpos[0] + speeds;
  }
  bool good(const mjData& d) const { return from_top(d) < 0.2; }
  /// The squared distance of the tip, the only site, from the place above the cart at which both poles stand.
  static double from_top(const mjData& d) {
    const double up = d.site_xpos[2] - 4, aside = d.site_xpos[0] - d.qpos[0];
    return up * up + aside * aside;
  }
};

struct Walker {
  static constexpr const char* folder = "walker";
  static constexpr int positions = 9, velocities = 9, inputs = 6;
  static constexpr int physics_steps = 2, horizon = 30, samples = 128;
  static constexpr double spread = 0.02;

  double stage_cost(const mjModel& m, const mjData& d) const {
    double efforts = 0;
    for (int i = 0; i < inputs; ++i) efforts += d.ctrl[i] * d.ctrl[i];
    return period * (terminal_cost(m, d) + 0.1 * efforts);
  }
  /// The sensors are the torso's position, the velocity of its subtree and its vertical axis.
  double terminal_cost(const mjModel&, const mjData& d) const {
    const double height = d.sensordata[2] - 1.2, speed = d.sensordata[3] - 1.5, tilt = d.sensordata[8] - 1;
    return 10 * height * height + 3 * tilt * tilt + speed * speed;
  }
  bool good(const mjData& d) const { return d.sensordata[2] > 0.9 && d.sensordata[3] > 0.75; }
};

/// Loads the scene of a task without the attributes that MuJoCo 2 does not know and the number of iterations.
slalom::mujoco::Model load(const std::filesystem::path& folder) {
  const auto copies =
      std::filesystem::temp_directory_path() / ("slalom_hydrax_" + folder.filename().string());
  std::filesystem::create_directories(copies);
  for (const auto& file : slalom::list_folder(folder)) {
    if (file.extension() != ".xml") continue;
    const std::regex unknown(R"( (iterations|ls_iterations|eulerdamp)="[^"]*")");
    std::ofstream(copies / file.filename())
        << std::regex_replace(slalom::read_file(file, 1 << 20), unknown, "");
  }
  return slalom::mujoco::Model((copies / "scene.xml").string());
}

/// Drives 5 s for each seed. A run succeeds if it is good in the whole last second.
template <class Task, class Options>
void solve(const std::string& clone, std::uint64_t seeds) {
  const slalom::mujoco::Model model = load(std::filesystem::path(clone) / "hydrax/models" / Task::folder);
  Options options;
  options.horizon = Task::horizon;
  options.samples = Task::samples;
  const auto begin = [](World& world, slalom::RandomStream& random) {
    for (int i = 0; i < Task::positions; ++i) world.data().qpos[i] += Task::spread * random.normal();
  };
  double cost = 0;
  const auto is_good = [&](const mjData& data) {
    cost += Task{}.stage_cost(model.get(), data) / static_cast<double>(seeds);
    return data.time <= 4 || Task{}.good(data);
  };
  constexpr double duration = 5;  // s
  const Summary summary = drive(model, Task{}, options, Task::physics_steps, duration, seeds, begin, is_good);
  std::printf("%-16s %-9s %d of %d runs, mean cost %.2f, %.2f of real time\n", Task::folder, Options::method,
              summary.succeeded, summary.runs, cost, summary.simulated / summary.processor_time);
  std::fflush(stdout);
}

template <class Task>
void compare(const std::string& clone, std::uint64_t seeds) {
  solve<Task, slalom::SvgMppiOptions>(clone, seeds);
  solve<Task, slalom::IcemOptions>(clone, seeds);
  solve<Task, slalom::MppiOptions>(clone, seeds);
}

int main(int argc, char** argv) try {
  if (argc < 2) return std::puts("usage: slalom_mujoco_hydrax CLONE_OF_HYDRAX [seeds]"), 2;
  const std::uint64_t seeds = seeds_of(argc, argv, "10");
  compare<Pendulum>(argv[1], seeds);
  compare<CartPole>(argv[1], seeds);
  compare<Walker>(argv[1], seeds);
  compare<DoubleCartPole>(argv[1], seeds);
} catch (const std::exception& e) {
  return std::fprintf(stderr, "slalom_mujoco_hydrax: %s\n", e.what()), 1;
}
