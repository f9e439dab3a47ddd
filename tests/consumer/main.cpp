// A project outside slalom's tree: its own problem, in its own file, solved with the installed library.
#include <cmath>
#include <cstdio>

#include <slalom/core/dispatch.hpp>
#include <slalom/slalom.hpp>

double second_unit_cost();

/// A puck on ice: two inputs, and a round hole in the way.
struct Puck {
  template <class T>
  struct State {
    T x, y, vx, vy;  // m, m/s
  };
  static constexpr int inputs = 2;  // accelerations, m/s^2
  double dt = 0.05;                 // s
  double hole_x = 1, hole_y = 0.05, radius = 0.4;

  template <class T>
  State<T> step(const State<T>& s, const slalom::Input<T, 2>& u) const {
    const T vx = s.vx + T(dt) * u[0], vy = s.vy + T(dt) * u[1];
    return {s.x + T(dt) * vx, s.y + T(dt) * vy, vx, vy};
  }
  template <class T>
  slalom::Cost<T> stage_cost(const State<T>& s, const slalom::Input<T, 2>& u) const {
    const auto in_hole = square(s.x - T(hole_x)) + square(s.y - T(hole_y)) < T(radius * radius);
    const T distance = square(s.x - T(2)) + square(s.y);
    const T effort = T(0.02) * (u[0] * u[0] + u[1] * u[1]);
    return {distance + T(0.1) * (s.vx * s.vx + s.vy * s.vy) + effort + slalom::select(in_hole, T(100), T(0)),
            in_hole};
  }
  template <class T>
  slalom::Cost<T> terminal_cost(const State<T>& s) const {
    const auto last = stage_cost(s, slalom::Input<T, 2>{{T(0), T(0)}});
    return {T(10) * last.value, last.collided};
  }

  template <class T>
  static T square(const T& v) {
    return v * v;
  }
};

int main() {
  using slalom::simd::Target;
  const char* asked = std::getenv("SLALOM_TARGET");
  for (const Target target : {Target::sse4, Target::avx2, Target::avx512}) {
    if (asked && std::string(asked) == name(target) && !supported(target)) {
      std::printf("this processor has no %s\n", asked);
      return 77;
    }
  }

  slalom::SvgMppi controller{Puck{},
                             {.horizon = 30,
                              .temperature = 0.3,
                              .input_min = {-3},
                              .input_max = {3},
                              .variance_min = 0.5,
                              .variance_max = 2,
                              .seed = 7}};
  Puck::State<double> x{0, 0, 0, 0};
  bool fell = false;
  for (int k = 0; k < 120; ++k) {
    const auto plan = controller.solve(x, {.elapsed = controller.problem().dt});
    if (plan.status != slalom::Status::ok) return 1;
    x = controller.problem().step(x, plan.inputs[0]);
    fell = fell || std::hypot(x.x - 1, x.y - 0.05) < 0.4;
  }
  const double left = std::hypot(x.x - 2, x.y);
  std::printf("slalom %s, %s: %.3f m from the goal, %s\n", slalom::version(),
              name(slalom::simd::active_target()), left, fell ? "through the hole" : "round the hole");
  return left < 0.3 && !fell && second_unit_cost() > 0 ? 0 : 1;
}
