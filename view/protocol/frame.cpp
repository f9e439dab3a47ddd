#include "view/protocol/frame.hpp"

#include "view/protocol/frame_writer.hpp"

namespace slalom::view {
namespace {

/// The number of a shape's kind in the block `bodies`.
int kind_of(const Shape& shape) {
  switch (shape.kind) {
    case ShapeKind::parked_car:
      return 1;
    case ShapeKind::opponent:
      return 4;
    case ShapeKind::mover:
      return 5;
    case ShapeKind::goal:
      return 6;
    case ShapeKind::obstacle:
      break;
  }
  return shape.is_disc ? 3 : 2;
}

void put_body(FrameWriter& to, std::size_t id, int kind, const Shape& shape) {
  to.put(static_cast<std::uint16_t>(id));
  to.put(static_cast<std::uint8_t>(kind));
  to.put(static_cast<std::uint8_t>(shape.touched));
  to.put_f32({shape.pose.x, shape.pose.y, shape.pose.yaw, shape.length, shape.width});
}

void put_lines(FrameWriter& to, Block block, const std::vector<Line>& lines) {
  if (lines.empty()) return;
  to.begin(block);
  to.put(static_cast<std::uint32_t>(lines.size()));
  for (const Line& line : lines) {
    to.put(static_cast<std::uint32_t>(line.size()));
    for (const maps::Point& p : line) to.put_f32({p.x, p.y});
  }
  to.end();
}

/// Writes the body, 0, and the shapes, whose numbers are their indices + 1; polygons apart.
void put_bodies(FrameWriter& to, const Shape& body, const std::vector<Shape>& shapes) {
  std::vector<Line> polygons;
  to.begin(Block::bodies);
  const auto count =
      std::count_if(shapes.begin(), shapes.end(), [](const Shape& s) { return s.corners.empty(); });
  to.put(static_cast<std::uint32_t>(1 + count));
  put_body(to, 0, 0, body);
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].corners.empty())
      put_body(to, i + 1, kind_of(shapes[i]), shapes[i]);
    else
      polygons.push_back(shapes[i].corners);
  }
  to.end();
  put_lines(to, Block::polygons, polygons);
}

constexpr double course_room = 1.5;  // m beside the line of a course

using Poses = std::span<const maps::Pose>;

/// The largest distance along an axis of some points from the first, m.
double reach_of(Poses poses) {
  double reach = 1e-3;
  for (const maps::Pose& p : poses)
    reach = std::max({reach, std::abs(p.x - poses.front().x), std::abs(p.y - poses.front().y)});
  return reach;
}

/// Writes trajectories in mm: in finer units where all is near, which keeps their resolution, and in coarser
/// ones that reach all their points up to `most` (m).
void put_points(FrameWriter& to, Poses poses, double most) {
  const double reach = std::min(reach_of(poses), most);
  to.begin_points({poses.front().x, poses.front().y}, std::max(reach / 32000, std::min(0.001, reach / 2000)));
  for (const maps::Pose& p : poses) to.put_point({p.x, p.y});
}

void put_scan(FrameWriter& to, const SeenScan& scan) {
  to.begin(Block::scan);
  to.put_pose(scan.sensor);
  to.put(static_cast<std::uint32_t>(scan.ranges.size()));
  for (const float range : scan.ranges) {
    const double millimetres = std::clamp(1000.0 * static_cast<double>(range), 0.0, 65535.0);
    to.put(static_cast<std::uint16_t>(millimetres));
  }
  to.end();
}

/// Encodes one control step. Its control sequences are rolled out together.
class StepEncoder {
 public:
  StepEncoder(FrameSource& source, const DrawnSolve& solve, const StepFacts& step)
      : source_(source),
        facts_(source.facts()),
        solve_(solve),
        step_(step),
        terms_(facts_.terms.size()),
        inputs_(source.inputs_per_step()),
        points_(solve.length / inputs_ + 1),
        now_(source.poses(step.state).front()) {
    if (solve.length > 0) {
      rolled_ = source_.roll_out(step_.state, solve.sequences);
      poses_ = source_.poses(rolled_.states);
    }
    frame_.collides = source.measures() ? step.measures.collides
                                        : !rolled_.collisions.empty() && rolled_.collisions[0] == 0;
  }

  Frame encode() {
    const std::vector<Shape> shapes = source_.shapes();
    const std::vector<Line> figure = source_.figure(step_.state), lines = source_.lines();
    find_bounds(shapes, figure, lines);
    put_scalars();
    if (const std::optional<SeenScan> scan = source_.scan()) put_scan(to_, *scan);
    to_.append(source_.blocks());
    const Shape body{
        .pose = now_, .length = facts_.length, .width = facts_.width, .touched = frame_.collides};
    put_bodies(to_, body, shapes);
    put_lines(to_, Block::figure, figure);
    put_lines(to_, Block::lines, lines);
    if (solve_.length > 0) put_trajectories();
    frame_.message = to_.take();
    return std::move(frame_);
  }

 private:
  /// The poses of some of the sequences.
  Poses poses(std::size_t from, std::size_t count = 1) const {
    return Poses(poses_).subspan(from * points_, count * points_);
  }

  void find_bounds(const std::vector<Shape>& shapes, const std::vector<Line>& figure,
                   const std::vector<Line>& lines) {
    Bounds& b = frame_.bounds = {now_.x, now_.y, now_.x, now_.y};
    if (!facts_.course.empty()) {
      b = bounds_of(facts_.course);
      return;
    }
    if (!poses_.empty())
      for (const maps::Pose& p : poses(0, 2)) b.include(p.x, p.y);
    for (const auto* all : {&figure, &lines})
      for (const Line& line : *all)
        for (const maps::Point& p : line) b.include(p.x, p.y);
    for (const Shape& s : shapes) {
      const double reach = 0.5 * std::max(s.length, s.width);
      if (s.corners.empty()) {
        b.include(s.pose.x - reach, s.pose.y - reach);
        b.include(s.pose.x + reach, s.pose.y + reach);
      }
      for (const maps::Point& p : s.corners) b.include(p.x, p.y);
    }
    if (const auto& map = facts_.map)
      for (const double x : {0.0, map->width * map->resolution})
        for (const double y : {0.0, map->height * map->resolution}) {
          const maps::Point corner = maps::transform(map->origin, {x, y});
          b.include(corner.x, corner.y);
        }
  }

  void put_scalars() {
    const SolveResult& solved = solve_.figures;
    const bool is_solved = solve_.length > 0;
    std::vector<double> sums(terms_);
    for (std::size_t i = 0; is_solved && i < points_ * terms_; ++i) sums[i % terms_] += rolled_.costs[i];
    double cost = 0;
    for (const double sum : sums) cost += sum;
    const double none = std::numeric_limits<double>::quiet_NaN();
    const auto known = [&](double value) { return is_solved ? value : none; };
    const StepMeasures& m = step_.measures;
    const bool counts = source_.measures().has_value();
    to_.begin(Block::scalars);
    to_.put({static_cast<double>(step_.tick), m.time, now_.x, now_.y, now_.yaw});
    to_.put({static_cast<double>(source_.status(solved)), known(solved.minimum_cost)});
    to_.put({known(solved.expected_cost), known(solved.effective_sample_size)});
    to_.put({static_cast<double>(solve_.samples), facts_.can_collide ? known(solved.collided_share) : none});
    to_.put({known(solved.temperature), static_cast<double>(solved.iterations), 1e3 * m.update_time});
    const auto collision = [&](double value) { return facts_.can_collide ? value : none; };
    to_.put({1e3 * step_.period, collision(frame_.collides)});
    to_.put({collision(m.collisions + (counts ? 0 : frame_.collides)), m.prediction_step});
    to_.put({static_cast<double>(step_.method), cost, static_cast<double>(solved.symptom())});
    const bool leads_into = is_solved && !rolled_.collisions.empty() && rolled_.collisions[0] >= 0;
    to_.put(leads_into ? rolled_.collisions[0] : none);
    for (const double sum : sums) to_.put(sum);
    if (facts_.figures.empty()) {
      for (const double value : step_.state) to_.put(value);
      for (std::size_t i = 0; i < inputs_; ++i) to_.put(source_.inputs()[i]);
    }
    for (const double value : source_.figures()) to_.put(value);
    to_.end();
  }

  void put_trajectories() {
    const Bounds& b = frame_.bounds;
    const double reach = 20 * std::max({b.x1 - b.x0, b.y1 - b.y0, 1e-3});
    if (solve_.candidates > 0) put_candidates(reach);
    if (solve_.guides > 0) put_guides(reach);
    to_.begin(Block::nominal);
    to_.put(static_cast<std::uint32_t>(points_));
    put_points(to_, poses(1), reach);
    to_.end();
    put_plan();
    to_.begin(Block::covariance);  // variances of the first input
    for (std::size_t i = 0; i < solve_.variances.size(); i += inputs_) to_.put(solve_.variances[i]);
    to_.end();
  }

  /// Writes candidates: each term of their costs, the solver's cost, the weight, and whether they collide.
  void put_candidates(double reach) {
    to_.begin(Block::candidates);
    to_.put(static_cast<std::uint16_t>(solve_.candidates));
    to_.put(static_cast<std::uint16_t>(points_));
    const std::size_t first = 2;  // candidate among the sequences
    std::string collided;
    for (std::size_t i = 0; i < solve_.candidates; ++i) {
      for (std::size_t t = 0; t < terms_; ++t) {
        double sum = 0;
        for (std::size_t k = 0; k < points_; ++k)
          sum += rolled_.costs[((first + i) * points_ + k) * terms_ + t];
        to_.put_f32(sum);
      }
      to_.put(solve_.costs[i]);
      to_.put(solve_.weights[i]);
      collided += static_cast<char>(solve_.collided[i]);
    }
    to_.append(collided);
    to_.pad();
    put_points(to_, poses(first, solve_.candidates), reach);
    to_.end();
  }

  void put_guides(double reach) {
    to_.begin(Block::guides);
    to_.put(static_cast<std::uint16_t>(solve_.guides_at_once));
    to_.put(static_cast<std::uint16_t>(solve_.guides / solve_.guides_at_once));
    to_.put(static_cast<std::uint16_t>(points_));
    to_.put(std::uint16_t{0});
    put_points(to_, poses(2 + solve_.candidates, solve_.guides), reach);
    to_.end();
  }

  /// Returns the variance (m^2) of each state of the plan across its heading: the solver's variances of the
  /// inputs, carried through the model to first order, by a difference quotient for each input.
  std::vector<double> lateral_variances() const {
    std::vector<double> variances(points_);
    const Poses plan = poses(0);
    const std::size_t first = 2 + solve_.candidates + solve_.guides;
    for (std::size_t j = 0; (first + j + 1) * points_ <= poses_.size(); ++j) {
      const Poses moved = poses(first + j);
      for (std::size_t k = j / inputs_ + 1; k < points_; ++k) {
        const maps::Pose& p = plan[k];
        const double across = -std::sin(p.yaw) * (moved[k].x - p.x) + std::cos(p.yaw) * (moved[k].y - p.y);
        variances[k] += across * across / static_cast<double>(DrawnSolve::nudge * DrawnSolve::nudge) *
                        static_cast<double>(solve_.variances[j]);
      }
    }
    return variances;
  }

  void put_plan() {
    const std::vector<double> variances = lateral_variances();
    const std::size_t width = rolled_.states.size() / poses_.size();
    const auto value = [&](std::size_t k, int index) {
      return index < 0 ? 0 : rolled_.states[k * width + static_cast<std::size_t>(index)];
    };
    to_.begin(Block::plan);
    to_.put(static_cast<std::uint32_t>(points_));
    to_.put({now_.x, now_.y});
    for (std::size_t k = 0; k < points_; ++k) {
      const maps::Pose& p = poses_[k];
      to_.put_f32({p.x - now_.x, p.y - now_.y, p.yaw, value(k, facts_.speed), value(k, facts_.steering)});
      to_.put_f32(std::sqrt(variances[k]));
    }
    to_.end();
  }

  FrameSource& source_;
  const SubjectFacts& facts_;
  const DrawnSolve& solve_;
  const StepFacts& step_;
  std::size_t terms_, inputs_, points_;
  maps::Pose now_;
  Trajectories rolled_;
  std::vector<maps::Pose> poses_;  ///< [sequence][point]
  FrameWriter to_;
  Frame frame_;
};

}  // namespace

Bounds bounds_of(std::span<const maps::ReferencePoint> course) {
  Bounds b{course[0].x, course[0].y, course[0].x, course[0].y};
  for (const maps::ReferencePoint& p : course) b.include(p.x, p.y);
  return {b.x0 - course_room, b.y0 - course_room, b.x1 + course_room, b.y1 + course_room};
}

std::vector<std::string> scalar_names(const SubjectFacts& facts) {
  std::vector<std::string> names = words_of(
      "tick time x y yaw status minimum_cost expected_cost effective_samples samples collided_share "
      "temperature iterations tick_ms deadline_ms contact contacts prediction_step method plan_cost "
      "symptom plan_collides_at");
  for (const std::string& term : facts.terms) names.push_back(term + "_cost");
  if (facts.figures.empty()) {
    for (const std::string& state : facts.states) names.push_back("state." + state);
    for (const std::string& input : facts.inputs) names.push_back("input." + input);
  }
  names.insert(names.end(), facts.figures.begin(), facts.figures.end());
  return names;
}

Frame encode_frame(FrameSource& source, const SolveResult& solve, const StepFacts& step) {
  DrawnSolve drawn;
  drawn.take(solve, source.facts().length > 0);
  return encode_frame(source, drawn, step);
}

Frame encode_frame(FrameSource& source, const DrawnSolve& solve, const StepFacts& step) {
  return StepEncoder(source, solve, step).encode();
}

std::string encode_ghost_frame(std::string_view frame) {
  FrameWriter to;
  to.begin(Block::ghost_frame);
  to.append(frame);
  to.end();
  return to.take_blocks();
}

std::string encode_scene(const SubjectFacts& facts) {
  if (!facts.map && facts.course.empty()) return {};
  FrameWriter to;
  if (facts.map) to.put_grid(*facts.map);
  if (!facts.course.empty()) {
    to.begin(Block::path);
    to.put(static_cast<std::uint32_t>(facts.course.size()));
    to.put(static_cast<std::uint32_t>(facts.is_closed));
    for (const maps::ReferencePoint& p : facts.course) to.put_f32({p.x, p.y, p.speed});
    to.end();
  }
  return to.take();
}

}  // namespace slalom::view
