#include "tracking/association.hpp"

namespace slalom::tracking {

double max_diameter(const TrackerOptions& options) noexcept {
  return std::hypot(options.length + 3 * options.size_deviation, options.width + 3 * options.size_deviation);
}

double diameter(std::span<const Reading> readings) noexcept {
  const auto farthest = [&](const maps::Point& from) {
    double most = 0;
    const Reading* found = &readings.front();
    for (const Reading& each : readings) {
      const double distance = std::hypot(each.point.x - from.x, each.point.y - from.y);
      if (distance <= most) continue;
      most = distance;
      found = &each;
    }
    return std::pair{found, most};
  };
  return farthest(farthest(readings.front().point).first->point).second;
}

void find_clusters(std::span<const Reading> readings, double increment, const TrackerOptions& options,
                   std::vector<Cluster>& clusters) noexcept {
  clusters.clear();
  for (std::size_t begin = 0, i = 1; begin < readings.size() && clusters.size() < clusters.capacity(); ++i) {
    if (i < readings.size()) {
      const Reading &a = readings[i - 1], &b = readings[i];
      const double apart = std::hypot(b.point.x - a.point.x, b.point.y - a.point.y);
      if (apart <= break_distance(std::min(a.range, b.range), (b.beam - a.beam) * increment,
                                  options.min_incidence, options.range_deviation))
        continue;
    }
    clusters.push_back({begin, i});
    begin = i;
  }
}

double outline_distance(const maps::Point& point, const Tracked& object) noexcept {
  const maps::Point at = maps::inverse_transform(object.pose(), point);
  const double x = std::abs(at.x) - 0.5 * object.length(), y = std::abs(at.y) - 0.5 * object.width();
  if (x <= 0 && y <= 0) return std::min(-x, -y);
  return std::hypot(std::max(x, 0.0), std::max(y, 0.0));
}

namespace {

/// The object to which a reading most likely belongs, -1 for none.
int owner(const maps::Point& point, std::span<const Tracked> objects,
          const TrackerOptions& options) noexcept {
  int best = -1;
  double least = 0;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const Tracked& object = objects[k];
    const maps::Pose pose = object.pose();
    const double variance = options.range_deviation * options.range_deviation + object.position_variance();
    const double gate = std::min(options.gate * std::sqrt(variance), options.length);
    const double reach = gate + 0.5 * (object.length() + object.width());
    if (std::abs(point.x - pose.x) > reach || std::abs(point.y - pose.y) > reach) continue;
    const double distance = outline_distance(point, object);
    if (distance > gate) continue;
    const double cost = distance * distance / variance + std::log(variance);
    if (best >= 0 && cost >= least) continue;
    best = static_cast<int>(k);
    least = cost;
  }
  return best;
}

}  // namespace

void associate(std::span<const Reading> readings, std::span<const Cluster> clusters,
               std::span<const Tracked> objects, const TrackerOptions& options,
               std::vector<int>& owners) noexcept {
  owners.assign(readings.size(), -1);
  for (const Cluster& cluster : clusters) {
    int only = -1;
    bool several = false;
    std::size_t owned = 0;
    for (std::size_t i = cluster.begin; i < cluster.end; ++i) {
      owners[i] = owner(readings[i].point, objects, options);
      if (owners[i] < 0) continue;
      ++owned;
      several = several || (only >= 0 && owners[i] != only);
      only = owners[i];
    }
    const std::size_t size = cluster.end - cluster.begin;
    if (only < 0 || several || 2 * owned < size ||
        diameter(readings.subspan(cluster.begin, size)) > max_diameter(options))
      continue;
    std::fill(owners.begin() + cluster.begin, owners.begin() + cluster.end, only);
  }
}

}  // namespace slalom::tracking
