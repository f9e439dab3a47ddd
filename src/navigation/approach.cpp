#include "navigation/approach.hpp"

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::navigation::detail {
namespace {

constexpr double wrong_way = std::numbers::pi / 3;  // rad from the path, from which the robot first turns
constexpr std::size_t most_goals = 30;              // poses, as goals of a search

/// The length of a body, m.
double length_of(const Footprint& footprint) {
  return 2 * footprint.circumscribed_radius();
}

maps::ManoeuvreOptions search_options(const NavigatorOptions& options, const Footprint& footprint) {
  const bool turns = turns_on_the_spot(options.base);
  maps::ManoeuvreOptions made = maps::ManoeuvreOptions::of(
      length_of(footprint), turns ? 0 : 1.1 * options.base.min_turning_radius);  // the rest corrects
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

Approach::Approach(const NavigatorOptions& options, const Footprint& footprint)
    : options_(options), footprint_(footprint), search_(search_options(options, footprint)) {
  goals_.reserve(2 * most_goals);
}

/// The turn to a yaw on which the body is free, the shorter one if both are; 0 if neither is.
double Approach::free_turn(const maps::Pose& robot, double yaw, const Costmap& costmap,
                           double rate) const noexcept {
  constexpr double step = 0.1;  // rad between the poses that are checked
  double shorter = maps::wrap_angle(yaw - robot.yaw);
  double longer = shorter - std::copysign(2 * std::numbers::pi, shorter);
  if (rate * shorter < 0 && std::abs(shorter) > std::numbers::pi - wrong_way) std::swap(shorter, longer);
  for (const double turn : {shorter, longer}) {
    const int steps = saturate_cast<int>(std::ceil(std::abs(turn) / step));
    int i = 1;
    while (i <= steps && !costmap.collides(footprint_, {robot.x, robot.y, robot.yaw + turn * i / steps})) ++i;
    if (i > steps) return turn;
  }
  return 0;
}

double Approach::turn_to(const maps::Pose& robot, double yaw, const Costmap& costmap,
                         double rate) const noexcept {
  const double turn = free_turn(robot, yaw, costmap, rate);
  return turn != 0 ? turn : maps::wrap_angle(yaw - robot.yaw);
}

/// Searches a manoeuvre from a pose to one of the points `first` to `last` of the path; or, backward in time,
/// from one of them to the pose.
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
  if (!search_.search(CostmapRoom(costmap, footprint_, start, backward_in_time), goals_)) return false;
  joint_ = first + stride * search_.goal();
  return true;
}

bool Approach::join(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
                    std::vector<maps::Pose>& buffer) noexcept {
  const auto points = guide.points();
  const std::size_t last = std::min(points.size() - 1, guide.nearest() + guide.points_for(longest_change));
  if (!search(guide, robot, guide.nearest(), last, false, costmap)) return false;
  const auto way = search_.poses();
  if (way.size() + points.size() > buffer.capacity()) return false;
  buffer.clear();
  for (const maps::Pose& pose : way.first(way.size() - 1)) {
    const maps::Point place = maps::transform(robot, {pose.x, pose.y});
    buffer.push_back({place.x, place.y, robot.yaw + pose.yaw});
  }
  buffer.insert(buffer.end(), points.begin() + joint_, points.end());
  buffer.back() = guide.goal();
  end_ = guide.step() * static_cast<double>(points.size() - 1 - joint_);
  guide.set(buffer, turns_on_the_spot(options_.base));
  begin_ = guide.remaining();
  return true;
}

void Approach::face_goal(PathGuide& guide, const Costmap& costmap, std::vector<maps::Pose>& buffer) noexcept {
  const auto points = guide.points();
  const maps::Pose& goal = guide.goal();
  const std::size_t most = guide.points_for(longest_change), last = points.size() - 1;
  const auto legs = guide.legs();
  const maps::PathLeg& arrival = legs[legs.size() - (legs.back().turns && legs.size() > 1 ? 2 : 1)];
  const std::size_t first = std::max({arrival.first, guide.nearest(), last > most ? last - most : 0});
  if (first == last || !search(guide, goal, first, last - 1, true, costmap)) return;
  const auto way = search_.poses();
  if (joint_ + way.size() > buffer.capacity()) return;
  buffer.assign(points.begin(), points.begin() + joint_);
  for (std::size_t i = way.size(); i-- > 0;) {
    const maps::Point place =
        maps::transform({goal.x, goal.y, goal.yaw + std::numbers::pi}, {way[i].x, way[i].y});
    buffer.push_back({place.x, place.y, goal.yaw + way[i].yaw});
  }
  const maps::Point here = position(points[guide.nearest()]);
  begin_ = -guide.step() * static_cast<double>(joint_);
  guide.set(buffer, turns_on_the_spot(options_.base));
  begin_ += guide.remaining();
  end_ = 0;
  guide.place(here);
}

void Approach::place(PathGuide& guide, const maps::Pose& robot, const Costmap& costmap,
                     std::vector<maps::Pose>& buffer) noexcept {
  if (guide.step() == 0 && distance(position(robot), position(guide.goal())) > 0.5 * options_.goal_distance) {
    buffer.assign({robot, guide.goal()});  // a path of one pose
    if (options_.base.max_reverse == 0) set_yaws(buffer, options_.base);
    guide.set(buffer, turns_on_the_spot(options_.base));
  }
  guide.place(position(robot));
  if (guide.remaining() <= options_.goal_distance &&
      distance(position(robot), position(guide.goal())) <= options_.goal_distance) {
    // Near its end a path has no direction.
    while (!guide.on_last_leg()) guide.next_leg();
    if (turns_on_the_spot(options_.base) && !guide.leg().turns &&
        std::abs(maps::wrap_angle(guide.goal().yaw - robot.yaw)) > options_.goal_angle)
      guide.turn_first(guide.goal().yaw);
    return;
  }
  if (options_.base.kind == BaseKind::omnidirectional || options_.base.max_turn == 0) return;
  // The direction of the path a little ahead.
  const auto direction = [&] {
    const std::size_t ahead = std::min(guide.nearest() + guide.points_for(length_of(footprint_) / 3),
                                       std::max(guide.leg().last, std::size_t{1}) - 1);
    return guide.points()[std::max(ahead, guide.leg().first)].yaw;
  };
  const auto faces_away = [&] {
    return !guide.leg().turns && std::abs(maps::wrap_angle(direction() - robot.yaw)) > wrong_way;
  };
  const bool turns = turns_on_the_spot(options_.base);
  if (faces_away() && !(turns && free_turn(robot, direction(), costmap) != 0)) {
    join(guide, robot, costmap, buffer);
    guide.place(position(robot));
  }
  if (turns && faces_away() && free_turn(robot, direction(), costmap) != 0) guide.turn_first(direction());
  if (options_.base.kind == BaseKind::ackermann &&
      std::abs(maps::wrap_angle(guide.goal().yaw - guide.legs().back().yaw)) > 0.5 * options_.goal_angle) {
    face_goal(guide, costmap, buffer);
  }
}

}  // namespace slalom::navigation::detail
