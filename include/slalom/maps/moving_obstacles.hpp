#pragma once

#include "slalom/core/math.hpp"
#include "slalom/core/options.hpp"
#include "slalom/core/problem.hpp"
#include "slalom/maps/laser_scan.hpp"
#include "slalom/maps/pose.hpp"

/// Moving obstacles in rollouts: every state meets them at their predicted place at its step.
///
///     MovingObstacles others({.front = 0.46, .rear = 0.12, .width = 0.31}, horizon);
///     others.update(predictions, {robot.x, robot.y}, 0, dt);   // before a solve
///     problem.others = others.view();
///     ...
///     template <class T> Cost<T> stage_cost(const State<T>& x, const Input<T, 2>& u, int k) const {
///       T sine, cosine;
///       sin_cos(x.yaw, sine, cosine);
///       const Cost<T> met = others.cost(x.x, x.y, sine, cosine, k);
///       return {own_cost(x, u) + met.value, met.collided};
///     }
namespace slalom::maps {

/// The expected pose of an obstacle at a moment: the middle of its box, with its standard deviations along
/// the box and across it.
struct PredictedPose {
  Pose pose;                    ///< pose of the middle
  double along_deviation = 0;   ///< m
  double across_deviation = 0;  ///< m
};

/// A rectangular obstacle that moves, with hypotheses of its motion. It does not own `poses`: the array
/// that they view must outlive it.
struct PredictedObstacle {
  static constexpr int max_hypotheses = 4;  ///< most hypotheses of an obstacle

  int id = 0;                                    ///< id in its tracker
  double length = 0;                             ///< m
  double width = 0;                              ///< m
  double interval = 0;                           ///< s, from one pose to the next, > 0
  int hypotheses = 0;                            ///< 1 ... max_hypotheses
  std::array<double, max_hypotheses> weights{};  ///< probabilities of the hypotheses; the sum is 1
  /// [hypothesis][time], as many for each: the first is that of now, after the last the obstacle keeps its
  /// last velocity
  std::span<const PredictedPose> poses;

  /// The number of poses of a hypothesis.
  std::size_t times() const noexcept { return poses.size() / static_cast<std::size_t>(hypotheses); }
  /// The hypothesis with the greatest weight.
  int likeliest() const noexcept;
  /// A hypothesis at a time (s, >= 0), by interpolation.
  PredictedPose at(int hypothesis, double time) const noexcept;
};

/// Options of MovingObstacles. `visit_options` below describes the fields.
struct MovingObstacleOptions {
  double front = 0.461;
  double rear = 0.119;
  double width = 0.31;
  double margin = 0.05;
  double soft_margin = 0.25;
  double collision_cost = 100;
  double soft_cost = 20;
  double deviations = 1;
  double max_probability = 0.2;
};

template <class Options, class Visit>
requires is_options_of<Options, MovingObstacleOptions>
void visit_options(Options& o, Visit&& visit) {
  visit(o.front, {"front", "m", "reach of the own body ahead of its reference point", 0, 100});
  visit(o.rear, {"rear", "m", "reach of the own body behind its reference point", 0, 100});
  visit(o.width, {"width", "m", "width of the own body", 0, 100});
  visit(o.margin, {"margin", "m", "distance below which bodies collide", 0, 100});
  visit(o.soft_margin, {"soft_margin", "m", "distance beyond `margin` in which nearness has a cost", 0, 100});
  visit(o.collision_cost, {"collision_cost", "", "cost of a collision that is certain", 0, 1e9});
  visit(o.soft_cost,
        {"soft_cost", "", "cost of a state that almost collides; falls off as the square of the distance", 0,
         1e9});
  visit(o.deviations, {"deviations", "", "standard deviations by which boxes are inflated", 0, 10});
  visit(o.max_probability,
        {"max_probability", "", "probability of a collision in a step above which a state collides", 0, 1});
}

/// The moving obstacles as rollouts see them; the view must not outlive them. By default there are none.
class MovingObstaclesView {
 public:
  MovingObstaclesView() = default;

  /// Whether there are none.
  bool empty() const noexcept { return obstacles_ == 0; }
  /// The last step at which they are known.
  int last_step() const noexcept { return steps_; }

  /// Returns the same obstacles in a frame that is parallel to theirs and begins at `origin` (m). Rollouts in
  /// float32 need it (see GridView::relative_to).
  MovingObstaclesView relative_to(const Point& origin) const noexcept {
    MovingObstaclesView moved = *this;
    moved.x_ = double(x_) + origin.x;
    moved.y_ = double(y_) + origin.y;
    return moved;
  }

  /// The cost of the own body at (x, y) (m), turned by the angle of this sine and cosine, at step `k`, and
  /// whether it collides. With g_h the gap between the own box and that of hypothesis h, which is inflated by
  /// the margin and its deviations, and w_h its weight, an obstacle costs
  ///
  ///     sum_h w_h (g_h < 0 ? collision_cost : soft_cost max(1 - g_h / soft_margin, 0)^2)
  ///
  /// and collides where the sum of the weights of the boxes that are met is above `max_probability`: a
  /// chance constraint for each step. Boxes meet exactly where no side of either separates them (the
  /// separating axis theorem); g is the widest separation along their four axes.
  template <class T>
  SLALOM_INLINE_CALLS Cost<T> cost(const T& x, const T& y, const T& sine, const T& cosine, int k) const {
    Cost<T> sum{T(0), mask_t<T>(false)};
    if (obstacles_ == 0) return sum;
    const T middle_x = x + T(x_) + T(lead_) * cosine, middle_y = y + T(y_) + T(lead_) * sine;
    for (int i = 0; i < obstacles_; ++i) {
      const Reach& reach = reaches_[k * obstacles_ + i];
      const T near_x = middle_x - T(reach.x), near_y = middle_y - T(reach.y);
      if (!any(mask_t<T>(near_x * near_x + near_y * near_y < T(reach.squared)))) continue;
      T met(0);
      for (int h = reach.first; h < reach.end; ++h) {
        const Box& box = boxes_[h];
        const T gap = gap_to(box, middle_x - T(box.x), middle_y - T(box.y), sine, cosine);
        const T near = max(T(1) - gap * T(inverse_soft_margin_), T(0));
        const mask_t<T> meets(gap < T(0));
        sum.value =
            sum.value + T(box.weight) * select(meets, T(collision_cost_), T(soft_cost_) * near * near);
        met = met + select(meets, T(box.weight), T(0));
      }
      sum.collided = sum.collided | mask_t<T>(met > T(max_probability_));
    }
    return sum;
  }

  /// The cost of being behind obstacles at the last step, for a body whose reference point is at (x, y) (m):
  /// the sum over those with a cost of MovingObstacles::set_following_costs. Such a cost counts in full where
  /// the body is 4 m or more behind the obstacle, and not at all where it is 1 m or more ahead, along the
  /// heading of the obstacle's likeliest hypothesis. Between these two it is linear.
  template <class T>
  SLALOM_INLINE_CALLS T following_cost(const T& x, const T& y) const {
    constexpr double ahead = 1, behind = 4;  // m
    T sum(0);
    for (int i = 0; i < followed_; ++i) {
      const Followed& each = followed_at_[i];
      const T along = (x + T(x_) - T(each.x)) * T(each.cosine) + (y + T(y_) - T(each.y)) * T(each.sine);
      sum = sum + T(each.cost) * min(max((T(ahead) - along) * T(1 / (ahead + behind)), T(0)), T(1));
    }
    return sum;
  }

 private:
  friend class MovingObstacles;

  /// The likeliest hypothesis of an obstacle at the last step, and the cost of a plan's end behind it.
  struct Followed {
    float x, y;  ///< m, of the middle
    float sine, cosine;
    float cost;
  };
  /// A hypothesis at a step.
  struct Box {
    float x, y;  ///< m, of the middle
    float sine, cosine;
    float half_length, half_width;  ///< m, inflated
    float weight;
  };
  /// A circle beyond which an obstacle costs nothing at a step, and its boxes.
  struct Reach {
    float x, y;     ///< m
    float squared;  ///< m^2
    int first, end;
  };

  /// The gap between the own body, whose middle is at (dx, dy) from that of the box, and the box, m.
  template <class T>
  SLALOM_INLINE_CALLS T gap_to(const Box& box, const T& dx, const T& dy, const T& sine,
                               const T& cosine) const {
    const T bc = T(box.cosine), bs = T(box.sine), half_length = T(half_length_), half_width = T(half_width_);
    const T turned_cosine = abs(cosine * bc + sine * bs), turned_sine = abs(sine * bc - cosine * bs);
    const T of_box = max(abs(dx * bc + dy * bs) -
                             (T(box.half_length) + half_length * turned_cosine + half_width * turned_sine),
                         abs(dy * bc - dx * bs) -
                             (T(box.half_width) + half_length * turned_sine + half_width * turned_cosine));
    const T of_body =
        max(abs(dx * cosine + dy * sine) -
                (half_length + T(box.half_length) * turned_cosine + T(box.half_width) * turned_sine),
            abs(dy * cosine - dx * sine) -
                (half_width + T(box.half_length) * turned_sine + T(box.half_width) * turned_cosine));
    return max(of_box, of_body);
  }

  const Box* boxes_ = nullptr;
  const Reach* reaches_ = nullptr;  ///< [step][obstacle]
  const Followed* followed_at_ = nullptr;
  int obstacles_ = 0, followed_ = 0, steps_ = 0;
  Coefficient x_, y_;                     ///< m, the origin of rollouts in the frame of the boxes
  Coefficient lead_;                      ///< m, of the own body's middle ahead of its reference point
  Coefficient half_length_, half_width_;  ///< m, of the own body
  Coefficient inverse_soft_margin_, soft_cost_, collision_cost_, max_probability_;
};

/// The boxes of moving obstacles at every step of a horizon. After construction nothing allocates.
class MovingObstacles {
 public:
  static constexpr int max_count = 16;  ///< obstacles that count; of more, the nearest ones do

  /// For `steps` steps. Throws std::invalid_argument on options out of range and on `steps` < 1.
  explicit MovingObstacles(const MovingObstacleOptions& options, int steps);

  /// Forgets all obstacles.
  void clear() noexcept { view_.obstacles_ = view_.followed_ = 0; }
  /// Takes predictions to the times `first` + k `time_step` (s from now), k = 0 ... steps. They are kept
  /// relative to `origin` (m), a point near which rollouts begin, and must live until the next update.
  /// Obstacles whose numbers are not finite are left out.
  void update(std::span<const PredictedObstacle> predicted, const Point& origin, double first,
              double time_step) noexcept;

  /// Sets, for each obstacle that `taken` returns, the cost of ending behind it (see
  /// MovingObstaclesView::following_cost). The next update sets these costs to 0.
  void set_following_costs(std::span<const double> costs) noexcept;

  /// The obstacles of the last update that count.
  std::span<const PredictedObstacle* const> taken() const noexcept {
    return {taken_.data(), static_cast<std::size_t>(view_.obstacles_)};
  }

  /// The obstacles in the frame in which they are given; valid until the next update.
  MovingObstaclesView view() const noexcept;

 private:
  void place(const PredictedObstacle& obstacle, double time, MovingObstaclesView::Reach& reach) noexcept;

  MovingObstacleOptions options_;
  int steps_;
  Point origin_;
  std::vector<MovingObstaclesView::Box> boxes_;
  std::vector<MovingObstaclesView::Reach> reaches_;
  std::vector<MovingObstaclesView::Followed> followed_;
  std::array<const PredictedObstacle*, max_count> taken_{};
  int count_ = 0;             ///< boxes
  MovingObstaclesView view_;  ///< without its pointers
};

/// Sets the readings of a scan that end on an obstacle as it is now to NaN, so that maps made of the scan do
/// not keep it where it was. `scan` has the geometry, with beams that run counter-clockwise, `ranges` its
/// readings (m), and `sensor` its pose in the frame of the obstacle. Readings within `margin` (m) of the
/// obstacle's box are on it. Does nothing where beams run clockwise or half a turn apart, or the obstacle has
/// no poses.
void drop_readings_of(const PredictedObstacle& obstacle, double margin, const Pose& sensor,
                      const LaserScanView& scan, std::span<float> ranges) noexcept;

}  // namespace slalom::maps
