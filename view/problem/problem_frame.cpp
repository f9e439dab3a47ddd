#include "view/problem/problem_frame.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "view/protocol/solve_blocks.hpp"

namespace slalom::view {
namespace {

constexpr std::size_t most_candidates = 160, least_candidates = 20;
constexpr std::size_t most_step_costs = 100000;  // values in a frame

using Poses = std::span<const maps::Pose>;

/// The control sequences of a step and their trajectories: plan, nominal, candidates, then guides.
struct Sequences {
  std::vector<float> values;  // [sequence][step][input]
  std::vector<int> samples;   // index in the batch of each candidate
  std::size_t candidates = 0, guides = 0, size = 0;
  void add(std::span<const float> sequence) { values.insert(values.end(), sequence.begin(), sequence.end()); }
};

Sequences sequences_of(Subject& subject, const SolveResult& solve, std::size_t points) {
  Sequences all;
  all.size = solve.inputs.size();
  all.add(solve.inputs);
  if (solve.nominal.size() == all.size)
    all.add(solve.nominal);
  else
    all.add(std::vector<float>(all.values));
  if (const SequenceBatch* batch = solve.samples; batch && !solve.costs.empty()) {
    const std::size_t terms = subject.facts().terms.size();
    const std::size_t most = std::clamp(most_step_costs / std::max<std::size_t>(1, points * terms),
                                        least_candidates, most_candidates);
    const auto samples = static_cast<std::size_t>(batch->samples());
    all.candidates = std::min(most, samples);
    for (std::size_t i = 0; i < all.candidates; ++i) {
      const int k = static_cast<int>(i * samples / all.candidates);
      all.samples.push_back(k);
      for (int row = 0; row < static_cast<int>(all.size); ++row)
        all.values.push_back(batch->at(row / batch->inputs(), row % batch->inputs(), k));
    }
  }
  const SequenceList& guides = solve.guide_path.sequences > 0 ? solve.guide_path : solve.guides;
  all.guides = static_cast<std::size_t>(guides.sequences);
  all.add(guides.values);
  return all;
}

/// The largest distance along an axis of some points from the first, m.
double reach_of(Poses poses) {
  double reach = 1e-3;
  for (const maps::Pose& p : poses)
    reach = std::max({reach, std::abs(p.x - poses.front().x), std::abs(p.y - poses.front().y)});
  return reach;
}

/// Writes trajectories with a unit that reaches all their points up to `most` (m), which keeps their
/// resolution where one of them diverges.
void put_points(FrameWriter& to, Poses poses, double most) {
  to.begin_points({poses.front().x, poses.front().y}, std::min(reach_of(poses), most) / 32000);
  for (const maps::Pose& p : poses) to.put_point({p.x, p.y});
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
void put_scene(FrameWriter& to, const SubjectFacts& facts, const std::vector<Shape>& shapes,
               const maps::Pose& pose, bool collides) {
  std::vector<Line> polygons;
  to.begin(Block::bodies);
  const auto count =
      std::count_if(shapes.begin(), shapes.end(), [](const Shape& s) { return s.corners.empty(); });
  to.put(static_cast<std::uint32_t>(1 + count));
  to.put_body(0, 0, collides, pose, facts.length, facts.width);
  std::size_t id = 0;
  for (const Shape& s : shapes) {
    ++id;
    if (s.corners.empty())
      to.put_body(id,
                  s.kind == ShapeKind::mover  ? 5
                  : s.kind == ShapeKind::goal ? 6
                  : s.is_disc                 ? 3
                                              : 2,
                  false, s.pose, s.length, s.width);
    else
      polygons.push_back(s.corners);
  }
  to.end();
  put_lines(to, Block::polygons, polygons);
}

/// Writes candidates: each term of their costs, the solver's cost, the weight, and 1 + the first state that
/// collides, at most 254, or `unknown_place`.
void put_candidates(FrameWriter& to, const Sequences& all, const SolveResult& solve,
                    const Trajectories& rolled, std::size_t terms, std::size_t points, Poses poses,
                    double reach) {
  to.begin(Block::candidates);
  to.put(static_cast<std::uint16_t>(all.candidates));
  to.put(static_cast<std::uint16_t>(points));
  const std::size_t first = 2;  // candidate among the sequences
  for (std::size_t i = 0; i < all.candidates; ++i) {
    for (std::size_t t = 0; t < terms; ++t) {
      double sum = 0;
      for (std::size_t k = 0; k < points; ++k) sum += rolled.costs[((first + i) * points + k) * terms + t];
      to.put_f32(sum);
    }
    const auto sample = static_cast<std::size_t>(all.samples[i]);
    to.put(solve.costs[sample]);
    to.put(sample < solve.weights.size() ? solve.weights[sample] : 0.0f);
  }
  for (std::size_t i = 0; i < all.candidates; ++i) {
    const bool collides = solve.collided[static_cast<std::size_t>(all.samples[i])] != 0;
    const int at = rolled.collisions[first + i];
    to.put(static_cast<std::uint8_t>(!collides ? 0 : at < 0 ? unknown_place : std::min(at + 1, 254)));
  }
  to.pad();
  put_points(to, poses.subspan(first * points, all.candidates * points), reach);
  to.end();
}

}  // namespace

std::vector<std::string> problem_scalars(const SubjectFacts& facts) {
  std::vector<std::string> names = words_of(
      "tick time x y yaw status minimum_cost expected_cost effective_samples samples collided_share "
      "temperature iterations tick_ms deadline_ms contact contacts prediction_step method plan_cost "
      "symptom");
  const auto add = [&](const char* kind, const std::vector<std::string>& all) {
    for (const std::string& each : all) names.push_back(kind + each);
  };
  for (const std::string& term : facts.terms) names.push_back(term + "_cost");
  add("state.", facts.states);
  add("input.", facts.inputs);
  return names;
}

ProblemFrame encode_step(Subject& subject, const SolveResult& solve, const ProblemStep& step) {
  const SubjectFacts& facts = subject.facts();
  const std::size_t terms = facts.terms.size(), inputs = facts.inputs.size();
  const std::size_t points = solve.inputs.size() / inputs + 1;
  const Sequences all = sequences_of(subject, solve, points);
  const Trajectories rolled = subject.roll_out(step.state, all.values);
  const std::vector<maps::Pose> places = subject.poses(rolled.states);
  const Poses poses(places);
  ProblemFrame frame;
  frame.collides = rolled.collisions.front() == 0;
  const maps::Pose& now = poses.front();

  FrameWriter to;
  to.begin(Block::scalars);
  std::vector<double> sums(terms);
  for (std::size_t i = 0; i < points * terms; ++i) sums[i % terms] += rolled.costs[i];
  double cost = 0;
  for (const double sum : sums) cost += sum;
  to.put({static_cast<double>(step.tick), step.time, now.x, now.y, now.yaw});
  to.put({static_cast<double>(subject.status(solve))});
  to.put({solve.minimum_cost, solve.expected_cost, solve.effective_sample_size});
  to.put({solve.samples ? solve.samples->samples() : 0.0, solve.collided_share, solve.temperature});
  to.put({static_cast<double>(solve.iterations), 1e3 * step.solve_time, 1e3 * step.period});
  to.put({frame.collides ? 1.0 : 0.0, static_cast<double>(step.collisions + frame.collides), step.period});
  to.put({static_cast<double>(step.method), cost, static_cast<double>(solve.symptom())});
  for (const double sum : sums) to.put(sum);
  for (const double value : step.state) to.put(value);
  for (std::size_t i = 0; i < inputs; ++i) to.put(subject.inputs()[i]);
  to.end();

  const std::vector<Shape> shapes = subject.shapes();
  const std::vector<Line> figure = subject.figure(step.state), lines = subject.lines();
  frame.bounds = {now.x, now.y, now.x, now.y};
  for (const maps::Pose& p : poses.first(2 * points)) frame.bounds.include(p.x, p.y);
  for (const auto* all_lines : {&figure, &lines})
    for (const Line& line : *all_lines)
      for (const maps::Point& p : line) frame.bounds.include(p.x, p.y);
  for (const Shape& s : shapes) {
    const double reach = 0.5 * std::max(s.length, s.width);
    if (s.corners.empty()) {
      frame.bounds.include(s.pose.x - reach, s.pose.y - reach);
      frame.bounds.include(s.pose.x + reach, s.pose.y + reach);
    }
    for (const maps::Point& p : s.corners) frame.bounds.include(p.x, p.y);
  }
  if (const auto& map = facts.map)
    for (const double x : {0.0, map->width * map->resolution})
      for (const double y : {0.0, map->height * map->resolution}) {
        const maps::Point corner = maps::transform(map->origin, {x, y});
        frame.bounds.include(corner.x, corner.y);
      }
  const Bounds& b = frame.bounds;
  const double reach = 20 * std::max({b.x1 - b.x0, b.y1 - b.y0, 1e-3});

  put_scene(to, facts, shapes, now, frame.collides);
  put_lines(to, Block::figure, figure);
  put_lines(to, Block::lines, lines);
  if (all.candidates > 0) put_candidates(to, all, solve, rolled, terms, points, poses, reach);
  std::vector<double> costs = rolled.costs;  // those of plan and candidates
  const auto block = static_cast<std::ptrdiff_t>(points * terms);
  costs.erase(costs.begin() + block, costs.begin() + 2 * block);
  costs.resize((1 + all.candidates) * points * terms);
  put_step_costs(to, costs, terms, points);
  if (all.guides > 0) {
    const auto guides = static_cast<std::size_t>(std::max(1, solve.guides.sequences));
    to.begin(Block::guides);
    to.put(static_cast<std::uint16_t>(guides));
    to.put(static_cast<std::uint16_t>(all.guides / guides));
    to.put(static_cast<std::uint16_t>(points));
    to.put(std::uint16_t{0});
    put_points(to, poses.subspan((2 + all.candidates) * points), reach);
    to.end();
  }
  to.begin(Block::nominal);
  to.put(static_cast<std::uint32_t>(points));
  put_points(to, poses.subspan(points, points), reach);
  to.end();
  to.begin(Block::plan);
  to.put(static_cast<std::uint32_t>(points));
  to.put(now.x);
  to.put(now.y);
  for (const maps::Pose& p : poses.first(points)) to.put_f32({p.x - now.x, p.y - now.y, p.yaw, 0, 0, 0});
  to.end();
  to.put_covariance(solve.variances, inputs);
  put_inputs(to, solve, solve.inputs, inputs);
  put_effective_samples(to, solve);
  frame.message = to.take();
  return frame;
}

}  // namespace slalom::view
