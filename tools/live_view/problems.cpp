
#include "slalom/problems/arm.hpp"
#include "slalom/problems/cart_pole.hpp"
#include "slalom/problems/differential_drive.hpp"
#include "slalom/problems/pendulum.hpp"
#include "slalom/problems/quadrotor.hpp"
#include "slalom/solvers/registry.hpp"
#include "slalom/view/serve.hpp"
#include "tools/live_view/view_setup.hpp"
#include "view/problem/differential_drive.hpp"

namespace slalom::tools {
namespace {

using namespace problems;
using maps::Point;
using view::Shape;

constexpr std::array names{"pendulum", "cart_pole", "differential_drive", "quadrotor", "arm"};
constexpr double down = std::numbers::pi;

struct Solving {
  std::string method;
  std::uint64_t seed;
};

Shape goal(double x, double y, double radius) {
  return view::disc(x, y, radius, view::ShapeKind::goal);
}

template <class P>
std::unique_ptr<view::SolverSubject> subject(P problem, const Solving& solving, int horizon,
                                             const PerInput& low, const PerInput& high,
                                             view::Drawing<P> drawing) {
  SolverOptions options = solver_options(solving.method);
  *options.find<int>("horizon") = horizon;
  *options.find<PerInput>("input_min") = low;
  *options.find<PerInput>("input_max") = high;
  *options.find<std::uint64_t>("seed") = solving.seed;
  if (int* samples = options.find<int>("samples")) *samples = 1024;
  return std::make_unique<view::detail::ControllerSubject<P>>(Controller<P>(problem, options),
                                                              std::move(drawing));
}

std::unique_ptr<view::SolverSubject> pendulum(const Solving& solving) {
  using State = Pendulum::State<double>;
  const auto tip = [](const State& x) { return maps::Pose{std::sin(x.angle), std::cos(x.angle), 0}; };
  const auto rod = [tip](const State& x) {
    return std::vector<view::Line>{view::Line{{0, 0}, {tip(x).x, tip(x).y}}};
  };
  const auto upright = [](const Pendulum&) { return std::vector{goal(0, 1, 0.06)}; };
  return subject(Pendulum{}, solving, 60, -5, 5,
                 {.start = {down, 0},
                  .pose = tip,
                  .figure = rod,
                  .shapes = upright,
                  .states = {"angle, rad", "rate, rad/s"},
                  .inputs = {"torque, N·m"},
                  .title = "pendulum"});
}

std::unique_ptr<view::SolverSubject> cart_pole(const Solving& solving) {
  using State = CartPole::State<double>;
  const auto tip = [](const State& x) {
    return maps::Pose{x.position + std::sin(x.angle), std::cos(x.angle), 0};
  };
  const auto figure = [tip](const State& x) {
    const double left = x.position - 0.2, right = x.position + 0.2;
    return std::vector<view::Line>{{{left, -0.1}, {right, -0.1}, {right, 0}, {left, 0}, {left, -0.1}},
                                   {{x.position, 0}, {tip(x).x, tip(x).y}}};
  };
  const auto ends = [](const CartPole& p) {
    return std::vector<Shape>{view::box({-p.track - 0.3, 0, 0}, 0.1, 0.4),
                              view::box({p.track + 0.3, 0, 0}, 0.1, 0.4), goal(0, 1, 0.06)};
  };
  return subject(CartPole{}, solving, 75, -15, 15,
                 {.start = {0, 0, down, 0},
                  .pose = tip,
                  .figure = figure,
                  .shapes = ends,
                  .states = {"position, m", "speed, m/s", "angle, rad", "rate, rad/s"},
                  .inputs = {"force, N"},
                  .title = "cart_pole"});
}

std::unique_ptr<view::SolverSubject> differential_drive(const Solving& solving) {
  return subject(DifferentialDrive{}, solving, 25, {0, -2}, {1.5, 2}, view::drawing_among_discs());
}

std::unique_ptr<view::SolverSubject> quadrotor(const Solving& solving) {
  using State = Quadrotor::State<double>;
  const auto wall = [](const Quadrotor& p) {
    const double middle = 0.5 * (p.wall_from + p.wall_to), thick = p.wall_to - p.wall_from;
    const double inner = p.gap_centre - 0.5 * p.gap_width, outer = p.gap_centre + 0.5 * p.gap_width;
    return std::vector{view::box({middle, 0, 0}, thick, 2 * inner),
                       view::box({middle, outer + 1, 0}, thick, 2),
                       view::box({middle, -outer - 1, 0}, thick, 2), goal(p.goal_x, p.goal_z, 0.15)};
  };
  const auto rotors = [](const State& x) {
    const double c = 0.25 * std::cos(x.tilt), s = 0.25 * std::sin(x.tilt);
    return std::vector<view::Line>{view::Line{{x.x - c, x.z + s}, {x.x + c, x.z - s}}};
  };
  return subject(Quadrotor{}, solving, 40, {-9, -20}, {9, 20},
                 {.x = &State::x,
                  .y = &State::z,
                  .figure = rotors,
                  .shapes = wall,
                  .states = {"x, m", "z, m", "tilt, rad", "speed x, m/s", "speed z, m/s", "rate, rad/s"},
                  .inputs = {"thrust, m/s^2", "turning, rad/s^2"},
                  .title = "quadrotor"});
}

/// The arm from above.
std::unique_ptr<view::SolverSubject> arm(const Solving& solving) {
  using State = Arm::State<double>;
  const auto hand = [](const State& x) {
    const auto at = Arm{}.posture(x).hand;
    return maps::Pose{at.x, at.y, 0};
  };
  const auto links = [](const State& x) {
    const auto p = Arm{}.posture(x);
    return std::vector<view::Line>{
        view::Line{{0, 0}, {p.elbow.x, p.elbow.y}, {p.wrist.x, p.wrist.y}, {p.hand.x, p.hand.y}}};
  };
  const auto ball = [](const Arm& p) {
    return std::vector{view::disc(p.ball_x, p.ball_y, p.ball_radius), goal(p.goal_x, p.goal_y, 0.03)};
  };
  const auto move = [](Arm& p, int shape, const Point& to) {
    (shape ? p.goal_x : p.ball_x) = to.x, (shape ? p.goal_y : p.ball_y) = to.y;
  };
  State start;
  std::copy(Arm::start.begin(), Arm::start.end(), start.angle);
  std::vector<std::string> angles, speeds;
  for (int i = 1; i <= Arm::joints; ++i) {
    angles.push_back("angle " + std::to_string(i) + ", rad");
    speeds.push_back("speed " + std::to_string(i) + ", rad/s");
  }
  return subject(Arm{}, solving, 20, -1.5, 1.5,
                 {.start = start,
                  .pose = hand,
                  .figure = links,
                  .shapes = ball,
                  .move = move,
                  .states = angles,
                  .inputs = speeds,
                  .title = "arm"});
}

}  // namespace

std::unique_ptr<view::SolverSubject> problem_subject(const std::string& name, const std::string& method,
                                                     std::uint64_t seed) {
  constexpr std::array make{pendulum, cart_pole, differential_drive, quadrotor, arm};
  std::string all;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (name == names[i]) return make[i]({method, seed});
    all += std::string(i ? ", " : "") + names[i];
  }
  throw std::invalid_argument("--problem: '" + name + "' must be one of " + all);
}

}  // namespace slalom::tools
