#include "slalom/evaluation/grid_race.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "evaluation/driver/driver_stack.hpp"
#include "evaluation/racing/race_watch.hpp"
#include "evaluation/racing/starting_grid.hpp"

namespace slalom::evaluation {
namespace {

constexpr double not_finished = std::numeric_limits<double>::quiet_NaN();
constexpr double pushed_time = 1;  // s, from a contact to the wall that is told with it

void require_of_race(bool holds, const std::string& message) {
  if (!holds) throw std::invalid_argument(message);
}

void check_in(const char* option, double value, double least, double most) {
  require_of_race(value >= least && value <= most, std::string(option) + ": " + std::to_string(value) +
                                                       " must be in [" + std::to_string(least) + ", " +
                                                       std::to_string(most) + "]");
}

double line_of(const LapRunner& driver) {
  return driver.environment().track->lap_path()->project({driver.start().x, driver.start().y}).arc;
}

/// A race from the start on. Its cars have their numbers in the world, which are their places on the grid.
class RaceUnderWay {
 public:
  RaceUnderWay(const GridRace& race, std::uint64_t seed, int rotation);

  bool goes_on() const noexcept { return driving_ > 0 && world_.time() <= race_.timeout(); }
  /// One control period.
  void step(const GridRaceCallback& on_step);
  /// Ends the race for the cars on the track.
  GridRaceResult result(bool cancelled);

 private:
  struct Racer {
    std::optional<DriverStack> driver;
    CarResult result;
    double line_time = 0;    ///< s, when its lap began
    double reached = 0;      ///< m beyond the line, before the step
    double reached_at = 0;   ///< s
    sim::CarState before{};  ///< before the step
  };

  void moved(std::size_t car);
  void end(std::size_t car, CarEnd how, double time);

  const GridRace& race_;
  sim::World world_;
  std::vector<int> entry_of_;
  std::vector<Racer> racers_;
  std::optional<RaceWatch> watch_;
  std::vector<Command> commands_;
  GridRaceResult result_;
  int driving_ = 0;
};

sim::WorldOptions race_world(const LapRunner& driver) {
  sim::WorldOptions options = DriverStack::world_options(driver);
  options.body_response = sim::CollisionResponse::slide_unless_struck;
  return options;
}

RaceUnderWay::RaceUnderWay(const GridRace& race, std::uint64_t seed, int rotation)
    : race_(race), world_(race_world(race.drivers()[0]), race.drivers()[0].environment().track) {
  const int cars = static_cast<int>(race.drivers().size());
  world_.reset(seed, race.grid());
  watch_.emplace(world_, line_of(race.drivers()[0]));
  result_.seed = seed;
  driving_ = cars;
  commands_.resize(race.grid().size());
  entry_of_.resize(race.grid().size());
  racers_.resize(race.grid().size());
  for (int entry = 0; entry < cars; ++entry) {
    const int place = ((entry + rotation) % cars + cars) % cars;
    const auto car = static_cast<std::size_t>(place);
    entry_of_[car] = entry;
    Racer& racer = racers_[car];
    racer.driver.emplace(race.drivers()[static_cast<std::size_t>(entry)], world_, car, seed,
                         " of car " + std::to_string(entry));
    racer.result.grid_place = place;
    racer.before = world_.state(car);
    racer.reached = watch_->distance(world_, car);
  }
}

void RaceUnderWay::step(const GridRaceCallback& on_step) {
  double first = 0;
  for (std::size_t car = 0; car < racers_.size(); ++car) {
    Racer& racer = racers_[car];
    first = std::max(first, watch_->distance(world_, car));
    if (!world_.on_track(car)) continue;
    const DriverStack::Update update = racer.driver->update(world_);
    racer.driver->send(update.output.command, world_);
    ++racer.result.planner_status[static_cast<std::size_t>(update.output.status)];
    if (update.output.solve)
      racer.result.solve_ms.push_back(static_cast<float>(1e3 * update.output.solve->times.total));
  }
  const double whole = race_.options().laps * race_.lap_length();
  if (on_step)
    on_step({world_.time(), std::min(first / whole, 1.0), static_cast<int>(watch_->contacts().size()),
             driving_, world_, entry_of_});
  const auto steps = DriverStack::steps_per_command(race_.drivers()[0], world_);
  for (long long k = 0; k < steps && driving_ > 0; ++k) {
    for (std::size_t car = 0; car < racers_.size(); ++car)
      commands_[car] = world_.on_track(car) ? racers_[car].driver->command(world_) : Command{};
    world_.step(commands_);
    watch_->update(world_);
    for (std::size_t car = 0; car < racers_.size(); ++car)
      if (world_.on_track(car)) moved(car);
  }
}

/// Measures where a car has come in a step, and takes it off the track where the race ends for it.
void RaceUnderWay::moved(std::size_t car) {
  Racer& racer = racers_[car];
  racer.driver->moved(world_);
  const sim::CarState& state = world_.state(car);
  racer.result.distance += std::hypot(state.x - racer.before.x, state.y - racer.before.y);
  racer.before = state;
  const double reached = watch_->distance(world_, car);
  const double line = race_.lap_length() * static_cast<double>(racer.result.lap_times.size() + 1);
  if (reached >= line) {
    const double share = (line - racer.reached) / (reached - racer.reached);
    const double time = racer.reached_at + share * (world_.time() - racer.reached_at);
    racer.result.lap_times.push_back(time - racer.line_time);
    racer.line_time = time;
    if (static_cast<int>(racer.result.lap_times.size()) == race_.options().laps)
      return end(car, CarEnd::finished, time);
  }
  racer.reached = reached;
  racer.reached_at = world_.time();
  if (world_.observe(car).wall) end(car, CarEnd::wall, world_.time());
}

void RaceUnderWay::end(std::size_t car, CarEnd how, double time) {
  CarResult& result = racers_[car].result;
  result.end = how;
  result.time = time;
  result.progress = watch_->distance(world_, car);
  result.last = world_.observe(car).pose;
  result.contact_before = how == CarEnd::wall && time - watch_->last_collision(car) <= pushed_time;
  world_.take_away(car);
  --driving_;
}

GridRaceResult RaceUnderWay::result(bool cancelled) {
  result_.cancelled = cancelled;
  result_.time = world_.time();
  for (std::size_t car = 0; car < racers_.size(); ++car)
    if (world_.on_track(car)) end(car, cancelled ? CarEnd::cancelled : CarEnd::timeout, world_.time());
  result_.contacts = watch_->contacts();
  for (CarContact& contact : result_.contacts) {
    for (const int car : contact.cars) ++racers_[static_cast<std::size_t>(car)].result.contacts;
    ++racers_[static_cast<std::size_t>(contact.at_fault)].result.caused;
    for (int* car : {&contact.cars[0], &contact.cars[1], &contact.at_fault})
      *car = entry_of_[static_cast<std::size_t>(*car)];
  }
  result_.overtakes = watch_->overtakes();
  for (Overtake& overtake : result_.overtakes) {
    ++racers_[static_cast<std::size_t>(overtake.car)].result.overtakes;
    ++racers_[static_cast<std::size_t>(overtake.overtaken)].result.overtaken;
    for (int* car : {&overtake.car, &overtake.overtaken}) *car = entry_of_[static_cast<std::size_t>(*car)];
  }
  result_.cars.resize(racers_.size());
  for (std::size_t car = 0; car < racers_.size(); ++car)
    result_.cars[static_cast<std::size_t>(entry_of_[car])] = std::move(racers_[car].result);
  result_.standings = standings_of(result_.cars);
  const CarResult& winner = result_.cars[static_cast<std::size_t>(result_.standings[0])];
  for (std::size_t place = 0; place < result_.standings.size(); ++place) {
    CarResult& car = result_.cars[static_cast<std::size_t>(result_.standings[place])];
    car.place = static_cast<int>(place);
    car.gap = car.end == CarEnd::finished ? car.time - winner.time : not_finished;
  }
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

GridRace::GridRace(const std::shared_ptr<const Environment>& environment,
                   const std::vector<RaceEntry>& entries, const LapSettings& settings,
                   const GridRaceOptions& options)
    : options_(options) {
  require_of_race(
      entries.size() >= 2 && entries.size() <= static_cast<std::size_t>(most_race_cars),
      "cars: " + std::to_string(entries.size()) + " must be in [2, " + std::to_string(most_race_cars) + "]");
  check_in("laps", options.laps, 1, 1000);
  check_in("place_spacing", options.place_spacing, 0.7, 10);
  check_in("place_offset", options.place_offset, 0, 2);
  for (const RaceEntry& entry : entries)
    drivers_.emplace_back(environment, entry.configuration, entry.method, settings);
  require_of_race(environment->protocol == Protocol::true_physics,
                  "evaluation: must be true in a race of several cars");
  require_of_race(environment->course.closed, "course: must be closed for a race of several cars");
  for (const auto& [option, value, only] :
       {std::tuple("obstacles", settings.obstacles, 0), std::tuple("world.opponents", settings.opponents, 0),
        std::tuple("world.rounds", settings.rounds, 1)})
    require_of_race(value == only, std::string(option) + ": " + std::to_string(value) + " must be " +
                                       std::to_string(only) + " in a race of several cars");
  for (const LapRunner& driver : drivers_) {
    require_of_race(driver.control_period() == drivers_[0].control_period(),
                    "planner.control_period: must be the same for all cars of a race");
    timeout_ = std::max(timeout_, options.laps * driver.timeout());
  }
  grid_ = starting_grid(*environment, line_of(drivers_[0]), static_cast<int>(entries.size()),
                        DriverStack::world_options(drivers_[0]).car, options);
}

GridRaceResult GridRace::run(std::uint64_t seed, int rotation, const GridRaceCallback& on_step,
                             const std::atomic<bool>* cancel) const {
  RaceUnderWay race(*this, seed, rotation);
  bool cancelled = false;
  while (!cancelled && race.goes_on()) {
    race.step(on_step);
    cancelled = cancel && cancel->load(std::memory_order_relaxed) && race.goes_on();
  }
  return race.result(cancelled);
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
