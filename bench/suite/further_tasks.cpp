#include <numbers>

#include "task.hpp"

namespace slalom::suite {

namespace {

/// A trolley that carries a load on a rope; it must arrive without swinging.
struct Crane {
  template <class T>
  struct State {
    T x, speed, angle, rate;  // m, m/s, rad, rad/s
  };
  static constexpr int inputs = 1;      // m/s^2, of the trolley
  double dt = 0.1, rope = 4, goal = 8;  // s, m, m

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    const T rate = s.rate - T(dt / rope) * (T(9.81) * sin(s.angle) + u[0] * cos(s.angle));
    const T speed = s.speed + T(dt) * u[0];
    return {s.x + T(dt) * speed, speed, s.angle + T(dt) * rate, rate};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 1>& u) const {
    return T(dt) * (abs(s.x - T(goal)) + T(4) * square(s.angle) + T(0.01) * square(u[0]));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(5) * abs(s.x - T(goal)) + T(5) * square(s.speed) + T(20) * (square(s.angle) + square(s.rate));
  }
};

/// A motor that turns an arm through a spring; the arm must come to rest.
struct FlexibleJoint {
  template <class T>
  struct State {
    T motor, arm, motor_rate, arm_rate;  // rad, rad/s
  };
  static constexpr int inputs = 1;          // rad/s^2, of the motor
  double dt = 0.04, spring = 20, goal = 2;  // s, 1/s^2, rad

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    const T twist = T(spring) * (s.motor - s.arm);
    const T motor_rate = s.motor_rate + T(dt) * (u[0] - twist), arm_rate = s.arm_rate + T(dt) * twist;
    return {s.motor + T(dt) * motor_rate, s.arm + T(dt) * arm_rate, motor_rate, arm_rate};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 1>& u) const {
    return T(dt) * (square(s.arm - T(goal)) + T(0.001) * square(u[0]));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return square(s.arm - T(goal)) + T(0.2) * (square(s.arm_rate) + square(s.motor - s.arm));
  }
};

/// A car in a valley, too weak to leave it without a swing (Moore 1990).
struct MountainCar {
  template <class T>
  struct State {
    T x, speed;
  };
  static constexpr int inputs = 1;
  double dt = 1, goal = 0.45;

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    const T speed = s.speed + T(0.0012) * u[0] - T(0.0025) * cos(T(3) * s.x);
    return {s.x + speed, speed};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 1>&) const {
    return max(T(goal) - s.x, T(0));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(20) * max(T(goal) - s.x, T(0));
  }
};

/// A vessel with thrust and rudder, without a side thruster, that comes alongside.
struct Vessel {
  template <class T>
  struct State {
    T x, y, yaw, ahead, aside, rate;  // m, m, rad, m/s, m/s, rad/s
  };
  static constexpr int inputs = 2;           // m/s^2, rad/s^2
  double dt = 0.2, goal_x = 10, goal_y = 4;  // s, m, m

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    T sine, cosine;
    sin_cos(s.yaw, sine, cosine);
    const T ahead = s.ahead + T(dt) * (u[0] + s.aside * s.rate - T(0.2) * s.ahead);
    const T aside = s.aside - T(dt) * (s.ahead * s.rate + T(0.8) * s.aside);
    const T rate = s.rate + T(dt) * (u[1] - T(0.5) * s.rate);
    return {s.x + T(dt) * (cosine * ahead - sine * aside),
            s.y + T(dt) * (sine * ahead + cosine * aside),
            s.yaw + T(dt) * rate,
            ahead,
            aside,
            rate};
  }
  template <class T>
  T stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    return T(dt) * (offset(s) + T(0.05) * (square(u[0]) + square(u[1])));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(5) * offset(s) + T(3) * (square(s.ahead) + square(s.rate));
  }
  /// The distance from the berth, with 2 m for each squared radian of the yaw angle.
  template <class T>
  T offset(const State<T>& s) const {
    return apart(s.x, s.y, goal_x, goal_y) + T(2) * square(s.yaw);
  }
};

/// A tractor that backs its trailer to a dock; a folded trailer is a collision.
struct Trailer {
  template <class T>
  struct State {
    T x, y, yaw, trailer;  // m, m, rad, rad
  };
  static constexpr int inputs = 2;   // m/s, 1/m
  double dt = 0.2, length = 3;       // s, m
  double goal_x = -8, goal_y = 1.5;  // m, of the trailer's axle

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    const T way = T(dt) * u[0];
    return {s.x + way * cos(s.yaw), s.y + way * sin(s.yaw), s.yaw + way * u[1],
            s.trailer + way * T(1 / length) * sin(s.yaw - s.trailer)};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    return step_cost(dt, offset(s), 0.1, u, folded(s));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(6) * offset(s);
  }
  /// The distance of the trailer's axle from the dock, with 2 m for each squared radian of its yaw angle.
  template <class T>
  T offset(const State<T>& s) const {
    return apart(s.x - T(length) * cos(s.trailer), s.y - T(length) * sin(s.trailer), goal_x, goal_y) +
           T(2) * square(s.trailer);
  }
  template <class T>
  mask_t<T> folded(const State<T>& s) const {
    return abs(s.yaw - s.trailer) > T(1.2);
  }
};

/// A vehicle that cannot stop passes one of two gaps in a wall, 0.8 m wide.
struct Gaps {
  template <class T>
  struct State {
    T x, y, yaw;  // m, m, rad
  };
  static constexpr int inputs = 1;  // rad/s
  double dt = 0.1, speed = 3;       // s, m/s

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 1>& u) const {
    return {s.x + T(dt * speed) * cos(s.yaw), s.y + T(dt * speed) * sin(s.yaw), s.yaw + T(dt) * u[0]};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 1>& u) const {
    return step_cost(dt, apart(s.x, s.y, 12, 0), 0.1, u, collides(s));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(3) * apart(s.x, s.y, 12, 0);
  }
  template <class T>
  mask_t<T> collides(const State<T>& s) const {
    const mask_t<T> at_wall = abs(s.x - T(6))<T(0.4), off_gaps = abs(abs(s.y) - T(2.2))> T(0.4);
    return at_wall & off_gaps;
  }
};

/// A boat crosses a river, whose current is strongest in the middle, past an island.
struct River {
  template <class T>
  struct State {
    T x, y;  // m
  };
  static constexpr int inputs = 2;  // m/s, relative to the water
  double dt = 0.2;                  // s

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    const T current = max(T(1) - square(s.y * T(0.25) - T(1)), T(0));
    return {s.x + T(dt) * (u[0] + current), s.y + T(dt) * u[1]};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    return step_cost(dt, apart(s.x, s.y, 0, 8), 0.1, u, collides(s));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(4) * apart(s.x, s.y, 0, 8);
  }
  template <class T>
  mask_t<T> collides(const State<T>& s) const {
    return square(s.x) + square(s.y - T(4)) < T(1.7 * 1.7);
  }
};

/// A robot crosses three lanes between cars, which drive at a distance of 6 m.
struct Crossing : PointMass {
  template <class T>
  struct State {
    T x, y, speed_x, speed_y, time;  // m, m/s, s
  };
  template <class T>
  State<T> step(const State<T>& s, const Input<T, 2>& u) const {
    const T speed_x = s.speed_x + T(dt) * u[0], speed_y = s.speed_y + T(dt) * u[1];
    return {s.x + T(dt) * speed_x, s.y + T(dt) * speed_y, speed_x, speed_y, s.time + T(dt)};
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    return step_cost(dt, apart(s.x, s.y, 0, 6), 0.02, u, collides(s));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(4) * apart(s.x, s.y, 0, 6) + T(0.3) * (square(s.speed_x) + square(s.speed_y));
  }
  template <class T>
  mask_t<T> collides(const State<T>& s) const {
    constexpr double wave = 2 * std::numbers::pi / 6;
    mask_t<T> hit(false);
    for (const double lane : {1.5, 3.0, 4.5}) {
      const T behind = s.x + T(lane == 3 ? 2.5 : -2) * s.time + T(lane);
      const mask_t<T> on_lane = abs(s.y - T(lane)) < T(0.6);
      const mask_t<T> one_passes = cos(T(wave) * behind) > T(std::cos(wave * 1.2));
      hit = hit | (on_lane & one_passes);
    }
    return hit;
  }
};

/// A mass point among nine discs in rows.
struct Forest : PointMass {
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 2>& u) const {
    return step_cost(dt, apart(s.x, s.y, 8, 0), 0.02, u, collides(s));
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(4) * apart(s.x, s.y, 8, 0) + T(0.3) * (square(s.speed_x) + square(s.speed_y));
  }
  template <class T>
  mask_t<T> collides(const State<T>& s) const {
    mask_t<T> hit(false);
    for (int i = 0; i < 9; ++i) {
      const double x = 2 + 2 * (i / 3), y = 1.7 * (i % 3 - 1) + (i / 3 == 1 ? 0.85 : 0);
      hit = hit | (square(s.x - T(x)) + square(s.y - T(y)) < T(0.6 * 0.6));
    }
    return hit;
  }
};

/// Three batteries share a supply, whose fuse heats up above its limit; each must be full at its own time.
struct Chargers {
  template <class T>
  struct State {
    T missing[3], heat, time;  // kWh, kW, h
  };
  static constexpr int inputs = 3;     // kW
  double dt = 0.25, limit = 1.2;       // h, kW
  std::array<double, 3> due{3, 6, 9};  // h

  template <class T>
  State<T> step(const State<T>& s, const Input<T, 3>& u) const {
    State<T> next = s;
    for (int i = 0; i < 3; ++i) next.missing[i] = max(s.missing[i] - T(dt) * u[i], T(0));
    next.heat = T(0.8) * s.heat + max(u[0] + u[1] + u[2] - T(limit), T(0));
    next.time = s.time + T(dt);
    return next;
  }
  template <class T>
  Cost<T> stage_cost(const State<T>& s, const Input<T, 3>& u) const {
    T cost = T(0.05) * (square(u[0]) + square(u[1]) + square(u[2]));
    for (std::size_t i = 0; i < 3; ++i) cost += s.missing[i] * select(s.time > T(due[i] - dt), T(20), T(0.2));
    const mask_t<T> hit = s.heat > T(0.5);
    return {T(dt) * cost + select(hit, T(50), T(0)), hit};
  }
  template <class T>
  T terminal_cost(const State<T>& s) const {
    return T(2) * (s.missing[0] + s.missing[1] + s.missing[2]);
  }
};

}  // namespace

void add_further_tasks(std::vector<Task>& tasks) {
  add(tasks, "crane", Ways::one, 40, {{-1.5, 1.5}},
      closed_loop(Crane{}, {0, 0, 0, 0}, 110, [](const auto& p, const auto& s, int k) {
        return at_end(k, 110, std::abs(s.x - p.goal) < 0.1 && std::hypot(s.angle, s.rate) < 0.05);
      }));
  add(tasks, "flexible_joint", Ways::one, 40, {{-8, 8}},
      closed_loop(FlexibleJoint{}, {0, 0, 0, 0}, 100, [](const auto& p, const auto& s, int k) {
        return at_end(k, 100, std::abs(s.arm - p.goal) < 0.05 && std::abs(s.arm_rate) < 0.2);
      }));
  add(tasks, "mountain_car", Ways::one, 80, {{-1, 1}},
      closed_loop(MountainCar{}, {-0.5, 0}, 200,
                  [](const auto& p, const auto& s, int) { return reached(s.x<-1.2, s.x> p.goal); }));
  add(tasks, "vessel", Ways::one, 40, {{-0.5, 0.5}, {-0.5, 0.5}},
      closed_loop(Vessel{}, {0, 0, 0, 0, 0, 0}, 120, [](const auto& p, const auto& s, int) {
        return reached(false, p.offset(s) < 0.4 && std::abs(s.ahead) < 0.3);
      }));
  add(tasks, "trailer", Ways::one, 40, {{-1.5, 1.5}, {-0.3, 0.3}},
      closed_loop(Trailer{}, {0, 0, 0, 0}, 150,
                  [](const auto& p, const auto& s, int) { return reached(p.folded(s), p.offset(s) < 0.3); }));
  add(tasks, "two_gaps", Ways::several, 30, {{-1.5, 1.5}},
      closed_loop(Gaps{}, {0, 0, 0}, 100,
                  [](const auto& p, const auto& s, int) { return reached(p.collides(s), s.x > 10); }));
  add(tasks, "river_island", Ways::several, 30, {{-1.3, 1.3}, {-1.3, 1.3}},
      closed_loop(River{}, {0, 0}, 100, [](const auto& p, const auto& s, int) {
        return reached(p.collides(s), apart(s.x, s.y, 0, 8) < 0.3);
      }));
  add(tasks, "crossing", Ways::several, 30, {{-2, 2}, {-2, 2}},
      closed_loop(Crossing{}, {0, 0, 0, 0, 0}, 120, [](const auto& p, const auto& s, int) {
        return reached(p.collides(s), apart(s.x, s.y, 0, 6) < 0.3);
      }));
  add(tasks, "forest", Ways::several, 30, {{-2, 2}, {-2, 2}},
      closed_loop(Forest{}, {0, 0, 0, 0}, 100, [](const auto& p, const auto& s, int) {
        return reached(p.collides(s), apart(s.x, s.y, 8, 0) < 0.3);
      }));
  add(tasks, "chargers", Ways::several, 30, std::vector<TaskInput>(3, {0, 1}),
      closed_loop(Chargers{}, {{2, 3, 4.2}, 0, 0}, 40, [](const auto& p, const auto& s, int k) {
        bool late = s.heat > 0.5;
        for (std::size_t i = 0; i < 3; ++i) late = late || (s.time > p.due[i] + 0.01 && s.missing[i] > 0.1);
        return late ? Verdict::failed : at_end(k, 40, true);
      }));
}

}  // namespace slalom::suite
