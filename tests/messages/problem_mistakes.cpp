// A problem with at most one mistake: compiled with MISTAKE=0 it is right, otherwise the compiler must say
// what is wrong.
#include <array>
#include <cmath>

#include "slalom/slalom.hpp"

struct Point {
#if MISTAKE != 1
  template <class T>
  struct State {
    T position;
#if MISTAKE == 3
    int count;
#endif
  };
#endif
#if MISTAKE != 2
  static constexpr int inputs = 1;
#endif
#if MISTAKE == 9
  float input_min[1] = {-1};
#elif MISTAKE == 10
  double input_rate_max = 1;
#elif MISTAKE == 20
  double input_levels = 3;
#elif MISTAKE == 19
  double NEAR_NAME = 0.1;
#endif
#if MISTAKE == 4
  State<double> step(const State<double>& x, const slalom::Input<double, 1>& u) const {
    return {x.position + u[0]};
  }
#elif MISTAKE == 5
  template <class T>
  T step(const State<T>& x, const slalom::Input<T, 1>& u) const {
    return x.position + u[0];
  }
#elif MISTAKE == 6
  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 1>& u) {
    return {x.position + u[0]};
  }
#elif MISTAKE == 17
  State<double> step(const State<double>& x, const slalom::Input<double, 1>& u) const {
    return {x.position + u[0]};
  }
  State<float> step(const State<float>& x, const slalom::Input<float, 1>& u) const {
    return {x.position + u[0]};
  }
  template <class Target>
  State<slalom::Pack<Target> > step(const State<slalom::Pack<Target> >& x,
                                    const slalom::Input<slalom::Pack<Target>, 1>& u) const {
    return {x.position + u[0]};
  }
#elif MISTAKE != 1
  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 1>& u) const {
    return {x.position + u[0]};
  }
#endif
#if MISTAKE == 11 || MISTAKE == 12
#if MISTAKE == 12
  static constexpr std::array cost_names{"position", "speed", "effort"};
#endif
  template <class T>
  slalom::CostTerms<T, 2> stage_cost(const State<T>& x, const slalom::Input<T, 1>& u) const {
    return {{x.position * x.position, u[0] * u[0]}};
  }
#elif MISTAKE != 7 && MISTAKE != 1
  template <class T>
  T stage_cost(const State<T>& x, const slalom::Input<T, 1>&) const {
    return x.position * x.position;
  }
#endif
#if MISTAKE == 8
  template <class T>
  T terminal_cost(const State<T>& x) {
    return x.position;
  }
#elif MISTAKE != 1 && MISTAKE != 19
  template <class T>
  T terminal_cost(const State<T>& x) const {
#if MISTAKE == 13
    if (x.position > 0) return x.position;
#elif MISTAKE == 14
    return x.position != 0 ? x.position : -x.position;
#elif MISTAKE == 15
    return std::sin(x.position);
#elif MISTAKE == 16
    const double position = x.position;
    return T(position);
#elif MISTAKE == 21
    const bool far = x.position > T(2);
    return T(far);
#elif MISTAKE == 22
    const double table[2] = {1, 2};
    return T(table[int(x.position)]);
#elif MISTAKE == 23
    const auto both = slalom::sin_cos(x.position);
#endif
    return x.position * x.position;
  }
#endif
};

int main() {
#if MISTAKE == 18
  slalom::Mppi controller{Point{}, slalom::MppiOptions{.horizn = 5}};
#else
  slalom::Mppi controller{Point{}, {.horizon = 5}};
#endif
#if MISTAKE == 0 || MISTAKE == 17
  if (slalom::linearize(controller.problem(), {1}, {{2}}).next.position != 3) return 1;
#endif
  return controller.solver().horizon() == 5 ? 0 : 1;
}
