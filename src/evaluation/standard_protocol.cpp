
#include "evaluation/lap_rules.hpp"

namespace slalom::evaluation {
namespace {

class StandardRules final : public LapRules {
 public:
  maps::MapRule map_rule() const noexcept override { return maps::MapRule::map_server; }
  bool outside_is_wall() const noexcept override { return true; }
  void complete(Environment&, const std::filesystem::path&,
                const std::vector<std::filesystem::path>&) const override {}

  sim::WorldOptions world_options() const override {
    sim::WorldOptions options{.time_step = 0.005};
    options.lidar.rate = 40;  // Hz, a scan for every command
    // After a collision the car continues if it can, so that one collision does not hide the next.
    options.wall_response = options.body_response = sim::CollisionResponse::slide;
    return options;
  }

  void configure(sim::WorldOptions& options, const LapSettings& settings,
                 const vehicle::Configuration& configuration) const override {
    // For any control period, a command has a whole number of simulation steps and one scan.
    const double period = configuration.planner.control_period;
    options.time_step = period / std::max(1.0, std::ceil(period / options.time_step - 1e-9));
    options.lidar.rate = 1 / period;
    options.lidar.noise = settings.range_noise;
    options.lidar.dropout = settings.dropout;
    options.car = car_of(settings, configuration);
    if (settings.car == CarKind::configured) {
      const vehicle::VehicleOptions& vehicle = configuration.vehicle;
      const vehicle::PlannerOptions& planner = configuration.planner;
      const auto& own = vehicle.own_of<vehicle::SingleTrackOptions>();
      options.lidar.mount = {planner.laser_x - vehicle.rear_length, planner.laser_y, planner.laser_yaw};
      options.plant.steering_dead_time = vehicle.dead_time;
      options.plant.actuation.speed_gain = own.speed_gain;
      options.plant.actuation.brake_gain = own.brake_gain;
    }
    if (settings.car == CarKind::passenger_car) {
      options.lidar.range_max = 150;       // m
      options.lidar.mount = {1.25, 0, 0};  // on the bonnet
    }
    if (settings.saturating_tyres) options.plant.dynamics.model = sim::Model::saturating;
  }
  void check(const LapSettings& settings) const override {
    if (settings.car == CarKind::passenger_car && (settings.hardware || settings.localised))
      throw std::invalid_argument(
          "world.car: must not be passenger_car with sensors of a real car, which are those of a 1/10-scale "
          "car");
  }
  double control_period(const vehicle::Configuration& configuration) const noexcept override {
    return configuration.planner.control_period;
  }

  std::vector<maps::Pose> place_obstacles(const Environment& environment, int obstacles, std::uint64_t seed,
                                          const maps::Point& start,
                                          const sim::CarParameters& car) const override {
    return sim::place_apart(environment.course.obstacle_path, environment.obstacle_room, obstacles, seed,
                            start, car);
  }

  maps::LaserScanView scan(const sim::Observation& seen, const sim::World&) const noexcept override {
    return seen.scan;
  }
  Command command(const Command& planned) const noexcept override { return planned; }

  bool finishes_open_courses() const noexcept override { return true; }
  bool lap_complete(const sim::World& world, double) const noexcept override {
    return world.laps(0)->laps() > 0;
  }
  double lap_time(const sim::World& world) const noexcept override { return world.laps(0)->last_lap_time(); }
  int collisions(const sim::CollisionLog& log) const noexcept override { return log.collisions(); }
};

}  // namespace

const LapRules& detail::standard_rules() noexcept {
  static const StandardRules rules;
  return rules;
}

const LapRules& rules_of(Protocol protocol) noexcept {
  return protocol == Protocol::published ? detail::published_rules() : detail::standard_rules();
}

}  // namespace slalom::evaluation
