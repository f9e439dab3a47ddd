#include "slalom/vehicle/localisation/localiser.hpp"

#include <optional>
#include <stdexcept>

#include "bridge/convert.hpp"

namespace slalom_bridge {
namespace {

slalom::maps::OccupancyGrid grid_of(const Grid& g) {
  using slalom::maps::Occupancy;
  slalom::maps::OccupancyGrid made;
  made.width = g.width;
  made.height = g.height;
  made.resolution = g.resolution;
  made.origin = pose(g.origin);
  for (const std::int8_t cell : g.cells)
    made.cells.push_back(cell < 0 ? Occupancy::unknown : cell >= 50 ? Occupancy::occupied : Occupancy::free);
  return made;
}

}  // namespace

struct Localiser::Hidden {
  slalom::vehicle::LocaliserOptions options;
  slalom::maps::OccupancyGrid map;
  std::optional<slalom::vehicle::Localiser> localiser;
  std::optional<slalom::maps::Pose> start;  ///< the last pose that was told or reliable; none: everywhere

  void start_again() {
    if (start)
      localiser->start_at(*start);
    else
      localiser->start_everywhere();
  }
};

Localiser::Localiser() : hidden_(std::make_unique<Hidden>()) {}
Localiser::~Localiser() = default;

std::vector<Option> Localiser::options() const {
  std::vector<Option> all;
  for (const auto& entry : slalom::list_options(hidden_->options)) all.push_back(plain("", entry));
  return all;
}

void Localiser::change(const Changes& changes) {
  auto changed = hidden_->options;
  for (const auto& [name, text] : changes) {
    try {
      if (slalom::set_option(changed, name, text)) continue;
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("key " + name + ": " + error.what());
    }
    throw std::invalid_argument("key " + name + ": unknown option of the localiser");
  }
  changed.validate();
  if (hidden_->localiser) {
    hidden_->localiser = slalom::vehicle::Localiser(hidden_->map, changed);
    hidden_->start_again();
  }
  hidden_->options = changed;
}

void Localiser::use_map(const Grid& map) {
  slalom::maps::OccupancyGrid grid = grid_of(map);
  hidden_->localiser = slalom::vehicle::Localiser(grid, hidden_->options);
  hidden_->map = std::move(grid);
  hidden_->start.reset();
}

bool Localiser::has_map() const {
  return hidden_->localiser.has_value();
}
Pose Localiser::laser() const {
  return {hidden_->options.laser_x, hidden_->options.laser_y, hidden_->options.laser_yaw};
}
void Localiser::start_at(const Pose& at) {
  if (!hidden_->localiser) return;
  hidden_->start = pose(at);
  hidden_->start_again();
}
void Localiser::start_everywhere() {
  if (!hidden_->localiser) return;
  hidden_->start.reset();
  hidden_->start_again();
}

Estimate Localiser::update(const Scan& scan, const Pose& odometry, double stamp) {
  Estimate e;
  if (!hidden_->localiser) {
    e.status = "no map";
    return e;
  }
  const auto& out = hidden_->localiser->update({view(scan), pose(odometry), stamp});
  e.pose = plain(out.pose);
  e.odometry_frame = plain(hidden_->localiser->odometry_frame());
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) e.covariance[i][j] = out.covariance[i][j];
  e.usable = out.status == slalom::vehicle::LocaliserStatus::ok;
  if (e.usable) hidden_->start = out.pose;
  e.status = slalom::vehicle::name(out.status);
  e.health = out.health;
  e.fit = out.fit;
  e.share = out.share;
  e.effective_samples = out.effective_samples;
  e.update_time = out.update_time;
  e.particles = out.particles;
  e.searching = out.searching;
  return e;
}

std::vector<Pose> Localiser::particles(int most) const {
  std::vector<Pose> some;
  if (!hidden_->localiser || most < 1) return some;
  const int count = hidden_->localiser->particle_count(), step = (count + most - 1) / most;
  for (int i = 0; i < count; i += step) some.push_back(plain(hidden_->localiser->particle(i).pose));
  return some;
}

}  // namespace slalom_bridge
