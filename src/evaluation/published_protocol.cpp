// The evaluation of the program that Honda et al. (ICRA 2024) released: f1tenth_gym with its placement of
// obstacles, its message types and its count of laps and collisions. Everything that exists only to reproduce
// it is here.

#include "evaluation/lap_rules.hpp"
#include "slalom/core/option_access.hpp"

namespace slalom::evaluation {
namespace {

constexpr double control_period_s = 0.01;  // one simulation step per command

class PublishedRules final : public LapRules {
 public:
  maps::MapRule map_rule() const noexcept override { return maps::MapRule::grey_threshold; }
  bool outside_is_wall() const noexcept override { return false; }
  void complete(Environment& environment, const std::filesystem::path& folder,
                const std::vector<std::filesystem::path>& course_roots) const override {
    const std::string folder_name = std::filesystem::weakly_canonical(folder).filename().string();
    if (const auto known = vehicle::known_course(folder_name, course_roots)) {
      environment.start = known->start;
      environment.start_moved = 0;
      environment.timeout = known->timeout;
    }
  }

  sim::WorldOptions world_options() const override { return sim::WorldOptions::gym_compatible(); }
  void configure(sim::WorldOptions&, const LapSettings&, const vehicle::Configuration&) const override {}
  void check(const LapSettings& settings) const override {
    const auto standard = list_options(LapSettings{}), chosen = list_options(settings);
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      if (!(chosen[i] == standard[i]))
        throw std::invalid_argument(std::string(chosen[i].declaration.name) + ": must be " +
                                    to_text(standard[i].value) + " in the published evaluation");
    }
    if (settings.hardware) throw std::invalid_argument("hardware: not available in the published evaluation");
  }
  double control_period(const vehicle::Configuration&) const noexcept override { return control_period_s; }

  std::vector<maps::Pose> place_obstacles(const Environment& environment, int obstacles, std::uint64_t seed,
                                          const maps::Point&, const sim::CarParameters&) const override {
    return sim::place_at_random(environment.course.obstacle_path, obstacles, seed);
  }

  maps::LaserScanView scan(const sim::Observation& seen, const sim::World& world) const noexcept override {
    // The simulator's messages divide the field of view by the number of beams, one more than there are
    // intervals, and carry float32.
    const sim::LidarOptions& lidar = world.lidar().options();
    maps::LaserScanView scan = seen.scan;
    scan.angle_min = static_cast<float>(lidar.angle_min());
    scan.angle_increment = static_cast<float>(lidar.field_of_view / lidar.beams);
    return scan;
  }
  Command command(const Command& planned) const noexcept override {
    return {static_cast<float>(planned.steer), static_cast<float>(planned.speed)};
  }

  bool finishes_open_courses() const noexcept override { return false; }
  bool lap_complete(const sim::World& world, double progress) const noexcept override {
    // The gym's count alone would accept a car that leaves the start zone and reverses into it.
    const sim::StartZoneLaps& zone = world.start_zone_laps(0);
    return zone.laps() > 0 && zone.near_start() && progress > 0.5;
  }
  double lap_time(const sim::World& world) const noexcept override { return world.time(); }
  int collisions(const sim::CollisionLog& log) const noexcept override { return log.flag_patterns(); }
};

}  // namespace

const LapRules& detail::published_rules() noexcept {
  static const PublishedRules rules;
  return rules;
}

}  // namespace slalom::evaluation
