#include <numbers>

#include "slalom/problems/arm.hpp"
#include "slalom/problems/car.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"
#include "task.hpp"

namespace slalom::suite {

namespace {

using namespace problems;

constexpr int swing_steps = 300, flight_steps = 160, drive_steps = 200, reach_steps = 160;

Verdict pendulum(const Pendulum&, const Pendulum::State<double>& x, int k) {
  return at_end(k, swing_steps, std::cos(x.angle) > 0.99 && std::abs(x.rate) < 0.5);
}

Verdict cart_pole(const CartPole& p, const CartPole::State<double>& x, int k) {
  if (std::abs(x.position) > p.track) return Verdict::failed;
  return at_end(k, swing_steps, std::cos(x.angle) > 0.99 && std::abs(x.rate) < 0.5);
}

Verdict robot(const DifferentialDrive& p, const DifferentialDrive::State<double>& x, int) {
  return reached(p.place_cost(x).collided, p.distance(x) < 0.3);
}

Verdict quadrotor(const Quadrotor& p, const Quadrotor::State<double>& x, int k) {
  return p.hits_wall(x) ? Verdict::failed : at_end(k, flight_steps, p.distance(x) < 1);
}

Verdict car(const Car& p, const Car::State<double>& x, int k) {
  if (p.hits(x)) return Verdict::failed;
  return at_end(k, drive_steps, std::abs(x.x - p.stop_x) < 1 && x.speed < 0.5);
}

Verdict arm(const Arm& p, const Arm::State<double>& x, int) {
  const auto posture = p.posture(x);
  return reached(p.collides(posture), p.distance(posture) < 0.05);
}

}  // namespace

void add_example_tasks(std::vector<Task>& tasks) {
  const double down = std::numbers::pi;
  add(tasks, "pendulum", Ways::one, 60, {{-5, 5}}, closed_loop(Pendulum{}, {down, 0}, swing_steps, pendulum));
  add(tasks, "cart_pole", Ways::one, 60, {{-10, 10}},
      closed_loop(CartPole{}, {0, 0, down, 0}, swing_steps, cart_pole));
  add(tasks, "two_ways_round", Ways::several, 25, {{0, 1.5}, {-2, 2}},
      closed_loop(DifferentialDrive{}, {0, 0, 0}, 120, robot));
  add(tasks, "quadrotor_gaps", Ways::several, 40, {{-6, 6}, {-20, 20}},
      closed_loop(Quadrotor{}, {0, 0, 0, 0, 0, 0}, flight_steps, quadrotor));
  add(tasks, "parked_cars", Ways::several, 30, {{-0.5, 0.5}, {-6, 3}},
      closed_loop(Car{}, {0, 0, 0, 5}, drive_steps, car));
  add(tasks, "arm_past_ball", Ways::several, 20, joint_rates(),
      closed_loop(Arm{}, arm_start(), reach_steps, arm));
}

}  // namespace slalom::suite
