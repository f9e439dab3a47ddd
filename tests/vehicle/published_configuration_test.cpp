// The vehicle and the planner of the golden tests are those of `--config published`.
#include <gtest/gtest.h>

#include "slalom/vehicle/configuration/configuration.hpp"
#include "slalom/vehicle/published/options.hpp"

namespace slalom::vehicle {
namespace {

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
