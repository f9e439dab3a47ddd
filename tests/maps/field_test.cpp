#include "slalom/maps/field.hpp"

#include <random>

#include "slalom/core/derivatives/linearize.hpp"
#include "support/rollouts.hpp"
#include "support/thrown_words.hpp"

namespace slalom::maps::field_test {
namespace {

constexpr FieldGeometry turned{23, 17, 0.25, {3, -2, 0.7}};

Field random_field(const FieldGeometry& geometry, unsigned seed, std::vector<double>* samples = nullptr) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-2, 2);
  std::vector<double> values(geometry.width * geometry.height);
  for (double& v : values) v = static_cast<double>(static_cast<float>(uniform(random)));
  if (samples) *samples = values;
  return Field(geometry, values);
}

TEST(Field, HasItsSamplesInTheCentresOfCells) {
  std::vector<double> samples;
  const Field field = random_field(turned, 1, &samples);
  for (int row = 0; row < turned.height; ++row) {
    for (int column = 0; column < turned.width; ++column) {
      const Point p = turned.center(column, row);
      EXPECT_NEAR(field.value(p.x, p.y), samples[row * turned.width + column], 1e-6);
    }
  }
}

TEST(Field, InterpolatesBilinearFunctionsExactlyWithTheirGradients) {
  const auto f = [](double x, double y) { return 1 + 2 * x - 0.5 * y + 0.25 * x * y; };
  const FieldGeometry level{40, 30, 0.1, {-1, -2, 0}};
  const Field field = Field::from_function(level, f);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> in_x(-0.95, 2.95), in_y(-1.95, 0.95);
  for (int i = 0; i < 200; ++i) {
    const double x = in_x(random), y = in_y(random);
    const auto [value, dx, dy] = field.value_and_gradient(x, y);
    EXPECT_NEAR(value, f(x, y), 2e-6);
    EXPECT_NEAR(dx, 2 + 0.25 * y, 2e-5);
    EXPECT_NEAR(dy, -0.5 + 0.25 * x, 2e-5);
  }
}

TEST(Field, GradientIsThatOfTheValueInsideAndOutside) {
  const Field field = random_field(turned, 3);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> place(-8, 12);
  const double h = 1e-6;
  int compared = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = place(random), y = place(random);
    const auto at = field.value_and_gradient(x, y);
    const double up_x = field.value(x + h, y), down_x = field.value(x - h, y), up_y = field.value(x, y + h),
                 down_y = field.value(x, y - h);
    // Where both sides differ, a line between two cells is within h.
    if (std::abs(up_x + down_x - 2 * at.value) + std::abs(up_y + down_y - 2 * at.value) > 1e-9) continue;
    EXPECT_NEAR(at.dx, (up_x - down_x) / (2 * h), 1e-5);
    EXPECT_NEAR(at.dy, (up_y - down_y) / (2 * h), 1e-5);
    ++compared;
  }
  EXPECT_GT(compared, 1900);
}

TEST(Field, ContinuesTheValuesOfItsEdge) {
  std::vector<double> samples;
  const FieldGeometry level{4, 3, 1, {10, 20, 0}};
  const Field field = random_field(level, 5, &samples);
  for (const double far : {0.6, 3.0, 1e5}) {
    EXPECT_DOUBLE_EQ(field.value(10.5 - far, 20.5 - far), samples[0]);
    EXPECT_DOUBLE_EQ(field.value(13.5 + far, 22.5 + far), samples[11]);
    const auto left = field.value_and_gradient(10.5 - far, 21.25);
    EXPECT_NEAR(left.value, 0.25 * samples[0] + 0.75 * samples[4], 1e-6);
    EXPECT_EQ(left.dx, 0);
    EXPECT_NEAR(left.dy, samples[4] - samples[0], 1e-6);
  }
  const Field one(FieldGeometry{1, 1, 1, {}}, std::vector<double>{7});
  EXPECT_EQ(one.value(-3.0, 5.0), 7);
  EXPECT_EQ(Field().value(1.0, 2.0), 0);
}

/// A point that moves over a map; the cost is its value and its gradient.
struct Walker {
  template <class T>
  struct State {
    T x, y;
  };
  static constexpr int inputs = 2;
  Field map;

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    return {s.x + u[0], s.y + u[1]};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 2>&) const {
    const auto [value, dx, dy] = map.value_and_gradient(s.x, s.y);
    return value + T(0.1) * (dx + dy);
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return map.value(s.x, s.y);
  }
};

TEST(Field, IsTheSameInLanesOfEveryInstructionSet) {
  // A smooth map, so that a position that lanes round into the neighbouring cell has a similar gradient.
  const Field field = Field::from_function({300, 200, 0.1, {-10, -10, 0.3}}, [](double x, double y) {
    return std::sin(0.3 * x) * std::cos(0.2 * y);
  });
  SequenceBatch batch{3, 2, 100};
  std::mt19937 random(6);
  std::normal_distribution<float> normal(0, 8);
  for (int row = 0; row < batch.rows(); ++row)
    for (int i = 0; i < batch.samples(); ++i) batch.data(row)[i] = normal(random);
  for (const auto target : slalom::testing::instruction_sets()) {
    ProblemEvaluator<Walker> evaluator({field}, target);
    evaluator.set_state({1, 2});
    const auto costs = slalom::testing::roll_out(evaluator, batch).costs;
    for (int i = 0; i < batch.samples(); ++i) {
      const auto u = slalom::testing::inputs_of<2>(batch, i);
      EXPECT_NEAR(costs[i], predict(evaluator.problem(), {1.0, 2.0}, u.data(), 3, nullptr).value, 3e-3)
          << simd::name(target) << " sample " << i;
    }
  }
}

TEST(Field, GivesDualNumbersItsGradientAndTellsOfItsKinks) {
  const Field field = random_field(turned, 12);
  const auto l = linearize(Walker{field}, {2.1, 1.3}, {{0.0, 0.0}});
  const auto here = field.value_and_gradient(2.1, 1.3);
  const auto end = expand_terminal_cost(Walker{field}, {2.1, 1.3});
  EXPECT_DOUBLE_EQ(end.value, here.value);
  EXPECT_NEAR(end.gradient[0], here.dx, 1e-12);
  EXPECT_NEAR(end.gradient[1], here.dy, 1e-12);
  EXPECT_FALSE(l.kink);
  const double h = 1e-6;
  const auto right = field.value_and_gradient(2.1 + h, 1.3), left = field.value_and_gradient(2.1 - h, 1.3);
  EXPECT_NEAR(end.hessian[0][1], (right.dy - left.dy) / (2 * h), 1e-5);
  const Field level(FieldGeometry{2, 2, 1, {}}, std::vector<double>{0, 1, 2, 3});
  EXPECT_TRUE(linearize(Walker{level}, {0.5, 0.9}, {{0.0, 0.0}}).kink) << "on a line between cells";
}

TEST(Field, EvaluatesAnyNumberOfPositions) {
  const Field field = random_field(turned, 7);
  std::mt19937 random(8);
  std::uniform_real_distribution<float> place(-4, 9);
  for (const std::size_t count : {0, 1, 15, 16, 37}) {
    std::vector<float> x(count), y(count), value(count + 1, 99), dx(count + 1, 99), dy(count + 1, 99);
    for (std::size_t i = 0; i < count; ++i) x[i] = place(random), y[i] = place(random);
    field.evaluate(x.data(), y.data(), count, value.data());
    std::vector<float> again(count + 1, 99);
    field.evaluate(x.data(), y.data(), count, again.data(), dx.data(), dy.data());
    EXPECT_EQ(value, again);
    for (std::size_t i = 0; i < count; ++i)
      EXPECT_NEAR(value[i], field.value(static_cast<double>(x[i]), static_cast<double>(y[i])), 2e-4);
    EXPECT_EQ(value[count], 99);
    EXPECT_EQ(dx[count], 99);
    EXPECT_EQ(dy[count], 99);
  }
}

TEST(Field, PositionsThatAreNotNumbersGiveNoNumber) {
  const Field field = random_field(turned, 9);
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(std::isnan(field.value(nan, 0.0)));
  EXPECT_TRUE(std::isnan(field.value(0.0, inf)));
  const float x[] = {std::numeric_limits<float>::quiet_NaN(), 0, 3e38F, -3e38F}, y[] = {0, -INFINITY, 0, 0};
  float value[4];
  field.evaluate(x, y, 4, value);
  EXPECT_TRUE(std::isnan(value[0]));
  EXPECT_TRUE(std::isnan(value[1]));
}

TEST(Field, IsRelativeToAPointFarFromTheOrigin) {
  const FieldGeometry utm{60, 50, 0.05, {554321.5, 5801234.25, -0.4}};
  const Field field =
      Field::from_function(utm, [](double x, double y) { return std::hypot(x - 554322, y - 5801235); });
  const Field local = field.relative_to(554322, 5801235);
  const float x[] = {0.3F, 0.2F}, y[] = {0.4F, -0.1F};
  float value[2];
  local.evaluate(x, y, 2, value);
  EXPECT_NEAR(value[0], 0.5, 2e-3);
  EXPECT_NEAR(value[1], std::hypot(0.2, 0.1), 4e-3);
  EXPECT_NEAR(local.value(0.3, 0.4), field.value(554322.3, 5801235.4), 1e-6);
}

std::string message(const FieldGeometry& geometry, const std::vector<double>& samples) {
  return message_of([&] { Field(geometry, samples); });
}

TEST(Field, RejectsWhatCannotBeAMap) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message({0, 2, 1, {}}, {}), "field.width: 0: must be at least 1");
  EXPECT_EQ(message({2, 2, 0, {}}, {1, 2, 3, 4}), "field.resolution: 0: must be finite and above 0");
  EXPECT_EQ(message({2, 2, 1, {0, nan, 0}}, {1, 2, 3, 4}),
            "field.origin (0, .nan, 0): must have x and y within 1e7 m of 0 and a yaw within 1e6 rad");
  EXPECT_EQ(message({3, 2, 1, {}}, {1, 2, 3, 4}), "field: number of samples: 4: must be 2 x 3");
  EXPECT_EQ(message({2, 2, 1, {}}, {1, 2, nan, 4}),
            "field: sample in row 1, column 0: nan: must be a finite float32 value");
  EXPECT_EQ(message({2, 2, 1, {}}, {1, 1e39, 3, 4}),
            "field: sample in row 0, column 1: 1e+39: must be a finite float32 value");
  EXPECT_EQ(message({100000, 100000, 1, {}}, {}),
            "field: number of samples: 10000000000: must be at most 2^26; use a coarser resolution");
  EXPECT_THROW(Field().relative_to(nan, 0), std::invalid_argument);
}

/// To the nearest edge of an obstacle cell, in cells; those outside the grid are obstacles if said.
double distance_to_cells(const OccupancyGrid& grid, int column, int row, bool obstacles, bool outside) {
  double best = std::numeric_limits<double>::infinity();
  for (int r = -1; r <= grid.height; ++r) {
    for (int c = -1; c <= grid.width; ++c) {
      const bool obstacle = grid.contains(c, r) ? grid.at(c, r) == Occupancy::occupied : outside;
      if ((!grid.contains(c, r) && !outside) || obstacle != obstacles) continue;
      best = std::min(best, std::hypot(std::max(std::abs(c - column) - 0.5, 0.0),
                                       std::max(std::abs(r - row) - 0.5, 0.0)));
    }
  }
  return best;
}

TEST(SignedDistance, IsThatToTheEdgesOfObstacleCells) {
  std::mt19937 random(11);
  for (int trial = 0; trial < 40; ++trial) {
    OccupancyGrid grid{
        1 + static_cast<int>(random() % 25), 1 + static_cast<int>(random() % 25), 0.5, {1, 2, 0.3}, {}};
    for (int i = 0; i < grid.width * grid.height; ++i)
      grid.cells.push_back(random() % 5 == 0 ? Occupancy::occupied : Occupancy::free);
    grid.cells[0] = Occupancy::occupied;
    const bool outside = trial % 2 == 0;
    const Field field = signed_distance(grid, {.outside_is_obstacle = outside});
    const FieldGeometry cells{grid.width, grid.height, grid.resolution, grid.origin};
    for (int row = 0; row < grid.height; ++row) {
      for (int column = 0; column < grid.width; ++column) {
        const Point p = cells.center(column, row);
        const bool obstacle = grid.at(column, row) == Occupancy::occupied;
        const double size = field.value(p.x, p.y) / grid.resolution * (obstacle ? -1 : 1);
        const double exact = distance_to_cells(grid, column, row, !obstacle, outside);
        EXPECT_GT(size, 0);
        if (std::isfinite(exact)) {
          EXPECT_GE(size, exact - 1e-4);
          EXPECT_LE(size, exact + 0.2072);
        }
      }
    }
  }
}

TEST(SignedDistance, KnowsUnknownCellsAndWhatLiesOutside) {
  OccupancyGrid grid{5, 5, 1, {}, std::vector<Occupancy>(25, Occupancy::free)};
  EXPECT_NEAR(signed_distance(grid).value(2.5, 2.5), 2.5, 1e-6);
  EXPECT_NEAR(signed_distance(grid).value(-4.0, 2.5), -0.5, 1e-6);
  EXPECT_NEAR(signed_distance(grid, {.outside_is_obstacle = false}).value(2.5, 2.5), std::hypot(5, 5), 1e-6);
  grid.at(3, 2) = Occupancy::unknown;
  EXPECT_NEAR(signed_distance(grid).value(2.5, 2.5), 0.5, 1e-6);
  EXPECT_NEAR(signed_distance(grid, {.unknown_is_obstacle = false}).value(2.5, 2.5), 2.5, 1e-6);
  grid.cells.assign(25, Occupancy::occupied);
  EXPECT_LT(signed_distance(grid).value(2.5, 2.5), -5);
  EXPECT_THROW(signed_distance(OccupancyGrid{}), std::invalid_argument);
  grid.cells.pop_back();
  EXPECT_THROW(signed_distance(grid), std::invalid_argument);
}

}  // namespace
}  // namespace slalom::maps::field_test
