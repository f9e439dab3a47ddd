// A quadruped that lies on its back, a side or its belly, simulated by MuJoCo: it turns over and stands up.
//   slalom_mujoco_quadruped quadruped.xml [seeds]

#include <cmath>
#include <numbers>

#include "closed_loop.hpp"

constexpr double standing_height = 0.33;       // m, of the torso
constexpr double standing[] = {0, 0.6, -1.2};  // rad, of abduction, hip and knee
constexpr double folded[] = {0, 1.6, -2.6};    // rad

/// Height of the torso, m.
double height(const mjData& data) {
  return data.xpos[3 * 1 + 2];
}
/// Cosine of the torso's tilt.
double uprightness(const mjData& data) {
  return data.xmat[9 * 1 + 8];
}

struct StandUp {
  static constexpr int positions = 7 + 12, velocities = 6 + 12, inputs = 12;

  double stage_cost(const mjModel&, const mjData& data) const {
    const double up = uprightness(data);
    double posture = 0, effort = 0, motion = 0;
    for (int i = 0; i < 12; ++i) {
      posture += slalom::square(data.qpos[7 + i] - standing[i % 3]);
      effort += slalom::square(data.ctrl[i] - data.qpos[7 + i]);
    }
    for (int i = 0; i < 6; ++i) motion += slalom::square(data.qvel[i]);
    return 3 * (1 - up) + 40 * slalom::square(height(data) - standing_height) + 0.05 * (1 + up) * posture +
           0.02 * motion + 0.01 * effort;
  }
  double terminal_cost(const mjModel& model, const mjData& data) const { return 5 * stage_cost(model, data); }
};

/// Lets it fall from 0.3 m with folded legs, and lie still.
void lay_down(World& world, slalom::RandomStream& random) {
  double* const q = world.data().qpos;
  const double roll = random.uniform(-std::numbers::pi, std::numbers::pi);
  q[2] = 0.3;
  q[3] = std::cos(roll / 2);
  q[4] = std::sin(roll / 2);
  slalom::Input<double, StandUp::inputs> hold;
  for (int i = 0; i < StandUp::inputs; ++i) hold[i] = q[7 + i] = folded[i % 3] + 0.2 * random.normal();
  world.step(hold, 200);
  world.data().time = 0;
}

int main(int argc, char** argv) {
  if (argc < 2) return std::puts("usage: slalom_mujoco_quadruped quadruped.xml [seeds]"), 2;
  const slalom::MppiOptions options{.horizon = 20,
                                    .samples = 64,
                                    .temperature = 0.1,
                                    .variance = 0.05,
                                    .noise = {.knots = 3},
                                    .control_cost_discount = 1};
  const auto stands = [](const mjData& data) {
    return data.time <= 2.5 || (height(data) > 0.25 && uprightness(data) > 0.85);
  };
  constexpr int physics_steps = 2;
  constexpr double duration = 3;  // s
  return drive(slalom::mujoco::Model(argv[1]), StandUp{}, options, physics_steps, duration,
               seeds_of(argc, argv, "5"), lay_down, stands)
      .report("the quadruped stands");
}
