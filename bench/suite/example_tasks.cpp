#include <cmath>
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

/// Solved if a condition holds at the last of `steps` steps.
Verdict at_end(int k, int steps, bool reached) {
  if (k + 1 < steps) return Verdict::running;
  return reached ? Verdict::solved : Verdict::failed;
}

constexpr int swing_steps = 300, flight_steps = 160, drive_steps = 200;

}  // namespace

void add_example_tasks(std::vector<Task>& tasks) {
  tasks.push_back(
      {"pendulum",
       false,
       60,
       {2},
       {-5},
       {5},
       closed_loop(Pendulum{}, {std::numbers::pi, 0}, swing_steps, [](const Pendulum&, const auto& x, int k) {
         return at_end(k, swing_steps, std::cos(x.angle) > 0.99 && std::abs(x.rate) < 0.5);
       })});
  tasks.push_back({"cart_pole",
                   false,
                   60,
                   {3},
                   {-10},
                   {10},
                   closed_loop(CartPole{}, {0, 0, std::numbers::pi, 0}, swing_steps,
                               [](const CartPole& p, const auto& x, int k) {
                                 if (std::abs(x.position) > p.track) return Verdict::failed;
                                 return at_end(k, swing_steps,
                                               std::cos(x.angle) > 0.99 && std::abs(x.rate) < 0.5);
                               })});
  tasks.push_back(
      {"two_ways_round",
       true,
       25,
       {0.6, 1.2},
       {0, -2},
       {1.5, 2},
       closed_loop(DifferentialDrive{}, {0, 0, 0}, 120, [](const DifferentialDrive& p, const auto& x, int) {
         if (p.place_cost(x).collided) return Verdict::failed;
         return p.distance(x) < 0.3 ? Verdict::solved : Verdict::running;
       })});
  tasks.push_back({"quadrotor_gaps",
                   true,
                   40,
                   {1.4, 2.8},
                   {-6, -20},
                   {6, 20},
                   closed_loop(Quadrotor{}, {0, 0, 0, 0, 0, 0}, flight_steps,
                               [](const Quadrotor& p, const auto& x, int k) {
                                 if (p.hits_wall(x)) return Verdict::failed;
                                 return at_end(k, flight_steps, p.distance(x) < 1);
                               })});
  tasks.push_back({"parked_cars",
                   true,
                   30,
                   {0.3, 1.4},
                   {-0.5, -6},
                   {0.5, 3},
                   closed_loop(Car{}, {0, 0, 0, 5}, drive_steps, [](const Car& p, const auto& x, int k) {
                     if (p.hits(x)) return Verdict::failed;
                     return at_end(k, drive_steps, std::abs(x.x - p.stop_x) < 1 && x.speed < 0.5);
                   })});
  Arm::State<double> start;
  std::copy(Arm::start.begin(), Arm::start.end(), start.angle);
  const std::vector<double> rate(Arm::joints, 1.5), least(Arm::joints, -1.5), deviation(Arm::joints, 0.5);
  tasks.push_back({"arm_past_ball", true, 20, deviation, least, rate,
                   closed_loop(Arm{}, start, 160, [](const Arm& p, const auto& x, int) {
                     const auto arm = p.posture(x);
                     if (p.collides(arm)) return Verdict::failed;
                     return p.distance(arm) < 0.05 ? Verdict::solved : Verdict::running;
                   })});
}

}  // namespace slalom::suite
