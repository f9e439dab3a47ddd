// A robot drives to and fro among discs, controlled by this program, 20 times a second. A page in the browser
// shows its plans and samples as they are made, and cannot change anything.
//   example_12_monitor [PORT [SECONDS]]

#include <chrono>
#include <thread>

#include <slalom/problems/differential_drive.hpp>
#include <slalom/slalom.hpp>
#include <slalom/view/monitor.hpp>

using slalom::problems::DifferentialDrive;
using State = DifferentialDrive::State<double>;

int main(int count, char** words) {
  const int port = count > 1 ? std::atoi(words[1]) : 8400, seconds = count > 2 ? std::atoi(words[2]) : 3600;
  const DifferentialDrive robot{.dt = 0.05};
  slalom::SvgMppi controller{robot,
                             {.horizon = 40, .samples = 512, .input_min = {0, -2}, .input_max = {1.5, 2}}};
  slalom::view::Monitor monitor(
      controller,
      {.x = &State::x,
       .y = &State::y,
       .heading = &State::yaw,
       .length = 0.5,
       .width = 0.4,
       .shapes =
           [](const DifferentialDrive& p) {
             std::vector<slalom::view::Shape> all;
             for (const auto& d : p.discs) all.push_back(slalom::view::disc(d.x, d.y, d.radius - 0.32));
             all.push_back(slalom::view::disc(p.goal_x, p.goal_y, 0.2, slalom::view::ShapeKind::goal));
             return all;
           },
       .states = {"x, m", "y, m", "yaw, rad"},
       .inputs = {"speed, m/s", "yaw rate, rad/s"},
       .title = "robot"},
      {.port = static_cast<std::uint16_t>(port), .ready = slalom::view::print_address});
  State x{};
  for (int step = 0; step < 20 * seconds; ++step) {
    const auto plan = controller.solve(x, {.elapsed = robot.dt});
    x = robot.step(x, plan.inputs[0]);  // the real robot
    monitor.show(controller, plan);
    double& goal = controller.problem().goal_x;
    if (controller.problem().distance(x) < 0.5) goal = 8 - goal;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  std::printf("%llu plans came too soon to be shown\n", static_cast<unsigned long long>(monitor.dropped()));
}
