#pragma once

#include <memory>
#include <utility>

#include "slalom/maps/laser_scan.hpp"
#include "slalom/sim/gym.hpp"
#include "slalom/sim/laps.hpp"
#include "slalom/sim/lidar.hpp"
#include "slalom/sim/plant.hpp"
#include "slalom/sim/shapes.hpp"
#include "slalom/sim/track.hpp"

/// A 2D world of cars with LiDAR on a track:
///
///     auto track = std::make_shared<const Track>(maps::load_ros_map("map.yaml"), LapPath(points));
///     World world({}, track);
///     world.reset(seed, start_poses, parked_poses);
///     while (world.laps(0)->laps() < 3) {
///       const Observation seen = world.observe(0);
///       world.step(std::array{Command{steer, speed}});
///     }
///
/// A world is a value: a copy behaves as its original does. All worlds of a track share its walls, so
/// thousands of worlds can run in parallel, each in one thread.
namespace slalom::sim {

/// The effect of a collision on a driven car.
enum class CollisionResponse {
  stop,        ///< the car returns to its place before the step, at rest
  slide,       ///< the car loses the speed into the obstacle and keeps the speed along it
  count_only,  ///< the car drives through, and the collision is counted
  /// As `slide`, but a car that touches only cars which drive into it keeps its motion: only those lose
  /// speed. With `slide` both lose speed, so a car that is hit from behind may stop.
  slide_unless_struck,
};
inline const char* const* enum_names(CollisionResponse) {
  static constexpr const char* names[] = {"stop", "slide", "count_only", "slide_unless_struck", nullptr};
  return names;
}

/// Options of cars, scanners and collisions. `visit_options` below describes the fields.
struct WorldOptions {
  double time_step = 0.01;
  CarParameters car{};   ///< parameters of all cars
  PlantOptions plant{};  ///< dynamics and actuators of all cars
  LidarOptions lidar{};  ///< scanner of all cars
  CollisionResponse wall_response = CollisionResponse::stop;
  CollisionResponse body_response = CollisionResponse::stop;
  /// As f1tenth_gym: walls are hit by TimeToCollision instead of by the car's outline; a car that hits one
  /// stays at its new position, and its speed, yaw, yaw rate and slip become 0; cars may start in walls and
  /// in each other; reset() makes one step with zero commands. The LiDAR must have `gym`, too.
  bool gym = false;

  /// Returns the options with which a world behaves like f1tenth_gym: `gym` of every part, one integration
  /// step per time step, LiDAR at the centre of gravity, and cars that drive through each other. Load the map
  /// with MapRule::grey_threshold and construct the track without walls outside.
  static WorldOptions gym_compatible();

  void validate() const;  ///< throws std::invalid_argument naming the field, its value and the rule it breaks
};

template <class Options, class Visit>
requires is_options_of<Options, WorldOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.time_step, {"time_step", "s", "duration of a step", 1e-5, 0.1});
  visit_options(o.lidar, visit);
  visit_options(o.plant, visit);
  visit_options(o.car, visit);
  visit(o.wall_response, {"wall_response", "", "effect of a collision with a wall"});
  visit(o.body_response, {"body_response", "", "effect of a collision with a car, disc or box"});
}

/// The measurements of one car and its collisions. Spans are valid until the world changes.
struct Observation {
  maps::Pose pose;                     ///< pose of the centre of gravity, map frame
  maps::Pose sensor;                   ///< pose of the LiDAR when it scanned, map frame
  double speed = 0;                    ///< m/s, along the direction of travel
  double steer = 0;                    ///< rad, of the front wheels
  double yaw_rate = 0;                 ///< rad/s
  double slip = 0;                     ///< rad
  double time = 0;                     ///< s since the reset
  double scan_time = 0;                ///< s since the reset, when `scan` was taken
  maps::LaserScanView scan;            ///< scan in the frame of `sensor`; without a hit a range is range_max
  std::span<const double> gym_ranges;  ///< the ranges in float64, with LidarOptions::gym only
  bool wall = false;                   ///< collides with a wall in this step
  std::span<const int> colliding;      ///< bodies that it collides with in this step, ascending

  bool collides() const { return wall || !colliding.empty(); }  ///< whether it collides with a wall or a body
};

/// Result of a step. If both errors apply, it is non_finite_command.
enum class StepStatus {
  ok,
  missing_command,     ///< fewer commands than cars; the others coasted
  non_finite_command,  ///< a command was not finite; its car coasted
};

/// Bodies are numbered: driven cars first, then parked cars in their order, then those placed later.
class World {
 public:
  /// Throws std::invalid_argument on a missing track or options out of range.
  World(const WorldOptions& options, std::shared_ptr<const Track> track);

  /// Starts again with driven cars at rest at `cars` and parked ones at `parked`, without other bodies.
  /// Throws std::invalid_argument on poses that are not finite and driven cars that start in walls or bodies.
  void reset(std::uint64_t seed, std::span<const maps::Pose> cars, std::span<const maps::Pose> parked = {});

  /// Adds a parked car and returns its index. It may be placed onto a car. Throws std::invalid_argument if
  /// the size of a body is not positive or its pose is not finite; so do `add_box` and `add_disc`.
  int add_parked_car(const maps::Pose& pose);
  int add_box(const Box& box);     ///< adds a fixed body and returns its index
  int add_disc(const Disc& disc);  ///< adds a fixed body and returns its index
  /// Moves a parked car, box or disc. Throws std::invalid_argument on a body that drives or does not exist.
  void move_body(int body, const maps::Pose& pose);
  /// Removes a parked car, box or disc. The numbers of later bodies fall by one. Throws as move_body does.
  void remove_body(int body);

  /// Puts a driven car into a state, unchecked for collisions. Delayed commands still take effect. Throws
  /// std::invalid_argument on a state that is not finite and std::out_of_range on a car that does not exist.
  void set_state(std::size_t car, const CarState& state);

  /// Moves by one time step. Command i is for driven car i; cars without one roll on.
  StepStatus step(std::span<const Command> commands) noexcept;

  /// Moves by one time step and puts the driven cars into these states, for replays. Finds collisions and
  /// laps, but no car responds. With `gym` it does not find collisions with walls. A car that
  /// was taken away is moved, too, and stays off the track. Throws std::invalid_argument on states that are
  /// not finite or not as many as driven cars.
  void follow(std::span<const CarState> states);

  /// Takes a driven car off the track, until the next reset: it stands still, collides with nothing, does not
  /// scan, and is in no scan of the others. Its number, state and laps stay. Throws std::out_of_range on a
  /// car that does not exist.
  void take_away(std::size_t car);
  /// Whether a driven car has not been taken away; `car` must be less than `cars()`.
  bool on_track(std::size_t car) const noexcept { return !cars_[car].away; }

  /// Sets whether a car scans. New cars do, and a car keeps the setting over a reset. Throws
  /// std::out_of_range on a car that does not exist.
  void set_scanning(std::size_t car, bool scans);

  /// Scan and state of a car. Here and in the three functions below, `car` must be less than `cars()`.
  Observation observe(std::size_t car) const noexcept;
  /// State of a car.
  const CarState& state(std::size_t car) const noexcept { return cars_[car].plant.state(); }
  /// Laps by arc length; nullptr if the track has no lap path.
  const LapTimer* laps(std::size_t car) const noexcept {
    return cars_[car].timer ? &*cars_[car].timer : nullptr;
  }
  /// Laps as f1tenth_gym counts them.
  const StartZoneLaps& start_zone_laps(std::size_t car) const noexcept { return cars_[car].zone; }

  /// Per body, whether it collides with another body in this step, and for driven cars also with a wall:
  /// f1tenth_gym's collision flags. Parked bodies that overlap each other stay flagged.
  std::span<const std::uint8_t> flags() const noexcept { return flags_; }
  /// Returns the last of the bodies with which a body collides, -1 if none: f1tenth_gym's collision_idx. Here
  /// and in `outline` and `disc`, `body` must be less than `bodies()`.
  int last_partner(std::size_t body) const noexcept { return partners_[body]; }

  double time() const noexcept { return time_; }              ///< s since the reset
  std::int64_t steps() const noexcept { return steps_; }      ///< number of steps since the reset
  std::size_t cars() const noexcept { return cars_.size(); }  ///< number of cars that drive
  /// Number of bodies: cars first, then fixed bodies.
  std::size_t bodies() const noexcept { return cars_.size() + fixed_.size(); }
  Box outline(std::size_t body) const noexcept;  ///< the outline of a body; a disc as the square about it
  std::optional<Disc> disc(std::size_t body) const noexcept;         ///< the disc of a body, if it is one
  const WorldOptions& options() const noexcept { return options_; }  ///< the options given at construction
  const Track& track() const noexcept { return *track_; }            ///< the track
  const Lidar& lidar() const noexcept { return lidar_; }             ///< the scanner of all cars

 private:
  struct DrivenCar {
    explicit DrivenCar(Plant made) : plant(std::move(made)) {}
    Plant plant;
    CarState before;
    StartZoneLaps zone;
    std::optional<LapTimer> timer;
    NormalNoise noise;
    NumpyRandom gym_noise{12345};
    std::vector<float> ranges;       ///< padded
    std::vector<double> gym_ranges;  ///< ranges with LidarOptions::gym only
    std::vector<int> colliding;
    maps::Pose sensor;
    double scan_time = 0;
    bool wall = false;
    bool scans = true;
    bool away = false;
    bool struck = false;  ///< whether it was struck in this step, with CollisionResponse::slide_unless_struck
  };
  /// A parked car, box or disc.
  struct Fixed {
    Box box{};
    double disc_radius = 0;  ///< m, above 0 for discs
    int last_partner = -1;   ///< among the fixed ones

    Disc disc() const { return {{box.pose.x, box.pose.y}, disc_radius}; }
  };

  int add(const Fixed& body);
  void place(std::size_t car, const maps::Pose& start, double heading);
  void check_start(std::size_t car) const;
  Fixed& fixed(int body);
  bool collides(const Box& car, const Fixed& body) const noexcept;
  void find_fixed_partners() noexcept;
  void find_collisions() noexcept;
  void respond(std::size_t car) noexcept;
  bool was_struck(std::size_t car) const noexcept;
  bool is_free(std::size_t car, const maps::Pose& pose) const noexcept;
  void slide(std::size_t car, const CarState& tried, CarState& state) const noexcept;
  void scan_walls(DrivenCar& car) noexcept;
  void cast_bodies(std::size_t car) noexcept;
  void add_noise(DrivenCar& car) noexcept;
  void publish(DrivenCar& car) noexcept;
  void gym_scan_and_collisions() noexcept;
  void scan_if_due() noexcept;
  void count_laps() noexcept;

  WorldOptions options_;
  std::shared_ptr<const Track> track_;
  Lidar lidar_;
  TimeToCollision time_to_collision_;
  std::vector<DrivenCar> cars_;
  std::vector<Fixed> fixed_;
  std::vector<Box> boxes_;  ///< boxes of driven cars, as moved in this step
  std::vector<std::uint8_t> flags_;
  std::vector<int> partners_;
  double time_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t scan_every_ = 1;
};

/// Counts the collisions of a car, for instance over a lap.
class CollisionLog {
 public:
  /// Records the collisions of a step. Call it after each step of the world.
  void update(const World& world, std::size_t car);

  /// Number of collisions: different bodies that the car collided with, all walls together as one.
  int collisions() const noexcept { return static_cast<int>(bodies_.size()) + wall_; }
  bool hit_wall() const noexcept { return wall_; }  ///< whether it collided with a wall
  std::span<const int> bodies() const noexcept {
    return bodies_;
  }  ///< bodies with which it collided, ascending
  /// Number of different patterns of the fixed bodies' collision flags seen while the car collided, as the
  /// evaluation of K. Honda et al. (proj-svg_mppi) counts them. A wall alone is the pattern of no flag, two
  /// bodies at once are a pattern of their own.
  int flag_patterns() const noexcept { return static_cast<int>(patterns_.size()); }

 private:
  std::vector<int> bodies_;
  std::vector<std::vector<std::uint8_t>> patterns_;
  bool wall_ = false;
};

}  // namespace slalom::sim
