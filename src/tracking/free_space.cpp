#include "tracking/free_space.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::tracking {
namespace {

constexpr double odometry_error = 0.1;  // m per m from one scan to the other: added to margins
constexpr double margin_angle = 0.02;   // rad, times the distance: added to margins
constexpr double max_window = 40;       // beams to either side of a place
constexpr double min_entered = 0.4;     // share of the readings of a cluster
constexpr int min_left = 3;             // readings
constexpr double max_unmoved = 0.3;     // share of the readings of a cluster

struct Sight {
  bool through = false;  ///< all beams at the place went on behind it
  bool there = false;    ///< a beam ended at the place
};

/// Classifies a place by a scan. Free space must be seen all about it: at the horizon of a curved wall the
/// beams beside a reading go on behind it.
Sight sight(const Readings& scan, const maps::Point& place, double margin) noexcept {
  const maps::Point at = maps::inverse_transform(scan.sensor(), place);
  const double distance = std::hypot(at.x, at.y), slack = margin + margin_angle * distance;
  const int beam = scan.beam_at(std::atan2(at.y, at.x));
  const int about = saturate_cast<int>(
      std::clamp(std::ceil(margin / (std::max(distance, margin) * scan.increment())), 1.0, max_window));
  if (beam < about || beam + about >= scan.beams()) return {};
  Sight seen;
  int behind = 0, hits = 0;
  for (int i = beam - about; i <= beam + about; ++i) {
    const double range = scan.range(i);
    if (range == 0 || std::isinf(range)) continue;
    ++hits;
    behind += range > distance + slack;
    if (std::abs(i - beam) <= 1) seen.there = seen.there || std::abs(range - distance) < slack;
  }
  seen.through = hits > 0 && behind == hits;
  return seen;
}

/// m between two poses.
double way(const maps::Pose& a, const maps::Pose& b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

}  // namespace

FreeSpace::FreeSpace(int max_beams) {
  left_.reserve(std::size(compared) * max_beams);
  past_.resize(scans, {0, Readings(max_beams, 1e300)});
}

const FreeSpace::Past* FreeSpace::past(int back) const noexcept {
  if (kept_ == 0) return nullptr;
  return &past_[(last_ + scans - std::min(back, kept_ - 1)) % scans];
}

void FreeSpace::keep(const Readings& scan, double stamp) noexcept {
  const Past* newest = past(0);
  if (newest && stamp - newest->stamp < spacing) return;
  last_ = (last_ + 1) % scans;
  kept_ = std::min(kept_ + 1, scans);
  // The vectors have the same sizes, so this does not allocate.
  Past& kept = past_[last_];
  kept.stamp = stamp;
  kept.scan = scan;
}

void FreeSpace::find_left(const Readings& scan, double stamp, double margin) noexcept {
  left_.clear();
  here_ = scan.sensor();
  for (const int back : compared) {
    const Past* before = past(back);
    if (!before || stamp - before->stamp < spacing) continue;
    const double apart = margin + odometry_error * way(before->scan.sensor(), here_);
    for (const Reading& reading : before->scan.all())
      if (sight(scan, reading.point, apart).through) left_.push_back(reading.point);
  }
}

bool FreeSpace::moves(std::span<const Reading> cluster, double margin, double reach) const noexcept {
  const double size = cluster.size();
  const maps::Point& middle = cluster[cluster.size() / 2].point;
  const auto left_near = std::count_if(left_.begin(), left_.end(), [&](const maps::Point& p) {
    return std::hypot(p.x - middle.x, p.y - middle.y) < reach;
  });
  for (const int back : compared) {
    const Past* before = past(back);
    if (!before) continue;
    const double apart = margin + odometry_error * way(before->scan.sensor(), here_);
    int entered = 0, there = 0;
    for (const Reading& reading : cluster) {
      const Sight seen = sight(before->scan, reading.point, apart);
      entered += seen.through;
      there += seen.there;
    }
    if (entered >= 2 && entered >= min_entered * size) return true;
    if (left_near >= min_left && there <= max_unmoved * size) return true;
  }
  return false;
}

}  // namespace slalom::tracking
