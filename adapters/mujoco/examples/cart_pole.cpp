// A pole on a cart, simulated by MuJoCo: swing the pole up by pushing the cart, and keep the cart on its
// track.
//   slalom_mujoco_cart_pole cart_pole.xml [seeds]

#include <cmath>

#include "closed_loop.hpp"

struct SwingUp {
  static constexpr int positions = 2, velocities = 2, inputs = 1;

  double stage_cost(const mjModel& model, const mjData& data) const {
    return 0.1 * terminal_cost(model, data) + 1e-4 * data.ctrl[0] * data.ctrl[0];
  }
  double terminal_cost(const mjModel&, const mjData& data) const {
    const double position = data.qpos[0], angle = data.qpos[1], speed = data.qvel[0], rate = data.qvel[1];
    return 2 * (1 + std::cos(angle)) + 0.2 * position * position + 0.02 * (speed * speed + rate * rate);
  }
};

int main(int argc, char** argv) {
  if (argc < 2) return std::puts("usage: slalom_mujoco_cart_pole cart_pole.xml [seeds]"), 2;
  const slalom::SvgMppiOptions options{.horizon = 50,
                                       .samples = 64,
                                       .temperature = 0.1,
                                       .guides = {.count = 1,
                                                  .iterations = 4,
                                                  .step = 0.2,
                                                  .variance = 4,
                                                  .gradient_samples = 15,
                                                  .gradient_variance = 2,
                                                  .gradient_temperature = 0.1},
                                       .variance_min = 4,
                                       .variance_max = 8};
  const auto hang = [](World& world, slalom::RandomStream& random) {
    world.data().qpos[1] = 0.1 * random.normal();
  };
  const auto stands = [](const mjData& data) {
    return data.time <= 4 || (std::cos(data.qpos[1]) < -0.95 && std::abs(data.qpos[0]) < 1);
  };
  constexpr int physics_steps = 2;
  constexpr double duration = 5;  // s
  return drive(slalom::mujoco::Model(argv[1]), SwingUp{}, options, physics_steps, duration,
               seeds_of(argc, argv, "10"), hang, stands)
      .report("the pole stands");
}
