
#include "slalom/problems/arm.hpp"
#include "task.hpp"

namespace slalom::suite {

namespace {

/// A car that backs into a space between two parked cars. The bodies are taken as three discs each.
struct Parking {
  template <class T>
  struct State {
    T x, y, yaw;  // m, m, rad, of the rear axle
  };
  static constexpr int inputs = 2;           // speed, m/s; curvature of the path, 1/m
  double dt = 0.15;                          // s
  double half_width = 0.95;                  // m, radius of the discs
  double kerb = -3.4;                        // m, y of the kerb
  double space_from = -1.6, space_to = 5.6;  // m, the free length along the kerb
  double parked_y = -1.3;                    // m, upper edge of the parked cars
  double goal_x = 0.4, goal_y = -2.4;        // m

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    const T way = T(dt) * u[0];
    return {s.x + way * cosine, s.y + way * sine, s.yaw + way * u[1]};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    const mask_t<T> hit = collides(s);
    return {T(dt) * (offset(s) + T(0.05) * u[0] * u[0] + T(0.2) * u[1] * u[1]) + select(hit, T(50), T(0)),
            hit};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(6) * offset(s);
  }
  /// The distance from the goal, with 2 m for each squared radian of the yaw angle.
  template <class T>
  T offset(const State<T>& s) const {
    return sqrt(square(s.x - T(goal_x)) + square(s.y - T(goal_y)) + T(1e-4)) + T(2) * square(s.yaw);
  }
  template <class T>
  mask_t<T> collides(const State<T>& s) const {
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    mask_t<T> hit(false);
    for (const double ahead : {0.0, 1.3, 2.6}) {
      const T x = s.x + T(ahead) * cosine, y = s.y + T(ahead) * sine;
      // To the nearer of the parked cars, each of which fills a quarter of the plane.
      const T beside = max(min(x - T(space_from), T(space_to) - x), T(0)), above = max(y - T(parked_y), T(0));
      hit = hit | (y < T(kerb + half_width)) | (square(beside) + square(above) < T(half_width * half_width));
    }
    return hit;
  }
};

/// A round robot in a corridor with two bends, little wider than itself.
struct Corridor : PointMass {
  double half_width = 0.25;  // m, free way of the robot's centre
  double rise = 2;           // m, sideways between the bends

  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    const mask_t<T> hit = collides(s);
    return {T(dt) * (T(3) * way_left(s) + T(0.02) * (u[0] * u[0] + u[1] * u[1])) + select(hit, T(50), T(0)),
            hit};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(4) * way_left(s) + T(0.3) * (square(s.speed_x) + square(s.speed_y));
  }
  /// Length of the way along the corridor to its end at (4, rise): along x, then along y, then along x.
  template <class T>
  T way_left(const State<T>& s) const {
    return abs(T(4) - s.x) + abs(T(rise) - s.y);
  }
  /// Outside the three parts of the corridor.
  template <class T>
  mask_t<T> collides(const State<T>& s) const {
    const mask_t<T> first = (abs(s.y) < T(half_width)) & (s.x < T(2 + half_width));
    const mask_t<T> middle =
        (abs(s.x - T(2)) < T(half_width)) & (s.y > T(-half_width)) & (s.y < T(rise + half_width));
    const mask_t<T> last = (abs(s.y - T(rise)) < T(half_width)) & (s.x > T(2 - half_width));
    return !(first | middle | last);
  }
};

/// The arm of the examples among three balls: the hand goes between them.
struct ArmAmongBalls : problems::Arm {
  std::array<double, 3> centre_x{0.5, 0.35, 0.0}, centre_y{0, -0.15, -0.45}, centre_z{0.4, 0.95, 0.6};  // m
  std::array<double, 3> radius{0.15, 0.1, 0.12};                                                        // m

  template <class T>
  CostTerms<T, 3> stage_cost(const State<T>& x, const Input<T, joints>& u) const {
    const Posture<T> arm = posture(x);
    const mask_t<T> hit = collides_with_any(arm);
    T effort(0);
    for (int i = 0; i < joints; ++i) effort = effort + u[i] * u[i];
    return {{T(dt * 40) * distance(arm), T(dt * 0.05) * effort, select(hit, T(100), T(0))}, hit};
  }
  template <class T>
  CostTerms<T, 3> terminal_cost(const State<T>& x) const {
    const Posture<T> arm = posture(x);
    const mask_t<T> hit = collides_with_any(arm);
    return {{T(60) * distance(arm), T(0), select(hit, T(100), T(0))}, hit};
  }
  template <class T>
  SLALOM_INLINE_CALLS mask_t<T> collides_with_any(const Posture<T>& arm) const {
    mask_t<T> hit(false);
    for (std::size_t i = 0; i < radius.size(); ++i) {
      Arm one{.ball_x = centre_x[i], .ball_y = centre_y[i], .ball_z = centre_z[i], .ball_radius = radius[i]};
      hit = hit | one.collides(arm);
    }
    return hit;
  }
};

}  // namespace

void add_narrow_tasks(std::vector<Task>& tasks) {
  add(tasks, "parking", Ways::one, 40, {{-2, 2}, {-0.2, 0.2}},
      closed_loop(Parking{}, {6.5, 0.9, 0}, 120, [](const auto& p, const auto& s, int) {
        return reached(p.collides(s), p.offset(s) < 0.25);
      }));
  add(tasks, "corridor", Ways::one, 30, {{-2, 2}, {-2, 2}},
      closed_loop(Corridor{}, {0, 0, 0, 0}, 100, [](const auto& p, const auto& s, int) {
        return reached(p.collides(s), p.way_left(s) < 0.3);
      }));
  add(tasks, "arm_among_balls", Ways::several, 20, joint_rates(),
      closed_loop(ArmAmongBalls{}, arm_start(), 160, [](const auto& p, const auto& x, int) {
        const auto posture = p.posture(x);
        return reached(p.collides_with_any(posture), p.distance(posture) < 0.05);
      }));
}

}  // namespace slalom::suite
