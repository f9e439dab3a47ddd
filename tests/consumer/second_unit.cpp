// A second translation unit with the same headers and another problem: both link.
#include <slalom/slalom.hpp>

namespace {

struct Decay {
  template <class T>
  struct State {
    T level;
  };
  static constexpr int inputs = 1;

  template <class T>
  State<T> step(const State<T>& s, const slalom::Input<T, 1>& u) const {
    return {T(0.9) * s.level + u[0]};
  }
  template <class T>
  T stage_cost(const State<T>& s, const slalom::Input<T, 1>&) const {
    return s.level * s.level;
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return s.level * s.level;
  }
};

}  // namespace

double second_unit_cost() {
  slalom::Mppi controller{Decay{}, {.horizon = 10, .samples = 64}};
  return controller.solve({1.0}).cost;
}
