// The comparison of Vlahov et al., "MPPI-Generic: A CUDA Library for Stochastic Trajectory Optimization"
// (2024): a differential-drive robot crosses a map with three discs; T = 100, dt = 0.02 s, K = 2^7 ... 2^14.
// Prints the mean time of a cycle (one solve) over a whole drive on one core, and the mean of each term of
// the cost. Exits with status 1 if a term is zero, since the measurement is then meaningless. Published means
// at K = 2048: 0.146 ms (RTX 4090), 0.84 ms (GTX 1050 Ti), 1.65 ms (Orin Nano); nav2's controller on the
// processor 6.7 ms (i9-13900K), 9.5 ms (Ryzen 5600X).
//   slalom_navigation_bench [cycles]

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "bench/workload/statistics.hpp"
#include "slalom/core/grid_view.hpp"
#include "slalom/core/problem_evaluator.hpp"
#include "slalom/solvers/mppi_options.hpp"

namespace slalom {
namespace {

struct Disc {
  double x, y, radius;  // m
};
constexpr Disc discs[] = {{8, 8, 0.4}, {4, 6, 0.5}, {6, 5, 0.3}};
constexpr double disc_cost = 250;

/// Costs in cells of 0.1 m over 11 x 11 m, with a border of zeros for positions outside.
class CostMap {
 public:
  CostMap() : cells_(static_cast<std::size_t>(rows + 2) << stride_log2) {
    for (int row = 1; row <= rows; ++row) {
      for (int column = 1; column <= rows; ++column) {
        const double x = length - (row - 0.5) * resolution, y = length - (column - 0.5) * resolution;
        for (const Disc& d : discs) {
          if (std::hypot(x - d.x, y - d.y) < d.radius)
            cells_[static_cast<std::size_t>((row << stride_log2) + column)] = static_cast<float>(disc_cost);
        }
      }
    }
  }
  GridView<1> view() const {
    return {cells_.data(), rows, rows, stride_log2, resolution, length / 2, length / 2};
  }

 private:
  static constexpr double length = 11, resolution = 0.1;  // m
  static constexpr int rows = 110, stride_log2 = 7;
  std::vector<float> cells_;
};

struct Navigation {
  template <class T>
  struct State {
    T x, y, yaw;  // m, m, rad
  };
  static constexpr int inputs = 2;  // speed, m/s; yaw rate, rad/s
  static constexpr const char* cost_names[] = {"goal_x", "goal_y", "goal_yaw", "discs"};
  double dt = 0.02;  // s
  double goal_x = 10, goal_y = 10, goal_yaw = 0;
  double weight_x = 5, weight_y = 5, weight_yaw = 20;
  GridView<1> map;

  template <class T>
  T look_up(const State<T>& s) const {
    return slalom::look_up(map, s.x, s.y);
  }
  template <class T>
  State<T> step(const State<T>& s, const T&, const Input<T, 2>& u) const {
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    const T travelled = u[0] * T(dt);
    return {s.x + travelled * cosine, s.y + travelled * sine, s.yaw + u[1] * T(dt)};
  }
  template <class T>
  CostTerms<T, 4> stage_cost(const State<T>& s, const T& disc, const Input<T, 2>&) const {
    return cost(s, disc);
  }
  template <class T>
  CostTerms<T, 4> terminal_cost(const State<T>& s, const T& disc) const {
    return cost(s, disc);
  }

 private:
  template <class T>
  CostTerms<T, 4> cost(const State<T>& s, const T& disc) const {
    return {{T(weight_x) * square(s.x - T(goal_x)), T(weight_y) * square(s.y - T(goal_y)),
             T(weight_yaw) * square(wrap_angle(s.yaw - T(goal_yaw))), disc},
            disc > T(0)};
  }
};

MppiOptions options_for(int samples) {
  MppiOptions o;
  o.horizon = 100;
  o.samples = samples;
  o.temperature = 1;
  o.variance = 0.2 * 0.2;
  o.input_min = {-0.35, -0.5};
  o.input_max = {0.5, 0.5};
  return o;
}

/// Drives half of the cycles from the start of the comparison, where there is no disc for some seconds, and
/// half from a position before the disc at (8, 8). Prints the result and returns whether no term of the cost
/// was zero.
bool drive(int samples, int cycles) {
  const CostMap map;
  Navigation problem;
  problem.map = map.view();
  ProblemEvaluator<Navigation> evaluator(problem);
  const auto solver = make_solver(options_for(samples), Navigation::inputs);
  Navigation::State<double> x{1, 1, 0};
  std::vector<double> times;
  std::array<double, 4> terms{};
  double collided = 0, sum = 0;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    if (cycle == cycles / 2) x = {7.4, 7.4, std::atan2(1, 1)};
    evaluator.set_state(x);
    const auto begin = std::chrono::steady_clock::now();
    const SolveResult& result = solver->solve(evaluator, {.elapsed = problem.dt});
    times.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    sum += times.back();
    collided += result.collided_share;
    const Input<double, 2> u{{static_cast<double>(result.inputs[0]), static_cast<double>(result.inputs[1])}};
    const double disc = problem.look_up(x);
    const CostTerms<double, 4> cost = problem.stage_cost(x, disc, u);
    for (std::size_t i = 0; i < 3; ++i) terms[i] += cost.value[i];
    x = problem.step(x, disc, u);
  }
  terms[3] = disc_cost * collided;  // of the samples that collided: the robot itself should not
  const workload::TimeStatistics t = workload::time_statistics(times);
  const double cycle_ns = 1e6 * t.p50 / (static_cast<double>(samples) * 100);
  std::printf("K %6d  mean %.3f ms, p50 %.3f, min %.3f, max %.3f; %.2f ns a rollout step; terms", samples,
              sum / cycles, t.p50, t.min, t.max, cycle_ns);
  bool all = true;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    std::printf(" %s %.3g", Navigation::cost_names[i], terms[i]);
    all = all && terms[i] > 0;
  }
  std::printf("%s\n", all ? "" : ": ONE IS ZERO");
  return all;
}

}  // namespace
}  // namespace slalom

int main(int count, char** arguments) {
  const int cycles = count > 1 ? static_cast<int>(std::strtol(arguments[1], nullptr, 10)) : 400;
  bool all = true;
  for (int samples = 128; samples <= 16384; samples *= 2) all = slalom::drive(samples, cycles) && all;
  return all ? 0 : 1;
}
