
#include "sim/golden_table.hpp"
#include "slalom/sim/plant.hpp"

namespace slalom::sim {
namespace {

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
