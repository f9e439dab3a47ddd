#include "slalom/tracking/predictor.hpp"

#include <numeric>

#include "slalom/core/math.hpp"
#include "slalom/core/numbers/saturate_cast.hpp"
#include "slalom/core/reserved_vector.hpp"
#include "slalom/maps/pose_limits.hpp"
#include "tracking/manoeuvres.hpp"

namespace slalom::tracking {
namespace {

constexpr double arc_error = 0.15, offset_error = 0.06, speed_error = 0.5;  // m, m, m/s: of comparisons

constexpr double rise_memory = 0.15;                        // s, time constant of the rise of speed ratios
constexpr double clear_rise = 0.4, clear_acceleration = 2;  // 1/s, m/s^2, of a car that gets up to speed
constexpr double longest_gap = 10;  // s between comparisons, after which an object counts as unknown
constexpr double largest = 1e3;     // m, m/s, rad/s: largest deviation, size, speed and yaw rate of an object

using Weights = std::array<double, manoeuvres>;

/// Whether an object is one that a tracker can report.
bool plausible(const TrackedObject& object) noexcept {
  bool holds = maps::is_plausible(object.pose) && std::abs(object.speed) <= largest &&
               std::abs(object.yaw_rate) <= largest && object.length >= 0 && object.length <= largest &&
               object.width >= 0 && object.width <= largest;
  for (const auto& row : object.covariance)
    for (const double value : row) holds = holds && std::abs(value) <= square(largest);
  return holds;
}

std::size_t possible(const Motion& motion) noexcept {
  if (!motion.on_course) return manoeuvres_without_course;
  return motion.habit.ratio > 0 ? manoeuvres : manoeuvres - 1;
}

/// The weights of an object of which nothing is known.
Weights first_weights(const Motion& motion) noexcept {
  Weights weights{};
  std::copy_n(usual_weights.begin(), possible(motion), weights.begin());
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  for (double& weight : weights) weight /= sum;
  return weights;
}

}  // namespace

struct Predictor::Implementation {
  /// The memory of an object.
  struct Remembered {
    int id = 0;
    double since = 0;  ///< s, when `motion` was
    Motion motion;
    Weights weights{};
    double seen = 0;          ///< s, when `ratio` was
    double ratio = 0;         ///< ratio of its speed to the course's
    double speed = 0;         ///< m/s, at that time
    double rise = 0;          ///< 1/s, mean of the rise of `ratio`
    double acceleration = 0;  ///< m/s^2, mean
  };

  PredictorOptions options;
  CourseLine course;
  Habits habits;
  std::size_t times;
  ReservedVector<Remembered> remembered;  ///< ascending by id
  std::vector<maps::PredictedPose> poses;
  ReservedVector<maps::PredictedObstacle> predicted;

  Implementation(const PredictorOptions& o, CourseLine line)
      : options(o), course(std::move(line)), habits(course) {
    validate_options(options, "predictor");
    const std::size_t most = o.max_objects;
    times = saturate_cast<std::size_t>(std::ceil(o.horizon / o.interval - 1e-9)) + 1;
    remembered.reserve(most);
    poses.resize(most * maps::PredictedObstacle::max_hypotheses * times);
    predicted.reserve(most);
  }

  Remembered* find(int id) noexcept {
    for (Remembered& each : remembered)
      if (each.id == id) return &each;
    return nullptr;
  }

  /// The error of a hypothesis as the exponent of its likelihood.
  double mismatch(const Remembered& past, Manoeuvre manoeuvre, const Motion& now,
                  double elapsed) const noexcept {
    Way way(past.motion, manoeuvre, course, habits, options);
    way.advance(elapsed);
    double along = 0, across = 0;
    if (now.on_course) {
      along = course.between(way.now().arc, now.arc);
      across = now.offset - way.now().offset;
    } else {
      const maps::Point apart = maps::inverse_transform(now.pose, {way.pose().x, way.pose().y});
      along = apart.x;
      across = apart.y;
    }
    return 0.5 * (square(along / arc_error) + square(across / offset_error) +
                  square((now.speed - way.now().speed) / speed_error));
  }

  /// Compares the hypotheses of a while ago with the motion of the object.
  void learn(Remembered& past, const Motion& now, double elapsed) noexcept {
    const Weights first = first_weights(now);
    std::array<double, manoeuvres> mismatches{};
    const std::size_t count = std::min(possible(now), possible(past.motion));
    for (std::size_t i = 0; i < count; ++i)
      mismatches[i] = mismatch(past, static_cast<Manoeuvre>(i), now, elapsed);
    const double least = *std::min_element(mismatches.begin(), mismatches.begin() + count);
    double sum = 0;
    for (std::size_t i = 0; i < manoeuvres; ++i) {
      past.weights[i] = i < count ? past.weights[i] * std::exp(least - mismatches[i]) : 0;
      sum += past.weights[i];
    }
    for (std::size_t i = 0; i < manoeuvres; ++i) {
      const double posterior = sum > 0 ? past.weights[i] / sum : first[i];
      past.weights[i] = (1 - options.forgetting) * posterior + options.forgetting * first[i];
    }
  }

  /// Whether a car gets up to speed, as after a start: sets `now.rise`. Others keep the ratio of their speed.
  void note_rise(Remembered& past, Motion& now, double stamp) const noexcept {
    const double there = now.on_course ? course.at(now.arc).speed : 0;
    const double ratio = there > 0 ? now.speed / there : 0, elapsed = stamp - past.seen;
    if (elapsed > 0) {
      const double share = std::min(elapsed / rise_memory, 1.0);
      past.rise += share * ((ratio - past.ratio) / elapsed - past.rise);
      past.acceleration += share * ((now.speed - past.speed) / elapsed - past.acceleration);
      past.seen = stamp;
      past.ratio = ratio;
      past.speed = now.speed;
    }
    if (past.rise > clear_rise && past.acceleration > clear_acceleration) now.rise = past.rise;
  }

  /// The weights of an object's hypotheses after it was seen in this motion.
  const Weights& weigh(int id, Motion& now, double stamp) noexcept {
    const double there = now.on_course ? course.at(now.arc).speed : 0;
    const Remembered fresh{id,       stamp, now, first_weights(now), stamp, there > 0 ? now.speed / there : 0,
                           now.speed};
    Remembered* past = find(id);
    if (!past) {
      remembered.push_back(fresh);
      return remembered.back().weights;
    }
    const double elapsed = stamp - past->since;
    const bool follows = elapsed >= 0 && elapsed <= longest_gap && past->motion.on_course == now.on_course;
    if (!follows) {
      *past = fresh;
      return past->weights;
    }
    note_rise(*past, now, stamp);
    if (elapsed >= options.memory - 1e-9) {
      learn(*past, now, elapsed);
      past->since = stamp;
      past->motion = now;
    }
    return past->weights;
  }

  /// Standard deviations along and across the object, `time` (s) after the state of `object`.
  maps::PredictedPose spread(const TrackedObject& object, const maps::Pose& pose,
                             double time) const noexcept {
    const double c = std::cos(object.pose.yaw), s = std::sin(object.pose.yaw);
    const auto variance = [&](double x, double y) {
      return x * x * object.covariance[0][0] + 2 * x * y * object.covariance[0][1] +
             y * y * object.covariance[1][1];
    };
    const double along = variance(c, s) + square(time) * object.covariance[3][3] +
                         square(0.5 * options.acceleration_deviation * square(time));
    const double across = variance(-s, c) + square(options.drift_deviation * time);
    return {pose, std::sqrt(std::max(along, 0.0)), std::sqrt(std::max(across, 0.0))};
  }

  /// Appends the prediction of an object: its heaviest hypotheses.
  void predict(const TrackedObject& object, const Motion& motion, const Weights& weights) noexcept {
    maps::PredictedObstacle made;
    made.id = object.id;
    made.length = object.length;
    made.width = object.width;
    made.interval = options.interval;
    std::array<std::size_t, manoeuvres> order{0, 1, 2, 3, 4, 5};
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return weights[a] != weights[b] ? weights[a] > weights[b] : a < b;
    });
    const auto count = std::min<std::size_t>(possible(motion), maps::PredictedObstacle::max_hypotheses);
    made.hypotheses = static_cast<int>(count);
    const std::size_t begin = predicted.size() * maps::PredictedObstacle::max_hypotheses * times;
    double sum = 0;
    for (std::size_t h = 0; h < count; ++h) {
      made.weights[h] = weights[order[h]];
      sum += made.weights[h];
      Way way(motion, static_cast<Manoeuvre>(order[h]), course, habits, options);
      for (std::size_t k = 0; k < times; ++k) {
        if (k > 0) way.advance(options.interval);
        const maps::Pose pose = k > 0 ? way.pose() : object.pose;
        poses[begin + h * times + k] = spread(object, pose, k * options.interval);
      }
    }
    for (double& weight : made.weights) weight /= sum;
    made.poses = {poses.data() + begin, count * times};
    predicted.push_back(made);
  }
};

Predictor::Predictor(const PredictorOptions& options)
    : implementation_(std::make_unique<Implementation>(options, CourseLine{})) {}
Predictor::Predictor(std::span<const maps::ReferencePoint> course, const PredictorOptions& options)
    : implementation_(std::make_unique<Implementation>(options, CourseLine(course))) {}
Predictor::~Predictor() = default;
Predictor::Predictor(const Predictor& other)
    : implementation_(std::make_unique<Implementation>(*other.implementation_)) {
  implementation_->predicted.clear();  // they refer to the poses of `other`
}
Predictor& Predictor::operator=(const Predictor& other) {
  return *this = Predictor(other);
}
Predictor::Predictor(Predictor&&) noexcept = default;
Predictor& Predictor::operator=(Predictor&&) noexcept = default;

std::span<const maps::PredictedObstacle> Predictor::update(std::span<const TrackedObject> objects,
                                                           double stamp) noexcept {
  Implementation& p = *implementation_;
  p.predicted.clear();
  const auto gone = [&](const Implementation::Remembered& each) {
    return std::none_of(objects.begin(), objects.end(),
                        [&](const TrackedObject& object) { return object.id == each.id; });
  };
  std::erase_if(p.remembered, gone);
  for (const TrackedObject& object : objects) {
    if (p.predicted.size() == p.predicted.capacity()) break;
    const bool moves = plausible(object) && object.speed >= p.options.min_speed &&
                       square(object.speed) > 9 * object.covariance[3][3];
    if (!moves) continue;
    const bool room = p.remembered.size() < p.remembered.capacity() || p.find(object.id);
    if (!room) continue;
    Motion motion = motion_of(object, p.course, p.options);
    // Behind a car is only what it has just done itself.
    const double reach = motion.speed * p.options.horizon;
    if (motion.on_course && p.habits.at(motion.arc + reach).ratio > 0) motion.habit = p.habits.at(motion.arc);
    const Weights& weights = p.weigh(object.id, motion, stamp);
    p.predict(object, motion, weights);
    if (const double there = p.course.empty() ? 0 : p.course.at(motion.arc).speed;
        motion.on_course && there > 0)
      p.habits.note(motion.arc, {motion.offset, motion.speed / there});
  }
  return p.predicted;
}

void Predictor::reset() noexcept {
  implementation_->remembered.clear();
  implementation_->habits.reset();
}

}  // namespace slalom::tracking
