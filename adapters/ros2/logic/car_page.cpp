#include "logic/car_page.hpp"

#include "logic/transforms.hpp"

namespace slalom::nodes {

using vehicle::PredictedState;

/// The plans of a planner, with the states that it predicts for each sequence that is shown.
class CarPage::Steps final : public view::WatchedSource {
 public:
  Steps(const vehicle::Configuration& configuration, const vehicle::Planner& planner,
        const maps::LaserScanView& scan, view::SubjectFacts course)
      : facts_(std::move(course)),
        time_step_(configuration.vehicle.time_step),
        method_(planner.solver().name()) {
    const vehicle::PathTrackingOptions& car = configuration.vehicle;
    const vehicle::PlannerOptions& at = configuration.planner;
    middle_ = 0.5 * (car.body.front - car.body.rear);
    laser_ = {at.laser_x, at.laser_y, at.laser_yaw};
    facts_.title = "car";
    facts_.states = {"x, m", "y, m", "yaw, rad", "speed, m/s", "steering, rad"};
    facts_.inputs = {"steering command, rad"};
    if (planner.solver().inputs() > 1) facts_.inputs.emplace_back("acceleration, m/s^2");
    facts_.terms = {"distance", "yaw", "collision"};
    facts_.length = car.body.front + car.body.rear;
    facts_.width = car.body.width;
    facts_.front = car.wheelbase() - middle_;
    facts_.rear = middle_;
    facts_.speed = 3;
    facts_.steering = 4;
    facts_.scanner = {scan.angle_min, scan.angle_increment, scan.range_max};
    for (int i = 0; i <= static_cast<int>(vehicle::PlannerStatus::solver_degenerate); ++i)
      facts_.statuses.emplace_back(name(static_cast<vehicle::PlannerStatus>(i)));
    for (vehicle::Section& each : vehicle::list_sections(configuration))
      if (each.name == "vehicle" || each.name == "planner" || each.name == method_)
        options_.push_back({each.name, std::move(each.options)});
  }

  bool give(const vehicle::Planner& planner, const vehicle::PlannerInput& input,
            const vehicle::PlannerOutput& output, double time) {
    return moments_.give([&](Moment& to) {
      SolveResult solve = output.solve ? *output.solve : SolveResult{};
      solve.inputs = output.inputs;
      to.step.solve.take(solve, false);
      const std::size_t length = to.step.solve.length;
      to.points = static_cast<std::size_t>(planner.solver().horizon()) + 1;
      to.states.resize(length > 0 ? to.step.solve.sequences.size() / length * to.points : 0);
      for (std::size_t i = 0; i * to.points < to.states.size(); ++i)
        planner.predict(std::span(to.step.solve.sequences).subspan(i * length, length),
                        std::span(to.states).subspan(i * to.points, to.points));
      to.pose = input.odometry.pose;
      to.step.state = {to.pose.x, to.pose.y, to.pose.yaw, input.odometry.speed, output.steer_estimate};
      to.step.inputs.assign(output.inputs.begin(), output.inputs.end());
      if (length == 0) to.step.inputs = {output.command.steer, 0};
      to.step.time = time;
      to.step.update_time = output.tick_time;
      to.status = output.status;
      to.ranges.assign(input.scan.ranges.begin(), input.scan.ranges.end());
      to.others.clear();
      for (const maps::PredictedObstacle& other : input.others) {
        to.others.push_back(view::box(other.poses.front().pose, other.length, other.width));
        to.others.back().kind = view::ShapeKind::opponent;
      }
    });
  }

  const view::WatchedStep* take() override {
    const Moment* const newest = moments_.take();
    if (newest) shown_ = newest;
    return newest ? &newest->step : nullptr;
  }
  double time_step() const override { return time_step_; }
  std::string method() const override { return method_; }
  std::vector<view::OptionSection> options() const override { return options_; }

  const view::SubjectFacts& facts() const override { return facts_; }
  int status(const SolveResult&) const override { return static_cast<int>(shown_->status); }
  std::span<const double> inputs() const override { return shown_->step.inputs; }
  Trajectories roll_out(std::span<const double>, std::span<const float>) override {
    Trajectories all;
    vehicle::PredictedCost before;
    for (std::size_t i = 0; i < shown_->states.size(); ++i) {
      if (i % shown_->points == 0) {
        before = {};
        all.collisions.push_back(-1);
      }
      const PredictedState& s = shown_->states[i];
      const double distance = s.cost.distance - before.distance;
      all.states.insert(all.states.end(), {s.pose.x, s.pose.y, s.pose.yaw, s.speed, s.steer});
      all.costs.insert(all.costs.end(), {distance, s.cost.state - before.state - distance,
                                         s.cost.collision - before.collision});
      if (s.cost.collided && all.collisions.back() < 0)
        all.collisions.back() = static_cast<int>(i % shown_->points);
      before = s.cost;
    }
    return all;
  }
  /// Returns the middles of the body. A state has the pose of the rear axle.
  std::vector<maps::Pose> poses(std::span<const double> states) override {
    std::vector<maps::Pose> all;
    for (std::size_t at = 0; at < states.size(); at += facts_.states.size())
      all.push_back(moved_ahead({states[at], states[at + 1], states[at + 2]}, middle_));
    return all;
  }
  std::vector<view::Shape> shapes() override { return shown_->others; }
  std::vector<view::Line> figure(std::span<const double>) override { return {}; }
  std::optional<view::SeenScan> scan() const override {
    return view::SeenScan{composed(shown_->pose, laser_), shown_->ranges};
  }

 private:
  struct Moment {
    view::WatchedStep step;
    std::vector<PredictedState> states;  ///< [sequence][point]
    std::size_t points = 1;              ///< states of a sequence
    maps::Pose pose;                     ///< pose of the rear axle
    vehicle::PlannerStatus status{};
    std::vector<float> ranges;  ///< m
    std::vector<view::Shape> others;
  };

  view::SubjectFacts facts_;
  double time_step_, middle_ = 0;  ///< s; m, from the rear axle to the middle of the body
  std::string method_;
  maps::Pose laser_;  ///< pose in the frame of the rear axle
  std::vector<view::OptionSection> options_;
  view::Handover<Moment> moments_;
  const Moment* shown_ = nullptr;
};

CarPage::CarPage(std::uint16_t port, const vehicle::Configuration& configuration,
                 const vehicle::Planner& planner, const maps::LaserScanView& scan, view::SubjectFacts course)
    : CarPage(port, std::make_unique<Steps>(configuration, planner, scan, std::move(course))) {}
CarPage::CarPage(std::uint16_t port, std::unique_ptr<Steps> steps)
    : steps_(steps.get()), page_(std::move(steps), {.port = port}) {}

void CarPage::show(const vehicle::Planner& planner, const vehicle::PlannerInput& input,
                   const vehicle::PlannerOutput& output) noexcept {
  page_.show([&](double time) { return steps_->give(planner, input, output, time); });
}

}  // namespace slalom::nodes
