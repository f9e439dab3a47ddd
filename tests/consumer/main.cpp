// A project outside slalom's tree: its own problem, in its own file, solved with the installed library.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <slalom/core/dispatch.hpp>
#include <slalom/slalom.hpp>

double second_unit_cost();

/// A puck on ice that is pushed to the origin.
struct Puck {
  template <class T>
  struct State {
    T x, speed;  // m, m/s
  };
  static constexpr int inputs = 1;  // m/s^2
  double dt = 0.05;                 // s

  template <class T>
  State<T> step(const State<T>& s, const slalom::Input<T, 1>& u) const {
    const T speed = s.speed + T(dt) * u[0];
    return {s.x + T(dt) * speed, speed};
  }
  template <class T>
  T stage_cost(const State<T>& s, const slalom::Input<T, 1>& u) const {
    return s.x * s.x + T(0.1) * s.speed * s.speed + T(0.02) * u[0] * u[0];
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(10) * s.x * s.x;
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
  Puck::State<double> x{2, 0};
  for (int k = 0; k < 120; ++k) {
    const auto plan = controller.solve(x, {.elapsed = controller.problem().dt});
    if (plan.status != slalom::Status::ok) return 1;
    x = controller.problem().step(x, plan.inputs[0]);
  }
  std::printf("slalom %s, %s: %.3f m from the goal\n", slalom::version(), name(slalom::simd::active_target()),
              std::abs(x.x));
  return std::abs(x.x) < 0.1 && second_unit_cost() > 0 ? 0 : 1;
}
