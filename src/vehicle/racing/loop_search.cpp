#include "vehicle/racing/map_corridor.hpp"

#include <deque>
#include <queue>
#include <utility>

#include "vehicle/course/curve.hpp"
#include "vehicle/racing/cell_regions.hpp"

namespace slalom::vehicle::detail {
namespace {

constexpr std::size_t max_areas = 3;    // largest areas of free space that are searched
constexpr std::size_t max_islands = 5;  // largest islands of an area that are tried
constexpr double alike = 0.7;  // share of the best length for width, from which another way is a rival

int extent(const CellRegion& region) {
  return std::max(region.right - region.left, region.top - region.bottom);
}

/// Numbers of regions by falling extent.
std::vector<int> largest(const CellRegions& regions, std::size_t most) {
  std::vector<int> order;
  for (std::size_t k = 0; k < regions.regions().size(); ++k) order.push_back(static_cast<int>(k));
  const auto bigger = [&](int a, int b) {
    return extent(regions.regions()[a]) > extent(regions.regions()[b]);
  };
  std::stable_sort(order.begin(), order.end(), bigger);
  order.resize(std::min(order.size(), most));
  return order;
}

/// One connected area of free space, and the ways through it. A ring of cells around the map is outside it.
class Area {
 public:
  Area(const FreeSpace& space, const CellRegions& areas, int number)
      : space_(space), width_(space.map().width + 2), height_(space.map().height + 2) {
    inside_.assign(static_cast<std::size_t>(width_) * height_, 0);
    for (int y = 0; y < space.map().height; ++y)
      for (int x = 0; x < space.map().width; ++x)
        if (areas.at(x, y) == number) inside_[index(x + 1, y + 1)] = 1;
  }

  /// The regions of cells outside the area; that of cell (0, 0) surrounds it, the others are islands.
  CellRegions islands() const {
    return CellRegions(width_, height_, true, [&](int x, int y) { return !inside_[index(x, y)]; });
  }

  /// A closed way round an island; empty if none is found.
  std::vector<maps::Point> way_round(const CellRegions& islands, int island) const {
    const std::vector<int> cut = cut_from(islands, island);
    std::vector<char> open = inside_;
    int middle = -1;
    for (std::size_t k = 0; k < cut.size(); ++k) {
      if (!inside_[cut[k]]) continue;
      open[cut[k]] = 0;
      if (middle < 0 || clearance(cut[k]) > clearance(cut[middle])) middle = static_cast<int>(k);
    }
    if (middle < 0) return {};
    const auto [left, right] = sides(cut, middle, open);
    if (left < 0 || right < 0) return {};
    std::vector<maps::Point> way = shortest(left, right, open);
    if (!way.empty()) way.push_back(point(cut[middle]));
    return way;
  }

 private:
  static constexpr int steps[8][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}, {1, 1}, {-1, 1}, {-1, -1}, {1, -1}};

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }
  int column(int cell) const { return cell % width_; }
  int row(int cell) const { return cell / width_; }
  double clearance(int cell) const { return space_.clearance(column(cell) - 1, row(cell) - 1); }
  maps::Point point(int cell) const { return space_.centre(column(cell) - 1, row(cell) - 1); }

  template <class Visit>
  void neighbours(int cell, int count, const Visit& visit) const {
    for (int k = 0; k < count; ++k) {
      const int x = column(cell) + steps[k][0], y = row(cell) + steps[k][1];
      if (x >= 0 && y >= 0 && x < width_ && y < height_) visit(static_cast<int>(index(x, y)), k);
    }
  }

  /// The shortest chain of cells from an island to the surroundings: every way round the island crosses it.
  std::vector<int> cut_from(const CellRegions& islands, int island) const {
    const int surroundings = islands.at(0, 0);
    const auto region = [&](int cell) { return islands.at(column(cell), row(cell)); };
    std::vector<int> parent(inside_.size(), -1);
    std::deque<int> front;
    for (int cell = 0; cell < static_cast<int>(inside_.size()); ++cell)
      if (region(cell) == island) {
        parent[cell] = cell;
        front.push_back(cell);
      }
    for (; !front.empty(); front.pop_front()) {
      const int cell = front.front();
      if (region(cell) == surroundings) {
        std::vector<int> cut;
        for (int at = cell; parent[at] != at; at = parent[at]) cut.push_back(at);
        return cut;
      }
      neighbours(cell, 4, [&](int next, int) {
        if (parent[next] >= 0) return;
        parent[next] = cell;
        front.push_back(next);
      });
    }
    return {};
  }

  /// Open cells on both sides of the cut, next to its cell number `middle`; -1 where there is none.
  std::pair<int, int> sides(const std::vector<int>& cut, int middle, const std::vector<char>& open) const {
    const auto cut_cell = [&](int k) {
      return cut[static_cast<std::size_t>(std::clamp<int>(k, 0, static_cast<int>(cut.size()) - 1))];
    };
    const int here = cut_cell(middle), before = cut_cell(middle - 3), after = cut_cell(middle + 3);
    const double along_x = column(after) - column(before), along_y = row(after) - row(before);
    int left = -1, right = -1;
    double best_left = 1e300, best_right = 1e300;
    for (int dy = -4; dy <= 4; ++dy)
      for (int dx = -4; dx <= 4; ++dx) {
        const int x = column(here) + dx, y = row(here) + dy;
        if (x < 0 || y < 0 || x >= width_ || y >= height_ || !open[index(x, y)]) continue;
        const double size = std::hypot(along_x, along_y) * std::hypot(dx, dy);
        const double side = (along_x * dy - along_y * dx) / size;  // sine of the angle to the cut
        if (std::abs(side) < 0.8) continue;
        double& best = side > 0 ? best_left : best_right;
        if (std::hypot(dx, dy) >= best) continue;
        best = std::hypot(dx, dy);
        (side > 0 ? left : right) = static_cast<int>(index(x, y));
      }
    return {left, right};
  }

  /// The way between two cells along which the integral of 1 / clearance is least (Dijkstra).
  std::vector<maps::Point> shortest(int from, int to, const std::vector<char>& open) const {
    std::vector<double> cost(inside_.size(), std::numeric_limits<double>::infinity());
    std::vector<int> parent(inside_.size(), -1);
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> front;
    cost[from] = 0;
    front.emplace(0, from);
    while (!front.empty() && front.top().second != to) {
      const auto [reached, cell] = front.top();
      front.pop();
      if (reached > cost[cell]) continue;
      neighbours(cell, 8, [&, cell = cell, reached = reached](int next, int k) {
        if (!open[next]) return;
        const double total =
            reached + (k < 4 ? 1 : std::sqrt(2.0)) * (1 / clearance(cell) + 1 / clearance(next));
        if (total >= cost[next]) return;
        cost[next] = total;
        parent[next] = cell;
        front.emplace(total, next);
      });
    }
    std::vector<maps::Point> way;
    if (front.empty()) return way;
    for (int cell = to; cell >= 0; cell = parent[cell]) way.push_back(point(cell));
    return way;
  }

  const FreeSpace& space_;
  int width_, height_;
  std::vector<char> inside_;
};

double enclosed_area(const std::vector<maps::Point>& loop) {
  double sum = 0;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    sum += 0.5 * cross(loop[i], loop[(i + 1) % loop.size()]);
  }
  return sum;
}

/// The length of a loop over its mean clearance: great for a road, small for a way round furniture in a hall.
double slenderness(const FreeSpace& space, const std::vector<maps::Point>& loop) {
  double sum = 0;
  for (const maps::Point& point : loop) sum += space.clearance(point);
  return loop.empty() ? 0 : length(loop) * static_cast<double>(loop.size()) / sum;
}

double distance_to(const std::vector<maps::Point>& loop, const maps::Point& point) {
  double least = std::numeric_limits<double>::infinity();
  for (const maps::Point& p : loop) least = std::min(least, std::hypot(p.x - point.x, p.y - point.y));
  return least;
}

}  // namespace

std::vector<maps::Point> find_loop(const FreeSpace& space, double keep,
                                   const std::optional<maps::Point>& near,
                                   std::optional<maps::Point>& rival) {
  const CellRegions areas(space.map().width, space.map().height, false,
                          [&](int x, int y) { return space.clearance(x, y) >= keep; });
  std::vector<maps::Point> best;
  double best_slenderness = 0, second = 0;
  for (const bool surroundings : {false, true}) {
    std::size_t searched = 0;
    for (const int area : largest(areas, areas.regions().size())) {
      if (areas.regions()[area].at_border != surroundings) continue;
      if (++searched > max_areas) break;
      const Area ground(space, areas, area);
      const CellRegions islands = ground.islands();
      for (const int island : largest(islands, max_islands + 1)) {
        if (island == islands.at(0, 0)) continue;
        std::vector<maps::Point> loop = ground.way_round(islands, island);
        double slender = slenderness(space, loop);
        const bool passes =
            !near || distance_to(loop, *near) <= std::max(4 * keep, 1.5 * space.clearance(*near));
        if (loop.empty() || !passes) continue;
        if (slender > best_slenderness) {
          std::swap(best, loop);
          std::swap(best_slenderness, slender);
        }
        if (slender <= second) continue;
        second = slender;
        rival = loop[loop.size() / 2];
      }
    }
    if (!best.empty()) break;
  }
  if (second < alike * best_slenderness) rival.reset();
  if (enclosed_area(best) < 0) std::reverse(best.begin(), best.end());
  return best;
}

}  // namespace slalom::vehicle::detail
