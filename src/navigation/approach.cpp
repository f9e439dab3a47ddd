#include "navigation/approach.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::navigation::detail {
namespace {

double direction(const maps::Pose& a, const maps::Pose& b) {
  return std::atan2(b.y - a.y, b.x - a.x);
}

/// How far the yaws at the ends of a way agree with its direction: near 1, or near -1 in reverse; but the
/// goal's.
double agreement(std::span<const maps::Pose> path, std::size_t i) {
  const double along = direction(path[i], path[i + 1]);
  const double begin = std::cos(path[i].yaw - along), end = std::cos(path[i + 1].yaw - along);
  return i + 2 == path.size() || std::abs(begin) >= std::abs(end) ? begin : end;
}

/// Whether the yaws but the goal's are those of a vehicle on the path. Planners may leave all the same.
bool yaws_count(std::span<const maps::Pose> path) {
  const auto differs = [&](const maps::Pose& pose) { return pose.yaw != path.front().yaw; };
  if (std::none_of(path.begin(), path.end() - 1, differs)) return false;
  for (std::size_t i = 0; i + 1 < path.size(); ++i)
    if (distance(position(path[i]), position(path[i + 1])) > least_way &&
        std::abs(agreement(path, i)) < aligned)
      return false;
  return true;
}

constexpr std::size_t most_goals = 30;  // poses, as goals of a search
constexpr double more_room = 0.1;       // radii of room that a manoeuvre keeps if it can

maps::ManoeuvreOptions search_options(const NavigatorOptions& options, const Footprint& footprint) {
  const bool turns = turns_on_the_spot(options.base);
  maps::ManoeuvreOptions made =
      maps::ManoeuvreOptions::of(2 * footprint.circumscribed_radius(),
                                 turns ? 0 : 1.1 * options.base.min_turning_radius);  // the rest corrects
  if (turns) made.bend = 10 * made.step;  // bends away from a wall beside which there is no room to turn
  made.can_reverse = options.base.max_reverse > 0;
  return made;
}

/// The room of a body on a costmap, at poses relative to one.
class CostmapRoom final : public maps::BodyRoom {
 public:
  /// If `turned`, the body faces the other way: its way is driven backward in time.
  CostmapRoom(const Costmap& costmap, const Footprint& footprint, const maps::Pose& from, bool turned)
      : costmap_(costmap), footprint_(footprint), from_(from), turn_(turned ? std::numbers::pi : 0) {}
  double at(const maps::Pose& pose) const noexcept override {
    const maps::Point place = maps::transform(from_, {pose.x, pose.y});
    const maps::Pose here{place.x, place.y, from_.yaw + pose.yaw + turn_};
    const double room = costmap_.distance(place.x, place.y) - footprint_.half_width();
    return costmap_.collides(footprint_, here) ? std::min(room, -1e-3) : std::max(room, 0.0);
  }

 private:
  const Costmap& costmap_;
  const Footprint& footprint_;
  maps::Pose from_;
  double turn_;  ///< rad
};

}  // namespace

void set_yaws(std::span<maps::Pose> path, const BaseOptions& base) noexcept {
  const bool given = base.max_reverse > 0 && yaws_count(path),
             reverses_at_cusps = base.max_reverse > 0 && base.kind == BaseKind::ackermann;
  bool backward = false, begun = false;
  double before = 0;
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    if (distance(position(path[i]), position(path[i + 1])) > least_way) {
      const double along = direction(path[i], path[i + 1]);
      if (given) {
        backward = agreement(path, i) < 0;
      } else if (reverses_at_cusps && begun && std::cos(along - before) < -aligned) {
        backward = !backward;
      }
      before = along;
      begun = true;
    }
    if (begun) path[i].yaw = before + (backward ? std::numbers::pi : 0);
  }
}

PathGuide::PathGuide(double reach, double behind)
    : reach_(reach),
      behind_(behind),
      most_(saturate_cast<int>((reach + 2 * behind) / (0.5 * spacing)) + 4),
      cells_(1, most_) {
  cells_.fill({0, 0, 0, 0});
}

void PathGuide::write(const maps::Pose& robot, double left, std::size_t stop, NavigationMaps& maps) noexcept {
  const maps::PathLeg& at = leg();
  const double spacing_here = std::max(step(), 1e-3);
  const auto back = saturate_cast<std::size_t>(behind_ / spacing_here);
  const std::size_t first = std::max(at.first, nearest() > back ? nearest() - back : 0);
  const auto wanted = first + saturate_cast<std::size_t>((reach_ + 2 * behind_) / spacing_here) + 3;
  const std::size_t last = std::max(first, std::min({wanted, at.last, stop}));
  const double turned = at.backward ? std::numbers::pi : 0;
  // Storage holds a ring of cells, which have the values of the first and of the last point.
  for (int column = -1; column <= most_; ++column) {
    const std::size_t i = std::min(first + std::max(column, 0), last);
    const maps::Pose& point = points()[i];
    const double yaw = (i == at.last && i > at.first ? points()[i - 1].yaw : point.yaw) + turned;
    for (int row = -1; row <= 1; ++row) {
      float* const to = cells_.at(row, column);
      to[0] = static_cast<float>(point.x - robot.x);
      to[1] = static_cast<float>(point.y - robot.y);
      to[2] = static_cast<float>(yaw);
      to[3] = static_cast<float>(step() * (i - first));
    }
  }
  const maps::GridGeometry geometry{1, most_, spacing_here, 0, -0.5 * spacing_here * (most_ - 1)};
  const maps::Pose &near = points()[nearest()], &end = points()[last];
  maps.path = cells_.view(geometry);
  maps.origin = {robot.x, robot.y};
  maps.window_length = step() * (last - first);
  const double along =
      std::cos(near.yaw + turned) * (robot.x - near.x) + std::sin(near.yaw + turned) * (robot.y - near.y);
  maps.progress = std::clamp(step() * (nearest() - first) + along, 0.0, maps.window_length);
  maps.backward = at.backward;
  maps.turns = at.turns;
  maps.ends_leg = last == at.last;
  maps.ends_at_goal = last + 1 == points().size();
  // The robot's yaw is not wrapped in rollouts.
  maps.end = {end.x, end.y, robot.yaw + (at.turns ? left : maps::wrap_angle(goal().yaw - robot.yaw))};
}

Approach::Approach(const NavigatorOptions& options, const Footprint& footprint)
    : options_(options),
      footprint_(footprint),
      enlarged_(footprint.without_rim(-more_room * footprint.circumscribed_radius())),
      search_(search_options(options, footprint)) {
  goals_.reserve(2 * most_goals);
}

double Approach::free_turn(const maps::Pose& robot, double yaw, const Costmap& costmap,
                           double rate) const noexcept {
  // Between the poses that are checked no vertex moves by more than a cell.
  const double step = costmap.geometry().resolution / footprint_.circumscribed_radius();
  double shorter = maps::wrap_angle(yaw - robot.yaw);
  double longer = shorter - std::copysign(2 * std::numbers::pi, shorter);
  if (rate * shorter < 0 && std::cos(shorter) < -aligned) std::swap(shorter, longer);
  for (const double turn : {shorter, longer}) {
    const int steps = saturate_cast<int>(std::ceil(std::abs(turn) / step));
    int i = 1;
    while (i <= steps && !costmap.collides(footprint_, {robot.x, robot.y, robot.yaw + turn * i / steps})) ++i;
    if (i > steps) return turn;
  }
  return 0;
}

/// Searches a manoeuvre from a pose to one of the goals, at first with more room.
bool Approach::search(const maps::Pose& start, bool backward_in_time, const Costmap& costmap) noexcept {
  const auto finds = [&](const Footprint& body) {
    const CostmapRoom room(costmap, body, start, backward_in_time);
    const auto is_free = [&](const maps::ManoeuvreGoal& goal) { return room.at(goal.pose) >= 0; };
    return std::any_of(goals_.begin(), goals_.end(), is_free) && search_.search(room, goals_);
  };
  return finds(enlarged_) || finds(footprint_);
}

/// Searches a manoeuvre from a pose to one of the points `first` to `last`, or backward in time from one to
/// it.
bool Approach::search(const PathGuide& guide, const maps::Pose& from, std::size_t first, std::size_t last,
                      bool backward_in_time, const Costmap& costmap) noexcept {
  const double turn = backward_in_time ? std::numbers::pi : 0;
  const maps::Pose start{from.x, from.y, from.yaw + turn};
  const std::size_t stride = std::max((last - first) / most_goals, std::size_t{2});
  goals_.clear();
  for (std::size_t i = first; i <= last; i += stride) {
    const maps::Pose& at = guide.points()[i];
    const maps::Point place = maps::inverse_transform(start, position(at));
    goals_.push_back({{place.x, place.y, at.yaw + turn - start.yaw},
                      guide.step() * static_cast<double>(backward_in_time ? i - first : last - i)});
  }
  if (!search(start, backward_in_time, costmap)) return false;
  joint_ = first + stride * search_.goal();
  return true;
}

bool Approach::join(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept {
  const auto points = guide.points();
  const std::size_t first = guide.nearest(),
                    last = std::min(points.size() - 1, first + guide.points_for(longest_change()));
  return search(guide, robot, first, last, false, costmap) && lead(guide, robot, joint_);
}

bool Approach::dock(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept {
  const maps::Pose& goal = guide.goal();
  const double yaw = std::atan2(goal.y - robot.y, goal.x - robot.x);
  if (turns_on_the_spot(options_.base) && free_turn(robot, yaw, costmap) != 0) return false;
  goals_.clear();
  for (const double run : {-footprint_.circumscribed_radius(), footprint_.circumscribed_radius()}) {
    const maps::Pose begin{goal.x + run * std::cos(goal.yaw), goal.y + run * std::sin(goal.yaw), goal.yaw};
    const maps::Point place = maps::inverse_transform(robot, position(begin));
    if (!costmap.collides(footprint_, begin, goal))
      goals_.push_back({{place.x, place.y, goal.yaw - robot.yaw}, 0});
  }
  return !goals_.empty() && search(robot, false, costmap) && lead(guide, robot, guide.points().size() - 1);
}

/// Leads the path along the way that was found, from the robot, and on from a point of the path.
bool Approach::lead(PathGuide& guide, const maps::Pose& robot, std::size_t joint) noexcept {
  const auto points = guide.points();
  const auto way = search_.poses();
  if (way.size() + points.size() > buffer_.capacity()) return false;
  buffer_.clear();
  for (const maps::Pose& pose : way) {
    const maps::Point place = maps::transform(robot, {pose.x, pose.y});
    buffer_.push_back({place.x, place.y, robot.yaw + pose.yaw});
  }
  buffer_.insert(buffer_.end(), points.begin() + joint, points.end());
  buffer_.back() = guide.goal();
  const double left = guide.step() * static_cast<double>(points.size() - 1 - joint);
  end_ = begin_ < 0 ? left : std::min(end_, left);  // it may lead into the last one
  guide.set(buffer_, turns_on_the_spot(options_.base));
  begin_ = guide.remaining();
  return true;
}

void Approach::face_goal(PathGuide& guide, const Costmap& costmap) noexcept {
  const auto points = guide.points();
  const maps::Pose& goal = guide.goal();
  const std::size_t most = guide.points_for(longest_change()), last = points.size() - 1;
  const auto legs = guide.legs();
  const maps::PathLeg& arrival = legs[legs.size() - (legs.back().turns && legs.size() > 1 ? 2 : 1)];
  const std::size_t first = std::max({arrival.first, guide.nearest(), last > most ? last - most : 0});
  if (first == last || !search(guide, goal, first, last - 1, true, costmap)) return;
  const auto way = search_.poses();
  if (joint_ + way.size() > buffer_.capacity()) return;
  buffer_.assign(points.begin(), points.begin() + joint_);
  for (std::size_t i = way.size(); i-- > 0;) {
    const maps::Point place =
        maps::transform({goal.x, goal.y, goal.yaw + std::numbers::pi}, {way[i].x, way[i].y});
    buffer_.push_back({place.x, place.y, goal.yaw + way[i].yaw});
  }
  const maps::Point here = position(points[guide.nearest()]);
  begin_ = -guide.step() * static_cast<double>(joint_);
  guide.set(buffer_, turns_on_the_spot(options_.base));
  begin_ += guide.remaining();
  end_ = 0;
  guide.place(here);
}

void Approach::place(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap) noexcept {
  if (guide.step() == 0 && distance(position(robot), position(guide.goal())) > 0.5 * options_.goal_distance) {
    buffer_.assign({robot, guide.goal()});  // a path of one pose
    if (options_.base.max_reverse == 0) set_yaws(buffer_, options_.base);
    guide.set(buffer_, turns_on_the_spot(options_.base));
  }
  guide.place(position(robot));
  if (guide.remaining() <= options_.goal_distance &&
      distance(position(robot), position(guide.goal())) <= options_.goal_distance) {
    // Near its end a path has no direction: the turn is left.
    buffer_.assign({guide.goal()});
    if (turns_on_the_spot(options_.base)) return guide.set(buffer_, true);
    while (!guide.on_last_leg()) guide.next_leg();
    return;
  }
  if (options_.base.kind == BaseKind::omnidirectional || options_.base.max_turn == 0) return;
  // The direction of the path a little ahead.
  const std::size_t ahead =
      std::min(guide.nearest() + guide.points_for(0.7 * footprint_.circumscribed_radius()),
               std::max(guide.leg().last, std::size_t{1}) - 1);
  const double direction = guide.points()[std::max(ahead, guide.leg().first)].yaw;
  if (guide.leg().turns || std::cos(direction - robot.yaw) >= aligned) return;
  if (turns_on_the_spot(options_.base) && free_turn(robot, direction, costmap) != 0)
    return guide.turn_first(direction);
  if (join(guide, robot, costmap)) guide.place(position(robot));
}

}  // namespace slalom::navigation::detail
