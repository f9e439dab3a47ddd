#include "slalom/maps/manoeuvre_search.hpp"

#include <algorithm>

#include "slalom/core/numbers/saturate_cast.hpp"

namespace slalom::maps {
namespace {

constexpr int side = 56, headings = 36;  // cells
constexpr double sector = 2 * std::numbers::pi / headings;
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int samples = 4;     // poses of a step that are checked at the end of a way
constexpr int effort = 20000;  // poses that are checked at most on the way to an exact pose

}  // namespace

ManoeuvreOptions ManoeuvreOptions::of(double length, double radius) {
  const double scale = body_scale(length);
  return {.radius = radius,
          .step = 0.15 * scale,
          .cautious = 0.15 * scale,
          .cusp_price = 0.4 * scale,
          .turn_price = 0.5 * length};
}

ManoeuvreSearch::ManoeuvreSearch(const ManoeuvreOptions& options)
    : options_(options), nodes_(static_cast<std::size_t>(side) * side * headings), costs_(nodes_.size()) {
  for (const int gear : {1, -1})
    for (const int turn : {0, 1, -1}) {
      if (gear < 0 && !options.can_reverse) continue;
      const double radius = options.radius > 0 ? options.radius : options.bend;
      if (turn == 0 || radius > 0)
        moves_.push_back({{gear * options.step, turn == 0 ? 0 : turn * gear * options.step / radius}});
      if (turn != 0 && gear > 0 && options.radius == 0) moves_.push_back({{0, turn * sector}});
    }
  for (Move& move : moves_) {
    move.middle = after({}, move.arc, 0.5);
    move.end = after({}, move.arc);
  }
  queue_.reserve(4 * nodes_.size());
  poses_.reserve(max_poses);
  chain_.reserve(max_steps + 3);
}

/// The pose after a share of an arc.
Pose ManoeuvreSearch::after(const Pose& from, const Arc& arc, double share) noexcept {
  const double turned = share * arc.turn, driven = share * arc.length;
  const bool bends = std::abs(turned) > 1e-9;
  const double x = bends ? driven / turned * std::sin(turned) : driven,
               y = bends ? driven / turned * (1 - std::cos(turned)) : 0;
  const Point to = transform(from, {x, y});
  return {to.x, to.y, from.yaw + turned};
}

/// The cell of a pose; -1 off the square.
int ManoeuvreSearch::index(const Pose& pose) const noexcept {
  const double cell = options_.step / 1.5, half = 0.5 * side;
  const double column = std::floor(pose.x / cell + half), row = std::floor(pose.y / cell + half);
  if (!(column >= 0 && row >= 0 && column < side && row < side)) return -1;
  const int turn = saturate_cast<int>(std::round(pose.yaw / sector));
  return (saturate_cast<int>(row) * side + saturate_cast<int>(column)) * headings +
         ((turn % headings) + headings) % headings;
}

double ManoeuvreSearch::cost_of(const Word& word) const noexcept {
  double sum = 0, before = 0;
  for (const Arc& arc : word.arcs) {
    sum += std::abs(arc.length) + (options_.radius > 0 ? 0 : options_.turn_price * std::abs(arc.turn)) +
           (arc.length * before < 0 ? options_.cusp_price : 0);
    if (arc.length != 0) before = arc.length;
  }
  return sum;
}

bool ManoeuvreSearch::is_free(const BodyRoom& room, const Pose& from, const Word& word) noexcept {
  Pose begin = from;
  for (const Arc& arc : word.arcs) {
    const double steps =
        std::ceil(samples * std::max(std::abs(arc.length) / options_.step, std::abs(arc.turn) / sector));
    for (double i = 0; i < steps; ++i, ++checks_)
      if (room.at(after(begin, arc, i / steps)) < 0) return false;
    begin = after(begin, arc);
  }
  return true;
}

/// Calls `visit` with the words that lead to a pose. Mirrored in time, a word is driven the other way;
/// mirrored in space, it bends to the other side.
void ManoeuvreSearch::visit_words(const Pose& to, const auto& visit) const noexcept {
  const double r = options_.radius, yaw = wrap_angle(to.yaw);
  for (const int way : {1, -1})
    for (const int bend : {1, -1}) {
      const double x = way * to.x, y = bend * to.y, end = way * bend * yaw;
      const auto make = [&](double t, double length, double turn, double v, int last) {
        const double drive = way, left = way * bend;
        Word word{
            {{drive * r * t, left * t}, {drive * length, left * turn}, {drive * r * v, left * last * v}}};
        word.cost = cost_of(word);
        const bool backs = std::any_of(std::begin(word.arcs), std::end(word.arcs),
                                       [](const Arc& arc) { return arc.length < 0; });
        if (!backs || options_.can_reverse) visit(word);
      };
      // Left, straight, left; and left, right in the other direction, left again.
      const double dx = x - r * std::sin(end), dy = y - r + r * std::cos(end), away = std::hypot(dx, dy);
      const double t = std::atan2(dy, dx);
      make(t, away, 0, wrap_angle(end - t), 1);
      if (r > 0 && away <= 4 * r) {
        const double u = -2 * std::asin(away / (4 * r)), first = wrap_angle(t + u / 2 + std::numbers::pi);
        make(first, r * u, -u, wrap_angle(end - first + u), 1);
      }
      // Left, straight, right.
      const double ex = x + r * std::sin(end), ey = y - r - r * std::cos(end),
                   square = ex * ex + ey * ey - 4 * r * r;
      if (r > 0 && square >= 0) {
        const double u = std::sqrt(square), first = wrap_angle(std::atan2(ey, ex) + std::atan2(2 * r, u));
        make(first, u, 0, wrap_angle(first - end), -1);
      }
    }
}

/// Whether a way may end at a node: beside a goal, driving forward, and with room to drive on.
bool ManoeuvreSearch::ends_at(const BodyRoom& room, const Node& node,
                              std::span<const ManoeuvreGoal> goals) noexcept {
  if (node.arc < 0 || moves_[node.arc].arc.length <= 0) return false;
  const double along = options_.step, reach = options_.beside * options_.beside + along * along;
  for (goal_ = 0; goal_ < goals.size(); ++goal_) {
    const Pose& goal = goals[goal_].pose;
    const double dx = goal.x - node.x, dy = goal.y - node.y;
    if (dx * dx + dy * dy > reach || std::abs(wrap_angle(node.yaw - goal.yaw)) > options_.turned) continue;
    const Point local = inverse_transform(goal, {node.x, node.y});
    if (std::abs(local.x) > along || std::abs(local.y) > options_.beside) continue;
    const Pose here{node.x, node.y, node.yaw};
    return room.at(after(here, {1.5 * along, 0})) >= 0 && room.at(after(here, {3 * along, 0})) >= 0;
  }
  return false;
}

/// The cheapest word from a node to a goal; none if all collide.
std::optional<ManoeuvreSearch::Word> ManoeuvreSearch::last_word(
    const BodyRoom& room, const Node& node, std::span<const ManoeuvreGoal> goals) noexcept {
  std::optional<Word> best;
  double least = infinity;
  const Pose here{node.x, node.y, node.yaw};
  const std::size_t stride = node.before < 0 ? 1 : 4;
  for (std::size_t i = 0; i < goals.size(); i += stride) {
    const Point to = inverse_transform(here, {goals[i].pose.x, goals[i].pose.y});
    visit_words({to.x, to.y, goals[i].pose.yaw - here.yaw}, [&](const Word& word) {
      if (word.cost + goals[i].price >= least || !is_free(room, here, word)) return;
      least = word.cost + goals[i].price;
      goal_ = i;
      best = word;
    });
  }
  return best;
}

bool ManoeuvreSearch::search(const BodyRoom& room, std::span<const ManoeuvreGoal> goals,
                             double sight) noexcept {
  const bool exact = options_.beside == 0;
  std::fill(costs_.begin(), costs_.end(), std::numeric_limits<float>::infinity());
  queue_.clear();
  start_room_ = room.at({});
  cosine_of_sight_ = std::cos(std::min(sight, std::numbers::pi));
  checks_ = 0;
  push(index({}), 0, {});
  while (!queue_.empty() && queue_.size() + moves_.size() <= queue_.capacity()) {
    std::pop_heap(queue_.begin(), queue_.end());
    const Reached here = queue_.back();
    queue_.pop_back();
    if (here.cost > costs_[here.node]) continue;
    const Node& node = nodes_[here.node];
    if (exact) {
      if (const auto word = last_word(room, node, goals)) return take(here.node, *word);
      if (checks_ > effort) return false;
    } else if (ends_at(room, node, goals)) {
      return take(here.node, {});
    }
    const double cosine = std::cos(node.yaw), sine = std::sin(node.yaw);
    const auto moved = [&](const Pose& by) {
      return Pose{node.x + by.x * cosine - by.y * sine, node.y + by.x * sine + by.y * cosine,
                  node.yaw + by.yaw};
    };
    for (std::size_t i = 0; i < moves_.size(); ++i)
      expand(room, here, static_cast<std::int8_t>(i), moved(moves_[i].middle), moved(moves_[i].end));
  }
  return false;
}

void ManoeuvreSearch::expand(const BodyRoom& room, const Reached& from, std::int8_t number,
                             const Pose& middle, const Pose& there) noexcept {
  constexpr double nearness_price = 4, reverse_price = 1.5, blind_price = 8;
  const Node& node = nodes_[from.node];
  const Arc &arc = moves_[number].arc, before = node.arc < 0 ? Arc{} : moves_[node.arc].arc;
  const int to = index(there);
  if (to < 0) return;
  const double way = std::abs(arc.length) + (arc.length == 0 ? options_.turn_price * std::abs(arc.turn) : 0);
  const double shift = arc.length * before.length < 0 ? options_.cusp_price : 0;
  const double swing = arc.turn * arc.length != before.turn * before.length ? 0.1 * options_.step : 0;
  const auto cost_with = [&](double price) {
    return static_cast<float>(from.cost + way * price + shift + swing);
  };
  const double gear_price = arc.length < 0 ? reverse_price : 1;
  if (cost_with(gear_price) >= costs_[to]) return;
  checks_ += 2;
  // Where the vehicle begins too near to an obstacle, it may leave it.
  const double free = std::min(room.at(there), room.at(middle));
  const bool leaves = free >= start_room_ && from.cost < 3 * options_.step && free > -infinity;
  if (free < 0 && !leaves) return;
  double price = 1 + nearness_price * std::clamp(1 - free / options_.cautious, 0.0, 1.0);
  if (arc.length < 0) {
    const Point back = transform(there, {-options_.rear, 0});
    const bool unseen = back.x < cosine_of_sight_ * std::sqrt(back.x * back.x + back.y * back.y);
    price *= unseen ? blind_price : reverse_price;
  }
  const float cost = cost_with(price);
  if (cost >= costs_[to]) return;
  push(to, cost,
       {static_cast<float>(there.x), static_cast<float>(there.y), static_cast<float>(there.yaw), from.node,
        number});
}

void ManoeuvreSearch::push(int to, float cost, const Node& node) noexcept {
  nodes_[to] = node;
  costs_[to] = cost;
  queue_.push_back({cost, to});
  std::push_heap(queue_.begin(), queue_.end());
}

/// Takes the way to a node and along a word.
bool ManoeuvreSearch::take(std::int32_t node, const Word& word) noexcept {
  chain_.clear();
  for (std::int32_t at = node; nodes_[at].before >= 0; at = nodes_[at].before) {
    if (chain_.size() == max_steps) return false;
    chain_.push_back(moves_[nodes_[at].arc].arc);
  }
  std::reverse(chain_.begin(), chain_.end());
  chain_.insert(chain_.end(), std::begin(word.arcs), std::end(word.arcs));
  poses_.assign(1, {});
  for (const Arc& arc : chain_) {
    const Pose begin = poses_.back();
    const double steps = std::ceil(samples * std::abs(arc.length) / options_.step);
    for (double i = 1; i < steps && poses_.size() < poses_.capacity(); ++i)
      poses_.push_back(after(begin, arc, i / steps));
    if ((arc.length != 0 || arc.turn != 0) && poses_.size() < poses_.capacity())
      poses_.push_back(after(begin, arc));
  }
  return true;
}

}  // namespace slalom::maps
