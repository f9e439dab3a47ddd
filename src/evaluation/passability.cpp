#include "slalom/evaluation/passability.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "slalom/core/numbers/count.hpp"

namespace slalom::evaluation {
namespace {

/// The cells around a body that the centre of the disc can occupy.
class Window {
 public:
  Window(const sim::Track& track, std::span<const sim::Box> bodies, const maps::Point& centre,
         const PassabilityOptions& options)
      : track_(track), bodies_(bodies), radius_(options.radius), reach_(options.window), centre_(centre) {
    resolution_ = track.grid().resolution;
    half_ = static_cast<int>(count(options.window, resolution_, 1e4, "passability: the window"));
    side_ = 2 * half_ + 1;
    seen_.assign(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0);
  }

  /// Whether a disc can move from one point to the other: flood fill over free cells and their eight
  /// neighbours.
  bool connects(const maps::Point& from, const maps::Point& to) {
    const auto start = nearest_free(from), goal = nearest_free(to);
    if (!start || !goal) return false;
    std::vector<int> open{*start};
    seen_[static_cast<std::size_t>(*start)] = 1;
    while (!open.empty()) {
      const int cell = open.back();
      open.pop_back();
      if (cell == *goal) return true;
      const int column = cell % side_, row = cell / side_;
      for (int r = std::max(0, row - 1); r <= std::min(side_ - 1, row + 1); ++r) {
        for (int c = std::max(0, column - 1); c <= std::min(side_ - 1, column + 1); ++c) {
          const auto next = static_cast<std::size_t>(r * side_ + c);
          if (seen_[next]) continue;
          seen_[next] = 1;
          if (is_free(point(c, r))) open.push_back(r * side_ + c);
        }
      }
    }
    return false;
  }

 private:
  maps::Point point(int column, int row) const {
    return {centre_.x + resolution_ * (column - half_), centre_.y + resolution_ * (row - half_)};
  }

  /// Errs towards free: a trajectory may pass 0.71 cells from the centre of a cell, and walls are known to
  /// one cell.
  bool is_free(const maps::Point& at) const {
    if (std::hypot(at.x - centre_.x, at.y - centre_.y) > reach_) return false;
    if (track_.distance_to_wall(at) + 1.75 * resolution_ < radius_) return false;
    const sim::Disc disc{at, std::max(radius_ - 0.75 * resolution_, 0.0)};
    return std::none_of(bodies_.begin(), bodies_.end(),
                        [&](const sim::Box& body) { return sim::signed_gap(body, disc) <= 0; });
  }

  /// The free cell nearest to a point, within 1 m, since another body may stand on the path.
  std::optional<int> nearest_free(const maps::Point& at) const {
    const int column = half_ + saturate_cast<int>(std::round((at.x - centre_.x) / resolution_)),
              row = half_ + saturate_cast<int>(std::round((at.y - centre_.y) / resolution_)),
              most = saturate_cast<int>(std::ceil(1 / resolution_));
    std::optional<int> best;
    int best_square = most * most + 1;
    for (int r = std::max(0, row - most); r <= std::min(side_ - 1, row + most); ++r) {
      for (int c = std::max(0, column - most); c <= std::min(side_ - 1, column + most); ++c) {
        const int square = (r - row) * (r - row) + (c - column) * (c - column);
        if (square >= best_square || !is_free(point(c, r))) continue;
        best_square = square;
        best = r * side_ + c;
      }
    }
    return best;
  }

  const sim::Track& track_;
  std::span<const sim::Box> bodies_;
  double radius_, reach_, resolution_ = 0;
  maps::Point centre_;
  int half_ = 0, side_ = 0;
  std::vector<std::uint8_t> seen_;
};

}  // namespace

std::vector<int> impassable_obstacles(const sim::Track& track, std::span<const sim::Box> bodies,
                                      const PassabilityOptions& options) {
  std::vector<int> closed;
  const sim::LapPath* path = track.lap_path();
  if (!path) return closed;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const maps::Point centre{bodies[i].pose.x, bodies[i].pose.y};
    const double arc = path->project(centre).arc;
    const maps::Pose before = path->at(arc - options.reach), behind = path->at(arc + options.reach);
    if (!Window(track, bodies, centre, options).connects({before.x, before.y}, {behind.x, behind.y}))
      closed.push_back(static_cast<int>(i));
  }
  return closed;
}

}  // namespace slalom::evaluation
