#include "view/car/car_subject.hpp"

#include "slalom/core/gravity.hpp"
#include "slalom/sim/shapes.hpp"
#include "view/protocol/frame_writer.hpp"

namespace slalom::view {
namespace {

using evaluation::ControlStep;
using vehicle::PredictedState;

constexpr std::size_t state_size = 5;
constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// Returns the distance from the driven car to the nearest wall or other body, m; negative if they overlap.
double clearance_of(const sim::World& world) {
  const sim::Box body = world.outline(0);
  double least = std::numeric_limits<double>::infinity();
  for (const maps::Point& corner : sim::corners(body))
    least = std::min(least, world.track().distance_to_wall(corner));
  for (std::size_t i = 1; i < world.bodies(); ++i) {
    const auto disc = world.disc(i);
    least = std::min(least, disc ? sim::signed_gap(body, *disc) : sim::signed_gap(body, world.outline(i)));
  }
  return least;
}

void put_cost_map(FrameWriter& to, const ControlStep& step) {
  const maps::LocalCostMap& map = step.planner.cost_map();
  const maps::GridGeometry& geometry = map.geometry();
  to.begin(Block::cost_map);
  to.put_pose(step.odometry.pose);
  to.put(static_cast<std::uint16_t>(geometry.rows));
  to.put(static_cast<std::uint16_t>(geometry.columns));
  to.put_f32({geometry.resolution, geometry.center_x, geometry.center_y});
  unsigned bits = 0;
  int filled = 0;
  for (int row = 0; row < geometry.rows; ++row) {
    for (int column = 0; column < geometry.columns; ++column) {
      bits |= static_cast<unsigned>(*map.cells().at(row, column) > 0) << filled;
      if (++filled < 8) continue;
      to.put(static_cast<std::uint8_t>(bits));
      bits = 0;
      filled = 0;
    }
  }
  if (filled > 0) to.put(static_cast<std::uint8_t>(bits));
  to.end();
}

/// Writes the cars that are tracked: the box of now, and the places of all hypotheses.
void put_others(FrameWriter& to, const ControlStep& step) {
  if (step.others.empty()) return;
  to.begin(Block::others);
  to.put(static_cast<std::uint32_t>(step.others.size()));
  for (const maps::PredictedObstacle& other : step.others) {
    to.put_f32({other.length, other.width, other.poses.front().pose.yaw});
    to.put(static_cast<std::uint16_t>(other.hypotheses));
    to.put(static_cast<std::uint16_t>(other.times()));
    for (int k = 0; k < other.hypotheses; ++k) to.put_f32(other.weights[static_cast<std::size_t>(k)]);
    to.begin_points({step.seen.pose.x, step.seen.pose.y});
    for (const maps::PredictedPose& place : other.poses) to.put_point({place.pose.x, place.pose.y});
  }
  to.end();
}

/// Returns the states of the first car of a world: x, y, yaw, speed and steering.
std::vector<double> state_of(const sim::World& world) {
  const sim::CarState& car = world.state(0);
  return {car.x, car.y, car.yaw, car.speed, car.steer};
}

/// Returns the bodies of a world, but the first car.
std::vector<Shape> shapes_of(const sim::World& world) {
  std::vector<Shape> all;
  const sim::CarParameters& car = world.options().car;
  const auto hit = world.observe(0).colliding;
  for (std::size_t i = 1; i < world.bodies(); ++i) {
    const sim::Box body = world.outline(i);
    Shape shape = box(body.pose, body.length, body.width);
    shape.is_disc = world.disc(i).has_value();
    const bool is_car = body.length == car.length && body.width == car.width;
    if (i < world.cars())
      shape.kind = ShapeKind::opponent;
    else if (is_car && !shape.is_disc)
      shape.kind = ShapeKind::parked_car;
    shape.touched = std::find(hit.begin(), hit.end(), static_cast<int>(i)) != hit.end();
    all.push_back(std::move(shape));
  }
  return all;
}

/// The car of a control step.
class CarSource : public virtual FrameSource {
 public:
  explicit CarSource(std::shared_ptr<const SubjectFacts> facts) : facts_(std::move(facts)) {}

  /// Takes a control step, which the functions below tell of, and returns the planner's result with the
  /// inputs that it chose. `prediction_step`: s of a step of the plan.
  SolveResult observe(const ControlStep& step, double prediction_step) {
    step_ = &step;
    prediction_step_ = prediction_step;
    // The car may have touched something between two steps alone.
    collides_ = step.seen.collides() || step.collisions > std::exchange(collisions_, step.collisions);
    const vehicle::PlannerOutput& out = step.output;
    inputs_.assign(out.inputs.begin(), out.inputs.end());
    SolveResult solve = out.solve ? *out.solve : SolveResult{};
    if (!out.inputs.empty()) solve.inputs = out.inputs;
    return solve;
  }

  const SubjectFacts& facts() const override { return *facts_; }
  int status(const SolveResult&) const override { return static_cast<int>(step_->output.status); }
  std::span<const double> inputs() const override { return inputs_; }
  std::size_t inputs_per_step() const override {
    return static_cast<std::size_t>(step_->planner.solver().inputs());
  }

  Trajectories roll_out(std::span<const double>, std::span<const float> sequences) override {
    Trajectories all;
    const auto length = static_cast<std::size_t>(step_->planner.solver().horizon()) * inputs_per_step();
    std::vector<PredictedState> states(length / inputs_per_step() + 1);
    for (std::size_t at = 0; at + length <= sequences.size(); at += length) {
      step_->planner.predict(sequences.subspan(at, length), states);
      vehicle::PredictedCost before;
      all.collisions.push_back(-1);
      for (std::size_t k = 0; k < states.size(); ++k) {
        const PredictedState& state = states[k];
        const vehicle::PredictedCost& sum = state.cost;
        const double distance = sum.distance - before.distance;
        all.states.insert(all.states.end(),
                          {state.pose.x, state.pose.y, state.pose.yaw, state.speed, state.steer});
        all.costs.insert(all.costs.end(),
                         {distance, sum.state - before.state - distance, sum.collision - before.collision});
        if (sum.collided && all.collisions.back() < 0) all.collisions.back() = static_cast<int>(k);
        before = sum;
      }
    }
    return all;
  }
  std::vector<maps::Pose> poses(std::span<const double> states) override {
    std::vector<maps::Pose> all;
    for (std::size_t at = 0; at < states.size(); at += state_size)
      all.push_back({states[at], states[at + 1], states[at + 2]});
    return all;
  }
  std::vector<Line> figure(std::span<const double>) override { return {}; }

  std::vector<Shape> shapes() override { return shapes_of(step_->world); }

  std::vector<double> figures() override {
    const sim::World& world = step_->world;
    const sim::CarState& car = world.state(0);
    const vehicle::PlannerOutput& out = step_->output;
    const StageTimes times = out.solve ? out.solve->times : StageTimes{};
    const sim::LapTimer& laps = *world.laps(0);
    const int lap = laps.laps();
    std::vector<double> all{car.speed,         car.steer,         car.yaw_rate,      car.slip,
                            out.command.steer, out.command.speed, out.steer_estimate};
    for (const double time : {times.draw, times.evaluate, times.guide, times.update, times.total})
      all.push_back(1e3 * time);
    all.insert(all.end(), {static_cast<double>(lap), step_->time - laps.lap_start_time(),
                           laps.progress() / world.track().lap_path()->length() - lap, laps.offset(),
                           clearance_of(world), step_->cost.total()});
    const vehicle::ParameterEstimate& estimate = out.parameters;
    if (estimate.friction > 0) {
      const double turning = std::abs(out.speed_estimate * out.yaw_rate_estimate);
      all.insert(all.end(), {out.slip_estimate, turning / (estimate.friction * gravity), estimate.friction,
                             estimate.cautious_friction, estimate.steering_gain, estimate.steering_offset,
                             estimate.delay});
    } else {
      all.insert(all.end(), 7, none);  // the tyres do not slip
    }
    const maps::Pose& rear = step_->odometry.pose;
    all.insert(all.end(), {rear.x, rear.y, rear.yaw, step_->odometry.speed});
    return all;
  }
  std::optional<SeenScan> scan() const override { return SeenScan{step_->seen.sensor, step_->scan.ranges}; }
  std::string blocks() override {
    FrameWriter to;
    put_cost_map(to, *step_);
    put_others(to, *step_);
    return to.take_blocks();
  }
  std::optional<StepMeasures> measures() const override {
    return StepMeasures{step_->time, step_->output.tick_time, collides_, step_->collisions, prediction_step_};
  }

 private:
  std::shared_ptr<const SubjectFacts> facts_;
  const ControlStep* step_ = nullptr;
  double prediction_step_ = 0;  ///< s
  bool collides_ = false;       ///< since the step before
  int collisions_ = INT_MAX;    ///< until the step before, where that is known
  std::vector<double> inputs_;
};

/// A car that is driven lap after lap; edits change its world.
class CarSubject final : public Subject, public CarSource {
 public:
  CarSubject(const evaluation::LapSetup& setup, std::uint64_t seed)
      : CarSource(car_facts(setup.environment.get())),
        seed_(seed),
        drive_(setup, seed),
        driver_(setup.driver) {}

  std::unique_ptr<Subject> clone() const override { return std::make_unique<CarSubject>(*this); }
  std::vector<double> start() const override { return state_of(drive_.world()); }
  double time_step() const override { return drive_.setup().control_period(); }

  const SolverOptions* options() const override {
    const auto found =
        std::ranges::find(driver_.configuration.methods, driver_.method, &SolverOptions::method);
    return found == driver_.configuration.methods.end() ? nullptr : &*found;
  }
  void set_options(const SolverOptions& options) override {
    driver_.method = options.method();
    for (SolverOptions& each : driver_.configuration.methods)
      if (each.method() == driver_.method) each = options;
  }
  std::optional<SolverOptions> options_of(const std::string& method) const override {
    for (const SolverOptions& each : driver_.configuration.methods)
      if (each.method() == method) return each;
    return {};
  }
  std::vector<OptionSection> parameters() const override {
    std::vector<OptionSection> all = sections_of(driver_.configuration, driver_.method);
    all.erase(all.begin());
    return all;
  }
  bool set_parameter(const std::string& section, const std::string& name, const std::string& text) override {
    vehicle::set_option(driver_.configuration, section + "." + name, text);
    return true;
  }
  void apply() override {
    evaluation::LapSetup setup = drive_.setup();
    setup.driver = driver_;
    if (setup.control_period() == drive_.setup().control_period())
      drive_.change_driver(driver_);
    else
      drive_ = evaluation::LapDrive(setup, seed_);
  }

  void restart() override {
    drive_ = evaluation::LapDrive(drive_.setup(), seed_);
    laps_.clear();
  }
  std::vector<double> drive(std::span<const double>, const DriveRequest& request,
                            const OnPlan& on_plan) override {
    evaluation::ControlStepCallback on_step;
    if (on_plan)
      on_step = [&](const ControlStep& step) {
        on_plan(observe(step, driver_.configuration.vehicle.time_step), step.output.tick_time);
      };
    drive_.step(on_step, request.delay);
    note_lap();
    return state_of(drive_.world());
  }
  std::span<const DrivenLap> laps() const override { return laps_; }

  std::vector<Shape> shapes() override { return shapes_of(drive_.world()); }
  void place(std::span<double> state, const maps::Pose& to) override {
    sim::World& world = drive_.world();
    if (world.track().in_wall({to.x, to.y})) throw std::invalid_argument("car: must not overlap a wall");
    sim::CarState car = world.state(0);
    state[0] = car.x = to.x;
    state[1] = car.y = to.y;
    state[2] = car.yaw = to.yaw;
    world.set_state(0, car);
  }
  void move(int shape, const maps::Pose& to) override { drive_.world().move_body(shape + 1, to); }
  void add(const Shape& shape) override {
    sim::World& world = drive_.world();
    if (shape.kind == ShapeKind::parked_car)
      world.add_parked_car(shape.pose);
    else if (shape.is_disc)
      world.add_disc({{shape.pose.x, shape.pose.y}, 0.5 * shape.length});
    else
      world.add_box({shape.pose, shape.length, shape.width});
  }
  void remove(int shape) override { drive_.world().remove_body(shape + 1); }

 private:
  void note_lap() {
    const sim::LapTimer& timer = *std::as_const(drive_).world().laps(0);
    if (timer.laps() <= (laps_.empty() ? 0 : laps_.back().lap)) return;
    int contacts = drive_.collisions();
    for (const DrivenLap& lap : laps_) contacts -= lap.contacts;
    laps_.push_back({.end = drive_.steps(),
                     .lap = timer.laps(),
                     .time = timer.last_lap_time(),
                     .contacts = contacts,
                     .method = drive_.setup().driver.method});
  }

  std::uint64_t seed_;
  evaluation::LapDrive drive_;
  evaluation::Driver driver_;  ///< the one of the drive, once `apply` has been called
  std::vector<DrivenLap> laps_;
};

}  // namespace

std::string encode_car(std::shared_ptr<const SubjectFacts> facts, const ControlStep& step, double period,
                       double prediction_step, int method) {
  CarSource source(std::move(facts));
  const SolveResult solve = source.observe(step, prediction_step);
  return encode_frame(source, solve,
                      {.tick = step.step,
                       .measures = *source.measures(),
                       .period = period,
                       .method = method,
                       .state = state_of(step.world)})
      .message;
}

std::unique_ptr<Subject> car_subject(const evaluation::LapSetup& setup, std::uint64_t seed) {
  return std::make_unique<CarSubject>(setup, seed);
}

}  // namespace slalom::view
