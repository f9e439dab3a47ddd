// The options with which the golden data are compared are those of `--config published`.
#include <gtest/gtest.h>

#include "slalom/solvers/published/published_solvers.hpp"
#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/published/options.hpp"

namespace slalom::vehicle {
namespace {

TEST(PublishedConfiguration, EqualsTheOptionsOfTheGoldenTests) {
  const Configuration file = load_configuration(SLALOM_CONFIGS "/published.yaml");
  int compared = 0, methods = 0;
  for (const SolverOptions& method : file.methods) {
    const std::string name = solver_name(method);
    if (name == "icem" || name == "dial_mpc") continue;  // the paper's program does not have them
    ++methods;
    const auto ours = list_options(method), golden = list_options(published_solver_options(name));
    ASSERT_EQ(ours.size(), golden.size()) << name;
    for (std::size_t i = 0; i < ours.size(); ++i) {
      const std::string option = ours[i].declaration.name;
      EXPECT_EQ(to_text(ours[i].value), to_text(golden[i].value)) << name << "." << option;
      compared += option != "seed" && option != "threads";
    }
  }
  std::printf("[ options  ] %d options of %d methods compared\n", compared, methods);
  EXPECT_EQ(file.methods.size(), solver_names().size());
}

template <class Options>
void expect_equal(const Options& file, const Options& ours) {
  const auto a = list_options(file), b = list_options(ours);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(a[i].value, b[i].value) << a[i].declaration.name;
}

TEST(PublishedConfiguration, HasThePublishedVehicleAndPlanner) {
  const Configuration file = load_configuration(SLALOM_CONFIGS "/published.yaml");
  expect_equal(file.vehicle, published::vehicle_options());
  expect_equal(file.planner, published::planner_options());
}

}  // namespace
}  // namespace slalom::vehicle
