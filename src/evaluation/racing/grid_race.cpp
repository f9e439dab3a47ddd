#include "slalom/evaluation/grid_race.hpp"

#include <numeric>

#include "evaluation/driver/car_driver.hpp"
#include "evaluation/lap_setup.hpp"
#include "evaluation/racing/race_watch.hpp"
#include "slalom/core/options.hpp"

namespace slalom::evaluation {
namespace {

constexpr double not_finished = std::numeric_limits<double>::quiet_NaN();
constexpr double place_spacing = 1;    // m, along the course from one place of the grid to the next
constexpr double place_offset = 0.25;  // m, from the course line
constexpr double wall_room = 0.1;      // m, around a car on the grid
constexpr double offset_step = 0.05, back_step = 0.25;  // m, from a place that has no room to the next
constexpr double pushed_time = 1;  // s; a contact this long before a wall is reported with it

/// m, the arc length of the finish line.
double line_of(const GridRace& race) {
  return race.environment->track->lap_path()->project(race.lap(0).start()).arc;
}

/// Judges the race of the cars of a drive: laps, contacts, overtakes, and cars that leave the track. Cars are
/// numbered as in the world, by their places on the grid.
class Referee {
 public:
  /// Construct it before the first step of the world.
  Referee(const GridRace& race, const sim::World& world, int rotation);

  // The observer of the drive.
  void decided(std::size_t car, const PlannerUpdate& update);
  bool moved(sim::World& world);

  /// Describes the race before a control period.
  GridRaceStep step_of(const sim::World& world) const;
  int entry_of(int car) const noexcept { return entry_of_[static_cast<std::size_t>(car)]; }
  int driving() const noexcept { return driving_; }  ///< cars on the track
  /// Ends the race for the cars on the track.
  GridRaceResult result(sim::World& world, bool cancelled);

 private:
  struct Racer {
    CarResult result;
    double line_time = 0;    ///< s, when its lap began
    double reached = 0;      ///< m beyond the line, before the step
    double reached_at = 0;   ///< s
    sim::CarState before{};  ///< before the step
  };
  void moved(sim::World& world, std::size_t car);
  void end(sim::World& world, std::size_t car, CarEnd how, double time);
  CarResult& of(int car) { return racers_[static_cast<std::size_t>(car)].result; }
  void assign_contacts();
  void assign_overtakes();
  void rank();

  int laps_;
  double lap_length_;  ///< m
  std::vector<int> entry_of_;
  std::vector<Racer> racers_;
  RaceWatch watch_;
  GridRaceResult result_;
  int driving_;
};

Referee::Referee(const GridRace& race, const sim::World& world, int rotation)
    : laps_(race.laps),
      lap_length_(race.lap_length()),
      entry_of_(world.cars()),
      racers_(world.cars()),
      watch_(world, line_of(race)),
      driving_(static_cast<int>(world.cars())) {
  result_.cars.resize(racers_.size());
  for (int entry = 0; entry < driving_; ++entry) {
    const auto car = static_cast<std::size_t>(((entry + rotation) % driving_ + driving_) % driving_);
    entry_of_[car] = entry;
    racers_[car].result.grid_place = static_cast<int>(car);
    racers_[car].before = world.state(car);
    racers_[car].reached = watch_.distance(world, car);
  }
}

GridRaceStep Referee::step_of(const sim::World& world) const {
  double first = 0;
  for (std::size_t car = 0; car < racers_.size(); ++car) first = std::max(first, watch_.distance(world, car));
  return {world.time(),
          std::min(first / (laps_ * lap_length_), 1.0),
          static_cast<int>(watch_.contacts().size()),
          driving_,
          world,
          entry_of_};
}

void Referee::decided(std::size_t car, const PlannerUpdate& update) {
  if (!update.output) return;
  CarResult& result = racers_[car].result;
  ++result.planner_status[static_cast<std::size_t>(update.output->status)];
  if (update.output->solve)
    result.solve_ms.push_back(static_cast<float>(1e3 * update.output->solve->times.total));
}

/// Returns whether a car is left on the track.
bool Referee::moved(sim::World& world) {
  watch_.update(world);
  for (std::size_t car = 0; car < racers_.size(); ++car)
    if (world.on_track(car)) moved(world, car);
  return driving_ > 0;
}

/// Measures how far a car has come in a step, and takes it off the track if its race has ended.
void Referee::moved(sim::World& world, std::size_t car) {
  Racer& racer = racers_[car];
  const sim::CarState& state = world.state(car);
  racer.result.distance += std::hypot(state.x - racer.before.x, state.y - racer.before.y);
  racer.before = state;
  const double reached = watch_.distance(world, car);
  const double line = lap_length_ * static_cast<double>(racer.result.lap_times.size() + 1);
  if (reached >= line) {
    const double share = (line - racer.reached) / (reached - racer.reached);
    const double time = racer.reached_at + share * (world.time() - racer.reached_at);
    racer.result.lap_times.push_back(time - racer.line_time);
    racer.line_time = time;
    if (static_cast<int>(racer.result.lap_times.size()) == laps_)
      return end(world, car, CarEnd::finished, time);
  }
  racer.reached = reached;
  racer.reached_at = world.time();
  if (world.observe(car).wall) end(world, car, CarEnd::wall, world.time());
}

void Referee::end(sim::World& world, std::size_t car, CarEnd how, double time) {
  CarResult& result = racers_[car].result;
  result.end = how;
  result.time = time;
  result.progress = watch_.distance(world, car);
  result.last = world.observe(car).pose;
  result.contact_before = how == CarEnd::wall && time - watch_.last_collision(car) <= pushed_time;
  world.take_away(car);
  --driving_;
}

/// Counts the contacts of each car, then numbers their cars by entries.
void Referee::assign_contacts() {
  result_.contacts = watch_.contacts();
  for (CarContact& contact : result_.contacts) {
    for (const int car : contact.cars) ++of(car).contacts;
    ++of(contact.at_fault).caused;
    for (int* car : {&contact.cars[0], &contact.cars[1], &contact.at_fault}) *car = entry_of(*car);
  }
}

/// Counts the overtakes of each car, then numbers their cars by entries.
void Referee::assign_overtakes() {
  result_.overtakes = watch_.overtakes();
  for (Overtake& overtake : result_.overtakes) {
    ++of(overtake.car).overtakes;
    ++of(overtake.overtaken).overtaken;
    overtake = {overtake.time, entry_of(overtake.car), entry_of(overtake.overtaken)};
  }
}

void Referee::rank() {
  result_.standings = standings_of(result_.cars);
  const CarResult& winner = result_.cars[static_cast<std::size_t>(result_.standings[0])];
  for (std::size_t place = 0; place < result_.standings.size(); ++place) {
    CarResult& car = result_.cars[static_cast<std::size_t>(result_.standings[place])];
    car.place = static_cast<int>(place);
    car.gap = car.end == CarEnd::finished ? car.time - winner.time : not_finished;
  }
}

GridRaceResult Referee::result(sim::World& world, bool cancelled) {
  for (std::size_t car = 0; car < racers_.size(); ++car)
    if (world.on_track(car)) end(world, car, cancelled ? CarEnd::cancelled : CarEnd::timeout, world.time());
  assign_contacts();
  assign_overtakes();
  for (std::size_t car = 0; car < racers_.size(); ++car)
    result_.cars[static_cast<std::size_t>(entry_of_[car])] = std::move(racers_[car].result);
  rank();
  result_.cancelled = cancelled;
  result_.time = world.time();
  return std::move(result_);
}

}  // namespace

std::string_view name(CarEnd end) noexcept {
  constexpr std::string_view names[] = {"finished", "wall", "timeout", "interrupted"};
  return names[static_cast<std::size_t>(end)];
}

double CarResult::best_lap() const noexcept {
  const auto best = std::min_element(lap_times.begin(), lap_times.end());
  return best == lap_times.end() ? not_finished : *best;
}

bool GridRaceResult::has_winner() const noexcept {
  return std::any_of(cars.begin(), cars.end(),
                     [](const CarResult& car) { return car.end == CarEnd::finished; });
}

void GridRace::validate() const {
  require(
      drivers.size() >= 2 && drivers.size() <= static_cast<std::size_t>(most_race_cars),
      "cars: " + std::to_string(drivers.size()) + " must be in [2, " + std::to_string(most_race_cars) + "]");
  slalom::detail::check("race", {"laps", "", "laps of each car", 1, 1000}, laps);
  for (std::size_t entry = 0; entry < drivers.size(); ++entry) lap(entry).validate();
  require(environment->protocol == Protocol::true_physics,
          "evaluation: must be true in a race of several cars");
  require(environment->course.closed, "course: must be closed for a race of several cars");
  for (const auto& [option, value, only] :
       {std::tuple("obstacles", settings.obstacles, 0), std::tuple("world.opponents", settings.opponents, 0),
        std::tuple("world.rounds", settings.rounds, 1)})
    require(value == only, std::string(option) + ": " + std::to_string(value) + " must be " +
                               std::to_string(only) + " in a race of several cars");
  for (std::size_t entry = 1; entry < drivers.size(); ++entry)
    require(lap(entry).control_period() == control_period(),
            "planner.control_period: must be the same for all cars of a race");
}

std::vector<maps::Pose> GridRace::grid() const {
  const sim::CarParameters car = world_options(lap(0)).car;
  const sim::LapPath& path = *environment->track->lap_path();
  const double line = line_of(*this);
  const auto pose_at = [&](double arc, double left) -> std::optional<maps::Pose> {
    maps::Pose pose = path.at(arc);
    pose.x -= left * std::sin(pose.yaw);
    pose.y += left * std::cos(pose.yaw);
    if (environment->track->collides_with_wall(
            {.pose = pose, .length = car.length + 2 * wall_room, .width = car.width + 2 * wall_room}))
      return std::nullopt;
    return pose;
  };
  std::vector<maps::Pose> grid;
  double arc = line;
  while (grid.size() < drivers.size()) {
    std::optional<maps::Pose> pose;
    const double side = grid.size() % 2 == 0 ? 1 : -1;
    for (double offset = place_offset; !pose && offset > 0; offset -= offset_step)
      pose = pose_at(arc, side * offset);
    if (!pose) pose = pose_at(arc, 0);
    if (pose) grid.push_back(*pose);
    arc -= pose ? place_spacing : back_step;
    if (line - arc > 0.25 * path.length() && grid.size() < drivers.size())
      throw std::runtime_error("course " + environment->course.name + ": no room for a grid of " +
                               std::to_string(drivers.size()) + " cars");
  }
  return grid;
}

double GridRace::timeout() const {
  double longest = 0;
  for (std::size_t entry = 0; entry < drivers.size(); ++entry)
    longest = std::max(longest, laps * lap(entry).timeout());
  return longest;
}

std::vector<int> standings_of(std::span<const CarResult> cars) {
  std::vector<int> order(cars.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](int i) {
    const CarResult& car = cars[static_cast<std::size_t>(i)];
    const bool finished = car.end == CarEnd::finished;
    return std::tuple(finished ? 0 : 1, finished ? car.time : -car.progress, car.grid_place);
  };
  std::sort(order.begin(), order.end(), [&](int a, int b) { return key(a) < key(b); });
  return order;
}

GridRaceResult GridRace::run(std::uint64_t seed, int rotation, const GridRaceCallback& on_step,
                             const std::atomic<bool>* cancel) const {
  sim::WorldOptions world = world_options(lap(0));
  world.body_response = sim::CollisionResponse::slide_unless_struck;
  CarDrive drive{sim::World(world, environment->track), {}, steps_per_command(lap(0), world)};
  drive.world.reset(seed, grid());
  Referee referee(*this, drive.world, rotation);
  for (std::size_t car = 0; car < drivers.size(); ++car) {
    const int entry = referee.entry_of(static_cast<int>(car));
    drive.drivers.emplace_back(car, PlanningDriver(lap(static_cast<std::size_t>(entry)), drive.world, car,
                                                   seed, " of car " + std::to_string(entry)));
  }
  const double longest = timeout();
  bool cancelled = false;
  const auto goes_on = [&] { return referee.driving() > 0 && drive.world.time() <= longest; };
  while (!cancelled && goes_on()) {
    if (on_step) on_step(referee.step_of(drive.world));
    drive.step(referee);
    cancelled = cancel && cancel->load(std::memory_order_relaxed) && goes_on();
  }
  GridRaceResult result = referee.result(drive.world, cancelled);
  result.seed = seed;
  return result;
}

ContactRate contact_rate(std::span<const GridRaceResult> races, int entry) {
  ContactRate rate;
  for (const GridRaceResult& race : races) {
    for (std::size_t i = 0; i < race.cars.size(); ++i)
      if (entry < 0 || static_cast<int>(i) == entry) rate.kilometres += 1e-3 * race.cars[i].distance;
    for (const CarContact& contact : race.contacts) {
      rate.contacts += entry < 0 || contact.cars[0] == entry || contact.cars[1] == entry;
      rate.caused += entry < 0 || contact.at_fault == entry;
    }
  }
  const double scale = rate.kilometres > 0 ? 100 / rate.kilometres : not_finished;
  const Interval counts = poisson_interval(rate.caused);
  rate.per_100_km = scale * rate.caused;
  rate.interval = {scale * counts.low, scale * counts.high};
  return rate;
}

}  // namespace slalom::evaluation
