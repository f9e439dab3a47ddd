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

/// Laws of the car for some speeds: how far it turns depends on them, but not on its pose.
constexpr auto car_laws = [](const auto& controller) {
  constexpr double between = 3;  // m/s
  const auto law = [&](double speed) {
    return CUniform(controller, {0, 0, 0, speed},
                    [](const auto& x) {
                      return std::array{x.x, x.y, x.yaw, x.speed};
                    },
                    {{1.5}, {1.5}, {0.5, 2 * std::numbers::pi}, {2.5}},
                    {.input_steps = 6, .input_values = {5, 3}});
  };
  return [laws = std::vector{law(0), law(between), law(2 * between), law(3 * between)}](
             const auto& x, RandomStream& random) mutable {
    const double nearest = std::clamp(std::round(x.speed / between), 0.0, 3.0);
    return laws[static_cast<std::size_t>(nearest)].draw(random);
  };
};

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
  tasks.push_back({"two_ways_round",
                   true,
                   25,
                   {0.6, 1.2},
                   {0, -2},
                   {1.5, 2},
                   closed_loop(
                       DifferentialDrive{}, {0, 0, 0}, 120,
                       [](const DifferentialDrive& p, const auto& x, int) {
                         if (p.place_cost(x).collided) return Verdict::failed;
                         return p.distance(x) < 0.3 ? Verdict::solved : Verdict::running;
                       },
                       nullptr, pose_law(0.25, 0.4, {.input_steps = 5, .input_values = {3, 5}})),
                   true});
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
                   closed_loop(
                       Car{}, {0, 0, 0, 5}, drive_steps,
                       [](const Car& p, const auto& x, int k) {
                         if (p.hits(x)) return Verdict::failed;
                         return at_end(k, drive_steps, std::abs(x.x - p.stop_x) < 1 && x.speed < 0.5);
                       },
                       nullptr, car_laws),
                   true});
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
