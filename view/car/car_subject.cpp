#include "view/car/car_subject.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "view/car/car_frame.hpp"

namespace slalom::view {
namespace {

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
      on_step = [&](const evaluation::ControlStep& step) {
        observe(step, driver_.configuration.vehicle.time_step);
        on_plan(solve(), step.output.tick_time);
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

std::unique_ptr<Subject> car_subject(const evaluation::LapSetup& setup, std::uint64_t seed) {
  return std::make_unique<CarSubject>(setup, seed);
}

}  // namespace slalom::view
