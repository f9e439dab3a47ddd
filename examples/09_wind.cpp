// A hovercraft passes a disc in gusts that nobody can predict. A controller that plans without wind passes
// close by, and is blown against the disc. One that rolls out every sample in the same nine winds keeps as
// far away as the gusts require.

#include <algorithm>
#include <array>
#include <cstdio>

#include <slalom/slalom.hpp>

constexpr int steps_of_plan = 10;  // that are driven until the next solve: a plan every 0.5 s

/// Acceleration by the wind, m/s^2: a steady part and a gust that comes and goes.
struct Wind {
  double steady = 0, sine = 0, cosine = 0;  // m/s^2
  double rate = 2;                          // rad/s

  template <class T>
  SLALOM_INLINE_CALLS T at(const T& time) const {
    T s, c;
    slalom::sin_cos(T(rate) * time, s, c);
    return T(steady) + T(sine) * s + T(cosine) * c;
  }
};

struct Hovercraft {
  template <class T>
  struct State {
    T x, y, speed_x, speed_y, time;  // m, m, m/s, m/s, s
  };
  static constexpr int inputs = 2;  // m/s^2 along x and y
  double dt = 0.05;                 // s
  double input_min = -3, input_max = 3;
  double goal_x = 6, goal_y = 0;    // m
  double disc_x = 3, disc_y = 0.3;  // m
  double clearance = 0.8;           // m, radius of the disc and of the hovercraft together
  double deviation = 0.5;           // m/s^2, of each part of the wind
  Wind wind_x, wind_y;              // what nobody knows

  template <class T>
  State<T> step(const State<T>& x, const slalom::Input<T, 2>& u) const {
    const T drag(0.2);  // 1/s
    const T speed_x = x.speed_x + T(dt) * (u[0] + wind_x.at(x.time) - drag * x.speed_x);
    const T speed_y = x.speed_y + T(dt) * (u[1] + wind_y.at(x.time) - drag * x.speed_y);
    return {x.x + T(dt) * speed_x, x.y + T(dt) * speed_y, speed_x, speed_y, x.time + T(dt)};
  }
  template <class T>
  slalom::Cost<T> stage_cost(const State<T>& x, const slalom::Input<T, 2>& u) const {
    const slalom::mask_t<T> hit = collides(x);
    return {T(dt) * (distance(x) + T(0.01) * (u[0] * u[0] + u[1] * u[1])) + slalom::select(hit, T(100), T(0)),
            hit};
  }
  template <class T>
  T terminal_cost(const State<T>& x) const {
    return T(5) * distance(x) + x.speed_x * x.speed_x + x.speed_y * x.speed_y;
  }
  /// Another wind.
  void randomize(slalom::RandomStream& random) noexcept {
    for (Wind* wind : {&wind_x, &wind_y}) {
      wind->steady = deviation * random.normal();
      wind->sine = deviation * random.normal();
      wind->cosine = deviation * random.normal();
    }
  }

  /// To the goal, m.
  template <class T>
  T distance(const State<T>& x) const {
    return slalom::hypot(x.x - T(goal_x), x.y - T(goal_y));
  }
  /// Whether it collides with the disc.
  template <class T>
  slalom::mask_t<T> collides(const State<T>& x) const {
    return slalom::hypot(x.x - T(disc_x), x.y - T(disc_y)) < T(clearance);
  }
};

/// Whether the hovercraft passes the disc within 8 s in a wind of its own, without a collision.
template <class Controller>
bool passes(Controller controller, std::uint64_t seed) {
  Hovercraft world;
  slalom::RandomStream random({1000 + seed, 0});
  world.randomize(random);
  Hovercraft::State<double> x{};
  std::array<slalom::Input<double, 2>, steps_of_plan> inputs;
  for (int k = 0; k < 160; ++k) {
    x.time = k * world.dt;
    if (k % steps_of_plan == 0) {
      const auto plan = controller.solve(x, {.elapsed = steps_of_plan * world.dt});
      std::copy_n(plan.inputs.begin(), inputs.size(), inputs.begin());
    }
    x = world.step(x, inputs[static_cast<std::size_t>(k % steps_of_plan)]);
    if (world.collides(x)) return false;
  }
  return x.x > world.disc_x + world.clearance;
}

int main() {
  const auto options = [](std::uint64_t seed) {
    return slalom::SvgMppiOptions{.horizon = 40, .samples = 1024, .temperature = 1, .seed = seed};
  };
  using Winds = slalom::RiskEvaluator<Hovercraft>;
  const slalom::RiskOptions nine_winds{.variants = 9, .measure = slalom::RiskMeasure::cvar};
  constexpr int runs = 100;
  int without = 0, with = 0;
  for (std::uint64_t seed = 0; seed < runs; ++seed) {
    without += passes(slalom::Controller<Hovercraft>{Hovercraft{}, options(seed)}, seed);
    with += passes(slalom::Controller<Winds>{Winds{Hovercraft{}, nine_winds}, options(seed)}, seed);
  }
  std::printf(
      "a hovercraft passes a disc in the wind: planned without wind %d of %d runs, in nine winds %d\n",
      without, runs, with);
  return with >= 90 && with >= without + 10 ? 0 : 1;
}
