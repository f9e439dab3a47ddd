#include <gtest/gtest.h>

#include <string>

#include "golden.hpp"
#include "sim/golden_table.hpp"
#include "slalom/sim/plant.hpp"

namespace slalom::sim {
namespace {

using slalom::testing::Comparison;
using slalom::testing::GoldenTable;

const DynamicsOptions gym_dynamics{.substeps = 1, .gym = GymDynamics::all()};
const ActuationOptions gym_actuation{.gym = GymActuation::all()};

CarState state_of(const GoldenTable& table, std::size_t row) {
  CarState s{table.real(row, "x"), table.real(row, "y"), table.real(row, "delta"), table.real(row, "v"),
             table.real(row, "psi")};
  if (table.has("psidot")) s.yaw_rate = table.real(row, "psidot"), s.slip = table.real(row, "beta");
  return s;
}

TEST(GymDynamics, SingleTrackDerivatives) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "dynamics_st.csv");
  Comparison compared("dynamics_st");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const auto car =
        table.text(row, "params") == "commonroad" ? CarParameters::full_scale() : CarParameters{};
    const CarState f = derivative(car, gym_dynamics, state_of(table, row),
                                  {table.real(row, "u_sv"), table.real(row, "u_accl")});
    compared.next_case();
    compared.relative(f.x, table.real(row, "f_x"));
    compared.relative(f.y, table.real(row, "f_y"));
    compared.relative(f.steer, table.real(row, "f_delta"));
    compared.relative(f.speed, table.real(row, "f_v"));
    compared.relative(f.yaw, table.real(row, "f_psi"));
    compared.relative(f.yaw_rate, table.real(row, "f_psidot"));
    compared.relative(f.slip, table.real(row, "f_beta"));
    ASSERT_LE(compared.worst(), 1e-12) << "case " << table.text(row, "case");
  }
  EXPECT_GT(compared.cases(), 0);
}

TEST(GymDynamics, KinematicDerivatives) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "dynamics_ks.csv");
  Comparison compared("dynamics_ks");
  DynamicsOptions options = gym_dynamics;
  options.model = Model::kinematic;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const CarState f = derivative(CarParameters{}, options, state_of(table, row),
                                  {table.real(row, "u_sv"), table.real(row, "u_accl")});
    compared.next_case();
    compared.relative(f.x, table.real(row, "f_x"));
    compared.relative(f.y, table.real(row, "f_y"));
    compared.relative(f.steer, table.real(row, "f_delta"));
    compared.relative(f.speed, table.real(row, "f_v"));
    compared.relative(f.yaw, table.real(row, "f_psi"));
    ASSERT_LE(compared.worst(), 1e-12) << "case " << table.text(row, "case");
  }
  EXPECT_GT(compared.cases(), 0);
}

TEST(GymDynamics, SteeringLimit) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "steering_constraint.csv");
  Comparison compared("steering_constraint");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    compared.absolute(limit_steer_rate(CarParameters{}, table.real(row, "delta"), table.real(row, "sv_in")),
                      table.real(row, "sv_out"));
    ASSERT_EQ(compared.worst(), 0) << "case " << table.text(row, "case");
  }
  EXPECT_GT(compared.cases(), 0);
}

TEST(GymDynamics, AccelerationLimit) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "accl_constraints.csv");
  Comparison compared("accl_constraints");
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    compared.relative(limit_acceleration(CarParameters{}, table.real(row, "v"), table.real(row, "accl_in")),
                      table.real(row, "accl_out"));
    ASSERT_LE(compared.worst(), 2.3e-16) << "case " << table.text(row, "case");
  }
  EXPECT_GT(compared.cases(), 0);
}

TEST(GymDynamics, LowLevelControl) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "pid.csv");
  Comparison compared("pid");
  const CarParameters car;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    compared.next_case();
    compared.relative(
        acceleration_towards(car, gym_actuation, table.real(row, "v"), table.real(row, "speed_cmd")),
        table.real(row, "accl"));
    compared.relative(
        steer_rate_towards(car, gym_actuation, table.real(row, "delta"), table.real(row, "steer_cmd"), 0.01),
        table.real(row, "sv"));
    ASSERT_LE(compared.worst(), 4.5e-16) << "case " << table.text(row, "case");
  }
  EXPECT_GT(compared.cases(), 0);
}

TEST(GymDynamics, Trajectories) {
  SLALOM_GOLDEN_FOLDER(folder, "simulator");
  const GoldenTable table(folder / "trajectories.csv"), sensitivity(folder / "trajectory_sensitivity.csv");
  std::unordered_map<std::string, int> valid_steps;
  for (std::size_t row = 0; row < sensitivity.rows(); ++row)
    valid_steps[sensitivity.text(row, "case") + sensitivity.text(row, "integrator")] =
        sensitivity.integer(row, "valid_steps");
  Comparison compared("trajectories");
  PlantOptions options{.dynamics = gym_dynamics, .actuation = gym_actuation, .gym = GymPlant::all()};
  Plant plant(CarParameters{}, options, 0.01);
  int valid = 0;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    const std::string integrator = table.text(row, "integrator");
    const int k = table.integer(row, "k");
    if (k == 0) {
      compared.next_case();
      options.dynamics.integrator = integrator == "Euler" ? Integrator::euler : Integrator::runge_kutta_4;
      plant = Plant(CarParameters{}, options, 0.01);
      plant.reset(state_of(table, row));
      valid = valid_steps.at(table.text(row, "case") + integrator);
      continue;
    }
    if (k > valid) continue;
    plant.step({table.real(row, "steer_cmd"), table.real(row, "speed_cmd")});
    const CarState expected = state_of(table, row), actual = plant.state();
    ASSERT_EQ(plant.steering_applied(), table.real(row, "steer_applied"));
    compared.relative(actual.x, expected.x);
    compared.relative(actual.y, expected.y);
    compared.relative(actual.steer, expected.steer);
    compared.relative(actual.speed, expected.speed);
    compared.relative(actual.yaw, expected.yaw);
    compared.relative(actual.yaw_rate, expected.yaw_rate);
    compared.relative(actual.slip, expected.slip);
    ASSERT_LE(compared.worst(), 1e-10)
        << "case " << table.text(row, "case") << " " << integrator << " k " << k;
  }
  EXPECT_GT(compared.cases(), 0);
}

}  // namespace
}  // namespace slalom::sim
