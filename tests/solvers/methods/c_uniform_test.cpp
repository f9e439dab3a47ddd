#include "slalom/solvers/c_uniform/c_uniform.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "slalom/solvers/mppi.hpp"
#include "slalom/solvers/proposals.hpp"
#include "support/allocations.hpp"

namespace slalom {
namespace {

/// A robot that drives at 1 m/s and turns, in a dead end: it must turn round.
struct DeadEnd {
  template <class T>
  struct State {
    T x, y, yaw;  // m, m, rad
  };
  static constexpr int inputs = 1;       // yaw rate, rad/s
  double dt = 0.1;                       // s
  double input_min = -2, input_max = 2;  // rad/s
  double goal_x = -4, wall = 2;          // m

  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u) const {
    T s, c;
    sin_cos(x.yaw, s, c);
    return {x.x + T(dt) * c, x.y + T(dt) * s, x.yaw + T(dt) * u[0]};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& x, const Input<T, 1>&) const {
    const mask_t<T> hit = collides(x);
    return {T(dt) * distance(x) + select(hit, T(20), T(0)), hit};
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return distance(x);
  }
  template <class T>
  T distance(const State<T>& x) const {
    return sqrt(square(x.x - T(goal_x)) + square(x.y));
  }
  template <class T>
  mask_t<T> collides(const State<T>& x) const {
    return (x.x > T(wall)) | (abs(x.y) > T(1.15));
  }
};

constexpr int steps = 24;
constexpr CellAxis pose_cells[] = {{0.2}, {0.2}, {0.4, 2 * std::numbers::pi}};
const CUniformOptions turns{.input_steps = 3};

const auto pose = [](const auto& x) { return std::array{x.x, x.y, x.yaw}; };

InputBounds within(double low, double high) {
  InputBounds bounds(1);
  bounds.low = {low};
  bounds.high = {high};
  return bounds;
}

/// A law of the robot in the dead end.
CUniform<DeadEnd> turning(const CUniformOptions& options = turns) {
  return CUniform(DeadEnd{}, steps, within(-2, 2), {0, 0, 0}, pose, pose_cells, options);
}

/// A point on a line that the input moves, as `Function` says: next(x, u, k).
template <class Function>
struct Line {
  template <class T>
  struct State {
    T x;
  };
  static constexpr int inputs = 1;
  Function next;

  template <class T>
  State<T> step(const State<T>& x, const Input<T, 1>& u, int k) const {
    return {next(x.x, u[0], k)};
  }
  template <class T>
  T stage_cost(const State<T>& x, const Input<T, 1>&) const {
    return x.x;
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return x.x;
  }
};

/// A law of a point on a line.
template <class Function>
auto on_line(Function next, int horizon, const CellAxis (&axes)[1], const CUniformOptions& options,
             double start = 0) {
  return CUniform(
      Line<Function>{next}, horizon, within(-1, 1), {start}, [](const auto& x) { return std::array{x.x}; },
      axes, options);
}

const auto walk = [](auto x, auto u, int) { return x + u; };

TEST(CUniform, ARandomWalkFollowsTheClosedForm) {
  // Of t steps to either side, i went right: uniform over t + 2 places if the next goes right with the
  // probability (i + 1) / (t + 2).
  const auto law = on_line(walk, 12, {{1}}, {.input_steps = 1, .input_values = 2, .sweeps = 10000});
  for (int t = 0; t < 12; ++t) {
    ASSERT_EQ(law.law().cells(t), t + 1);
    for (int i = 0; i <= t; ++i)
      EXPECT_NEAR(static_cast<double>(law.law().probabilities(t, i)[1]), (i + 1.0) / (t + 2), 0.002) << t;
  }
  for (const double mass : law.law().masses(12)) EXPECT_NEAR(mass, 1.0 / 13, 0.001);
}

TEST(CUniform, ProbabilitiesSumToOneAndCarryTheMassesFromLevelToLevel) {
  const auto made = turning();
  const CUniformLaw& law = made.law();
  ASSERT_EQ(law.levels(), steps / 3);
  ASSERT_EQ(law.choices(), 5);
  for (int level = 0; level < law.levels(); ++level) {
    std::vector<double> carried(static_cast<std::size_t>(law.cells(level + 1)));
    for (int cell = 0; cell < law.cells(level); ++cell) {
      const auto chances = law.probabilities(level, cell);
      EXPECT_NEAR(std::accumulate(chances.begin(), chances.end(), 0.0), 1, 1e-6);
      for (int c = 0; c < law.choices(); ++c) {
        const auto chance = static_cast<double>(chances[static_cast<std::size_t>(c)]);
        EXPECT_GE(chance, 0);
        carried.at(static_cast<std::size_t>(law.next_cell(level, cell, c))) +=
            chance * law.masses(level)[static_cast<std::size_t>(cell)];
      }
    }
    const auto planned = law.masses(level + 1);
    EXPECT_NEAR(std::accumulate(planned.begin(), planned.end(), 0.0), 1, 1e-9);
    for (std::size_t i = 0; i < carried.size(); ++i) EXPECT_NEAR(carried[i], planned[i], 1e-6);
  }
}

/// How unevenly drives end: the total variation distance of their cells from the uniform distribution over
/// `cells` cells, and the entropy of the cells over its largest value.
struct Spread {
  double variation, entropy;
};
template <class Draw>
Spread spread_of(int cells, Draw draw) {
  constexpr int drives = 40000;
  std::map<std::array<int, 3>, int> ends;
  for (int i = 0; i < drives; ++i) {
    DeadEnd::State<double> x{0, 0, 0};
    for (const Input<double, 1>& u : draw()) x = DeadEnd{}.step(x, u);
    const double yaw = std::remainder(x.yaw, 2 * std::numbers::pi);
    ++ends[{static_cast<int>(std::lround(x.x / 0.2)), static_cast<int>(std::lround(x.y / 0.2)),
            static_cast<int>(std::lround(yaw / 0.4))}];
  }
  Spread spread{0, 0};
  for (const auto& [cell, count] : ends) {
    const double share = static_cast<double>(count) / drives;
    spread.variation += std::max(share - 1.0 / cells, 0.0);
    spread.entropy -= share * std::log(share) / std::log(cells);
  }
  return spread;
}

TEST(CUniform, DrivesEndMuchMoreEvenlyThanThoseOfUniformInputs) {
  auto law = turning();
  RandomStream random{{.seed = 1}};
  std::vector<Input<double, 1>> inputs(steps);
  const int cells = law.law().cells(law.law().levels());
  const Spread drawn = spread_of(cells, [&] { return law.draw(random); });
  const Spread uniform = spread_of(cells, [&]() -> std::span<const Input<double, 1>> {
    for (int k = 0; k < steps; ++k) {
      const auto at = static_cast<std::size_t>(k);
      inputs[at] = k % 3 > 0 ? inputs[at - 1] : Input<double, 1>{{std::floor(random.uniform(0, 5)) - 2}};
    }
    return inputs;
  });
  EXPECT_LT(drawn.variation, 0.75 * uniform.variation) << drawn.variation << " " << uniform.variation;
  EXPECT_GT(drawn.entropy, uniform.entropy + 0.05) << drawn.entropy << " " << uniform.entropy;
}

TEST(CUniform, MoreSweepsMakeTheMassesMoreEven) {
  const auto squares = [](int sweeps) {
    CUniformOptions options = turns;
    options.sweeps = sweeps;
    const auto law = turning(options);
    const auto masses = law.law().masses(law.law().levels());
    return std::inner_product(masses.begin(), masses.end(), masses.begin(), 0.0);
  };
  EXPECT_LT(squares(100), 0.85 * squares(0));
}

TEST(CUniform, SequencesAreWithinTheBoundsAndHoldTheirInputs) {
  auto law = CUniform(DeadEnd{}, 10, within(-0.7, 1.9), {0, 0, 0}, pose, pose_cells,
                      {.input_steps = 4, .input_values = 4});
  RandomStream random{{.seed = 2}};
  std::map<double, int> seen;
  for (int i = 0; i < 200; ++i) {
    const auto u = law.draw(random);
    ASSERT_EQ(u.size(), 10u);
    for (std::size_t k = 0; k < u.size(); ++k) {
      EXPECT_GE(u[k][0], -0.7);
      EXPECT_LE(u[k][0], 1.9);
      EXPECT_EQ(u[k][0], u[k / 4 * 4][0]) << k;
    }
    ++seen[u[0][0]];
  }
  EXPECT_EQ(law.law().levels(), 3) << "the last input is held for two steps";
  EXPECT_EQ(seen.size(), 4u) << "every value is drawn";
  EXPECT_EQ(seen.begin()->first, -0.7);
  EXPECT_EQ(seen.rbegin()->first, 1.9);
}

TEST(CUniform, TheSameSeedDrawsTheSameBits) {
  auto law = turning(), again = turning();
  RandomStream one{{.seed = 3}}, same{{.seed = 3}}, other{{.seed = 4}};
  int different = 0;
  for (int i = 0; i < 50; ++i) {
    const auto a = law.draw(one), b = again.draw(same);
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), [](auto& u, auto& v) { return u[0] == v[0]; }));
    const auto c = again.draw(other);
    different += !std::equal(a.begin(), a.end(), c.begin(), [](auto& u, auto& v) { return u[0] == v[0]; });
  }
  EXPECT_GT(different, 40);
}

TEST(CUniform, DrawingAllocatesNothing) {
  const Mppi controller{DeadEnd{}, {.horizon = steps}};
  CUniform law{controller, {0, 0, 0}, pose, pose_cells, turns};
  Proposals proposals{controller, 32};
  RandomStream random{{.seed = 5}};
  const long before = testing::allocations();
  ASSERT_GT(before, 0) << "nothing is counted";
  while (proposals.size() < 32) proposals.add(law.draw(random));
  EXPECT_EQ(testing::allocations(), before);
}

TEST(CUniform, BothEndsOfAPeriodAreOneCell) {
  const auto law = on_line(walk, 8, {{0.9, 4}}, {.input_steps = 1, .input_values = 3});
  EXPECT_EQ(law.law().cells(8), 4) << "a cell becomes 1, of which four fit";
  for (const double mass : law.law().masses(8)) EXPECT_NEAR(mass, 0.25, 0.001);
}

TEST(CUniform, CellsLieAroundTheStart) {
  const auto law = on_line(walk, 3, {{1}}, {.input_steps = 1, .input_values = 3}, 100.49);
  EXPECT_EQ(law.law().cells(3), 7);
}

TEST(CUniform, StepsKnowTheirPlaceInTheHorizon) {
  const auto later = [](auto x, auto u, int k) { return k < 4 ? x : x + u; };
  const auto law = on_line(later, 6, {{1}}, {.input_steps = 2, .input_values = 2});
  EXPECT_EQ(law.law().cells(1), 1);
  EXPECT_EQ(law.law().cells(2), 1);
  EXPECT_EQ(law.law().cells(3), 2);
}

TEST(CUniform, InputsThatLeadToNoFiniteStateAreNotDrawn) {
  const auto cliff = [](auto x, auto u, int) { return x + sqrt(u); };
  auto law = on_line(cliff, 4, {{0.5}}, {.input_steps = 1, .input_values = 5});
  EXPECT_EQ(law.law().next_cell(0, 0, 0), -1);
  EXPECT_EQ(law.law().probabilities(0, 0)[0], 0.0f);
  RandomStream random{{.seed = 6}};
  for (int i = 0; i < 200; ++i)
    for (const auto& u : law.draw(random)) EXPECT_GE(u[0], 0);
}

TEST(CUniform, MistakesNameTheRule) {
  const auto message = [](auto make) {
    try {
      make();
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  const auto line = [&](const CellAxis(&axes)[1], const CUniformOptions& options, double start = 0) {
    return message([&] { on_line(walk, 4, axes, options, start); });
  };
  EXPECT_EQ(line({{0}}, {}), "c_uniform: the size 0 of a cell must be above 0 and finite");
  EXPECT_EQ(line({{std::numeric_limits<double>::quiet_NaN()}}, {}),
            "c_uniform: the size .nan of a cell must be above 0 and finite");
  EXPECT_EQ(line({{1, 0.5}}, {}),
            "c_uniform: the period 0.5 of an axis must be 0, or finite and at least 1, the size of a cell");
  EXPECT_EQ(line({{1}}, {}, std::numeric_limits<double>::infinity()), "c_uniform: the start must be finite");
  EXPECT_EQ(line({{1}}, {.input_steps = 0}), "c_uniform.input_steps: 0 must be in [1, 10000]");
  EXPECT_EQ(line({{1}}, {.input_values = {2, 2}}), "c_uniform.input_values: has 2 values, must have one");
  EXPECT_EQ(line({{1}}, {.input_values = 2.5}), "c_uniform: input_values 2.5 must be a whole number");
  EXPECT_EQ(
      line({{1}}, {.input_steps = 1, .input_values = 3, .cells = 8}),
      "c_uniform: there are more than 8 cells up to level 2 of 4, must be fewer: with larger cells, fewer "
      "input values, a longer input_steps or a shorter horizon");
  EXPECT_EQ(message([&] {
              CUniform(DeadEnd{}, 0, within(-1, 1), {0, 0, 0}, pose, pose_cells);
            }),
            "c_uniform: the horizon 0 must be in [1, 10000]");
  EXPECT_EQ(message([&] {
              CUniform(DeadEnd{}, 4, InputBounds(1), {0, 0, 0}, pose, pose_cells);
            }),
            "c_uniform: input 0 has the bounds -.inf and .inf, must have finite ones, the lower first");
  EXPECT_EQ(message([&] {
              const auto nowhere = [](auto x, auto, int k) { return k < 1 ? x : x / decltype(x)(0); };
              on_line(nowhere, 4, {{1}}, {.input_steps = 1});
            }),
            "c_uniform: no input leads from a cell of level 1 to a finite state");
}

/// In how many of ten runs the robot gets out of the dead end; with C-Uniform proposals or without.
int gets_out(bool with_law, double variance) {
  int out = 0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    Mppi controller{DeadEnd{},
                    {.horizon = steps,
                     .samples = with_law ? 255 : 512,
                     .temperature = 1,
                     .variance = variance,
                     .control_cost_discount = 1,
                     .nominal_from_proposals = with_law,
                     .seed = seed}};
    CUniform law{controller, {0, 0, 0}, pose, pose_cells, turns};
    Proposals proposals{controller, 256};
    RandomStream random{{.seed = seed}};
    DeadEnd::State<double> x{0, 0, 0};
    const DeadEnd& robot = controller.problem();
    for (int k = 0; k < 60 && !robot.collides(x) && x.x > -2; ++k) {
      proposals.clear();
      while (with_law && proposals.size() < 256) proposals.add(law.draw(random));
      x = robot.step(x, controller.solve(x, {.elapsed = robot.dt, .proposals = proposals}).inputs[0]);
    }
    out += !robot.collides(x) && x.x <= -2;
  }
  return out;
}

TEST(CUniform, MppiTurnsRoundInADeadEndWithItAndNotWithoutIt) {
  for (const double variance : {0.25, 4.0}) {
    EXPECT_LE(gets_out(false, variance), 1) << variance;
    EXPECT_GE(gets_out(true, variance), 9) << variance;
  }
}

}  // namespace
}  // namespace slalom
