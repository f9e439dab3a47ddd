
#include "slalom/evaluation/rooms/room_world.hpp"
#include "slalom/navigation/navigation_problem.hpp"
#include "slalom/view/serve.hpp"
#include "tools/live_view/view_setup.hpp"

namespace slalom::tools {
namespace {

using evaluation::RoomNavigator;
using evaluation::RoomScenario;
using evaluation::RoomWorld;
using navigation::NavigationStatus;
using navigation::Velocity;
using view::ShapeKind;

constexpr std::size_t state_size = 6;  // x, y, yaw, and the velocity forward, left and turn
constexpr double goal_radius = 0.2;    // m, as it is drawn
constexpr double line_spacing = 0.1;   // m between the points of the path that are shown

maps::Pose pose_of(std::span<const double> state) {
  return {state[0], state[1], state[2]};
}

/// A navigator in its room. Its state is that of the robot; room, people and map of the scans are members.
class RoomSubject final : public view::SolverSubject {
 public:
  RoomSubject(const RoomScenario& scenario, const std::string& method, std::uint64_t seed)
      : scenario_(evaluation::with_heading(scenario, seed)), seed_(seed) {
    driver_.navigator.base = scenario.base;
    driver_.solver = *RoomSubject::options_of(method);
    const bool is_omnidirectional = scenario.base.kind == navigation::BaseKind::omnidirectional;
    facts_.title = scenario.name;
    facts_.states = {"x, m", "y, m", "yaw, rad", "forward, m/s", "left, m/s", "turn, rad/s"};
    facts_.inputs = {"forward command, m/s"};
    if (is_omnidirectional) facts_.inputs.emplace_back("left command, m/s");
    facts_.inputs.emplace_back("turn command, rad/s");
    using Problem = navigation::NavigationProblem<navigation::DifferentialBase>;
    for (const CostTerm& term : slalom::detail::cost_terms_of<Problem>())
      facts_.terms.emplace_back(term.name);
    facts_.length = scenario.robot_length;
    facts_.width = scenario.robot_width;
    facts_.can_place = facts_.can_move = true;
    facts_.map = sim::map_of(scenario.room, 0.05);
    for (int i = 0; i <= static_cast<int>(NavigationStatus::bad_input); ++i)
      facts_.statuses.emplace_back(navigation::name(static_cast<NavigationStatus>(i)));
    RoomSubject::restart();
  }

  std::unique_ptr<Subject> clone() const override { return std::make_unique<RoomSubject>(*this); }
  const view::SubjectFacts& facts() const override { return facts_; }
  std::vector<double> start() const override { return {start_.x, start_.y, start_.yaw, 0, 0, 0}; }
  double time_step() const override { return evaluation::room_period; }
  const SolverOptions* options() const override { return &driver_.solver; }
  void set_options(const SolverOptions& options) override {
    robot_->replace(driver_.navigator, options);
    driver_.solver = options;
  }
  std::optional<SolverOptions> options_of(const std::string& method) const override {
    return evaluation::with_seed(navigation::method_options(method, driver_.navigator.base), seed_);
  }
  std::vector<view::OptionSection> parameters() const override {
    std::vector<OptionEntry> all = list_options(driver_.navigator);
    std::erase_if(all,
                  [](const OptionEntry& each) { return std::string_view(each.declaration.name) == "base"; });
    return {{"problem", std::move(all)}};
  }
  bool set_parameter(const std::string& section, const std::string& name, const std::string& text) override {
    navigation::NavigatorOptions changed = driver_.navigator;
    if (section != "problem" || name == "base" || !set_option(changed, name, text)) return false;
    robot_->replace(changed, driver_.solver);
    driver_.navigator = changed;
    return true;
  }

  void restart() override {
    RandomStream random({seed_, 0});
    start_ = evaluation::varied(scenario_.start, random);
    scenario_.base = driver_.navigator.base;
    world_.emplace(scenario_, seed_, start_);
    robot_.emplace(scenario_, driver_, seed_, random);
    if (!robot_->set_path(start_))
      throw std::invalid_argument("scenario: " + scenario_.name + ": has no path to the goal");
  }
  int status(const SolveResult&) const override { return static_cast<int>(status_); }

  const SolveResult& solve(std::span<const double> state, const SolveRequest& request) override {
    world_->pose = pose_of(state);
    world_->velocity = {state[3], state[4], state[5]};
    const navigation::NavigationResult result = robot_->decide(*world_, request.elapsed);
    status_ = result.status;
    const Velocity& command = result.command;
    path_.clear();
    for (const maps::Pose& p : result.path)
      if (path_.empty() || std::hypot(p.x - path_.back().x, p.y - path_.back().y) > line_spacing)
        path_.push_back({p.x, p.y});
    stands_ = result.plan.empty();
    still_.assign(facts_.inputs.size(), 0);
    stopped_.inputs = still_;
    const SolveResult& solution = stands_ ? stopped_ : robot_->navigator().solution();
    inputs_.assign(solution.inputs.begin(), solution.inputs.end());
    inputs_.front() = command.forward;
    inputs_[facts_.inputs.size() - 1] = command.turn;
    if (facts_.inputs.size() == 3) inputs_[1] = command.left;
    return solution;
  }
  /// Begins with the command that is sent, also where the plan is not followed.
  std::span<const double> inputs() const override { return inputs_; }

  Trajectories roll_out(std::span<const double> state, std::span<const float> sequences) override {
    Trajectories all;
    if (stands_) {
      const std::size_t count = sequences.size() / facts_.inputs.size();
      for (std::size_t i = 0; i < 2 * count; ++i)
        all.states.insert(all.states.end(), state.begin(), state.end());
      all.costs.assign(2 * count * facts_.terms.size(), 0);
      all.collisions.assign(count, -1);
    } else {
      all = robot_->navigator().roll_out(sequences);
    }
    all.collisions.front() = world_->collides() ? 0 : -1;
    return all;
  }
  std::vector<double> step(std::span<const double>, std::span<const double>) override {
    const Velocity command = robot_->command(*world_);
    for (int part = 0; part < RoomWorld::parts; ++part) world_->step({&command, 1});
    world_->time += evaluation::room_period;
    const auto& [pose, v] = std::pair(world_->pose, world_->velocity);
    return {pose.x, pose.y, pose.yaw, v.forward, v.left, v.turn};
  }

  std::vector<maps::Pose> poses(std::span<const double> states) override {
    std::vector<maps::Pose> all;
    for (std::size_t at = 0; at < states.size(); at += state_size) all.push_back(pose_of(states.subspan(at)));
    return all;
  }
  std::vector<view::Shape> shapes() override {
    std::vector<view::Shape> all;
    const sim::Room& room = world_->room();
    for (const sim::Box& box : room.obstacles) all.push_back(view::box(box.pose, box.length, box.width));
    for (const sim::Disc& post : room.posts)
      all.push_back(view::disc(post.middle.x, post.middle.y, post.radius));
    const maps::Pose& goal = robot_->goal();
    all.push_back(view::disc(goal.x, goal.y, goal_radius, ShapeKind::goal));
    for (const sim::Disc& each : room.people)
      all.push_back(view::disc(each.middle.x, each.middle.y, each.radius, ShapeKind::mover));
    return all;
  }
  std::vector<view::Line> lines() override { return {path_}; }
  std::vector<view::Line> figure(std::span<const double>) override { return {}; }
  void place(std::span<double> state, const maps::Pose& to) override {
    state[0] = to.x, state[1] = to.y, state[2] = to.yaw;
  }
  void move(int shape, const maps::Pose& to) override {
    const auto index = static_cast<std::size_t>(shape);
    const std::size_t obstacles = world_->room().obstacles.size() + world_->room().posts.size();
    if (index > obstacles) throw std::invalid_argument("body: people walk by themselves");
    if (index < obstacles) {
      world_->move_obstacle(index, {to.x, to.y});
      scenario_.room.obstacles = world_->room().obstacles;
      scenario_.room.posts = world_->room().posts;
      return;
    }
    const maps::Pose goal{to.x, to.y, robot_->goal().yaw};
    if (!robot_->set_goal(goal, world_->pose))
      throw std::invalid_argument("goal: no way leads there on the map of the scans");
    scenario_.goal = goal;
    scenario_.path.clear();
  }

 private:
  RoomScenario scenario_;
  std::uint64_t seed_;
  evaluation::RoomDriver driver_;
  view::SubjectFacts facts_;
  maps::Pose start_;
  std::optional<RoomWorld> world_;
  std::optional<RoomNavigator> robot_;
  NavigationStatus status_{};
  view::Line path_;             ///< that is followed
  bool stands_ = false;         ///< whether the last decision has no plan
  std::vector<float> still_;    ///< the inputs of a step that stands
  SolveResult stopped_;         ///< without a plan
  std::vector<double> inputs_;  ///< the command, then the plan's inputs
};

}  // namespace

std::unique_ptr<view::SolverSubject> room_subject(const std::string& scenario, const std::string& method,
                                                  std::uint64_t seed) {
  return std::make_unique<RoomSubject>(evaluation::room_scenario(scenario), method, seed);
}

}  // namespace slalom::tools
